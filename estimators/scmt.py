"""SCMT odometry: the min/max rule over two tachometers (Malvezzi et al. 2014), the baseline.

Good adhesion: speed straight from the wheels. Sliding, that is |v1 - v2| > dv or |a_i| > da: while braking the largest,
while accelerating the smallest of v1, v2 and the speed integrated with a constant deceleration or acceleration of the
train. Blind where both wheels slide alike, by design.
"""

import math
from collections import deque
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_validator

from estimators.interface import Estimate, Initial, Sample

Wheelset = Annotated[int, Field(ge=1, le=4)]


class ScmtParameters(BaseModel):
    """Thresholds and performance of the train. The source prints none of the figures: all are assumed."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    period_s: float = Field(default=0.1, gt=0.0, le=1.0)
    # The end wheelsets: in different bogies, and as far apart as they can be, so that they slide least alike.
    wheelsets: tuple[Wheelset, Wheelset] = (1, 4)
    speed_difference_mps: float = Field(default=0.6, gt=0.0, description="dv of the tachometric criterion")
    wheel_acceleration_mps2: float = Field(default=2.0, gt=0.0, description="da of the accelerometric criterion")
    performance_acceleration_mps2: float = Field(default=0.7, gt=0.0, description="of the train in traction")
    performance_deceleration_mps2: float = Field(default=1.2, gt=0.0, description="of the train in full braking")
    trend_s: float = Field(default=2.0, gt=0.0, description="time over which its own speed shows if the train brakes")
    wheel_radius_sd_share: float = Field(default=0.002, ge=0.0, le=0.1)
    bound_sigmas: float = Field(default=3.0, gt=0.0)

    @model_validator(mode="after")
    def _independent(self) -> "ScmtParameters":
        if self.wheelsets[0] == self.wheelsets[1]:
            raise ValueError(f"wheelsets: {list(self.wheelsets)}, wanted two different ones")
        return self


class Scmt:
    """Estimator `scmt`: speed and position from two wheels; no orientation.

    Bounds: rolling, the assumed wheel radius' uncertainty. Sliding while braking, the train is between the faster wheel
    (no braked rim outruns the train) and the speed at which sliding began; while accelerating the other way round; the
    estimate itself always lies inside. Position bounds integrate the speed bounds.
    """

    Parameters = ScmtParameters

    def __init__(self, parameters: ScmtParameters) -> None:
        self.parameters = parameters
        self.period_s = parameters.period_s
        self.reset(Initial())

    def reset(self, initial: Initial) -> None:
        """Start anew."""
        spread_m = self.parameters.bound_sigmas * initial.position_sd_m
        self._t_s = initial.t_s
        self._position_m = [initial.position_m - spread_m, initial.position_m, initial.position_m + spread_m]
        spread_mps = self.parameters.bound_sigmas * initial.speed_sd_mps
        self._speed_mps = [initial.speed_mps - spread_mps, initial.speed_mps, initial.speed_mps + spread_mps]
        self._balise_sd_m = initial.position_sd_m
        self._wheels_mps: tuple[float, float] | None = None
        ticks = round(self.parameters.trend_s / self.period_s)
        self._trend: deque[float] = deque([abs(initial.speed_mps)], maxlen=ticks + 1)
        self._sliding = 0  # -1 braking, +1 accelerating, 0 adhesion good
        self._onset_mps = initial.speed_mps

    def step(self, sample: Sample) -> Estimate:
        """Speed by the rule, position by the trapezoidal rule, balises as they come."""
        parameters = self.parameters
        interval_s = sample.t_s - self._t_s
        first, second = (int(wheelset) - 1 for wheelset in parameters.wheelsets)
        usable = bool(sample.valid[first] and sample.valid[second])
        # The rule speaks of magnitudes: run it along the direction of travel.
        way = sample.direction
        wheels = (way * float(sample.axle_speed_mps[first]), way * float(sample.axle_speed_mps[second]))
        before = [way * speed for speed in self._speed_mps]
        if way < 0:
            before.reverse()
        now = self._ruled(wheels, before, interval_s) if usable else before
        self._wheels_mps = wheels if usable else None
        self._trend.append(now[1])
        if way < 0:
            now = now[::-1]
        speed = [way * value for value in now]
        for i in range(3):
            self._position_m[i] += 0.5 * interval_s * (self._speed_mps[i] + speed[i])
        if not math.isnan(sample.balise_position_m):
            at_m = sample.balise_position_m + speed[1] * sample.balise_age_s
            spread_m = parameters.bound_sigmas * self._balise_sd_m
            self._position_m = [at_m - spread_m, at_m, at_m + spread_m]
        acceleration = (speed[1] - self._speed_mps[1]) / interval_s if interval_s > 0.0 else math.nan
        self._t_s, self._speed_mps = sample.t_s, speed
        return Estimate(
            t_s=sample.t_s,
            position_m=self._position_m[1],
            position_lower_m=self._position_m[0],
            position_upper_m=self._position_m[2],
            speed_mps=speed[1],
            speed_lower_mps=speed[0],
            speed_upper_mps=speed[2],
            acceleration_mps2=acceleration,
            gradient_permille=math.nan,
            roll_rad=math.nan,
            pitch_rad=math.nan,
            yaw_rad=math.nan,
            direction=sample.direction,
            valid=usable,
        )

    def _ruled(self, wheels: tuple[float, float], before: list[float], interval_s: float) -> list[float]:
        """Lower bound, estimate, upper bound of the speed along the direction of travel."""
        parameters = self.parameters
        slow, fast = min(wheels), max(wheels)
        margin = parameters.bound_sigmas * parameters.wheel_radius_sd_share * fast
        accelerations = (0.0, 0.0)
        if self._wheels_mps is not None and interval_s > 0.0:
            accelerations = tuple((v - b) / interval_s for v, b in zip(wheels, self._wheels_mps, strict=True))  # type: ignore[assignment]
        strongest = max(accelerations, key=abs)
        if fast - slow <= parameters.speed_difference_mps and abs(strongest) <= parameters.wheel_acceleration_mps2:
            self._sliding = 0
            mean = 0.5 * (slow + fast)
            return [mean - margin, mean, mean + margin]
        if self._sliding == 0:
            # What the train was doing shows in its speed; a wheel's acceleration turns round as soon as it recovers.
            trend = before[1] - self._trend[0]
            self._sliding = 1 if (trend if trend != 0.0 else strongest) > 0.0 else -1
            self._onset_mps = before[1]
        if self._sliding < 0:
            speed = max(fast, before[1] - parameters.performance_deceleration_mps2 * interval_s)
            return [min(fast, speed) - margin, speed, max(self._onset_mps, speed) + margin]
        speed = min(slow, before[1] + parameters.performance_acceleration_mps2 * interval_s)
        return [min(self._onset_mps, speed) - margin, speed, max(slow, speed) + margin]
