"""Estimator `ins-odo`: tachometer while adhesion is good, inertial navigation while the wheel slides.

The two Kalman filters of Malvezzi et al. 2014 with adaptive R. Adhesion is good while the wheel agrees with the
inertial acceleration f_x + (R_nb g)_x within eta_ad and with the inertial speed within eta_v. The source leaves open
what a filter that follows the wheel shall compare the wheel with, and how trust returns. Here:

- the inertial speed starts from the estimate `lookback_s` ago, so that a slide too slow for eta_ad shows in eta_v;
- when distrust begins, the time since the wheel began to part from the inertial speed is done again without the wheel:
  what it said while it began to slide does not stay in speed, position or pitch;
- trust returns after agreement over `confirmation_s`. While the accelerometer shows brake force, a wheel may be faster
  than the inertial speed but not slower by more than half of eta_v, since a braked rim never outruns the train; in
  traction the other way round. A wheel without force rolls: then it is believed even against the inertial acceleration,
  and the difference goes into the pitch's variance. On very slippery rail a braked coach feels as little force, so the
  speed has to be one that inertial errors can explain: no coach loses it unfelt (`_may_roll`);
- all wheels at zero without inertial acceleration for `standstill_s`, at a speed that may be zero, is a standstill.
"""

import dataclasses
import math
from collections import deque

from estimators.confirmation import Confirmation
from estimators.ins_odo_parameters import InsOdoParameters
from estimators.interface import Estimate, Initial, Sample
from estimators.odometry_filter import A, OdometryFilter, P, V
from estimators.onboard import believed_rotation
from estimators.orientation_filter import GRAVITY_MPS2, OrientationFilter
from estimators.wheel_window import WheelWindow, WindowReading
from sensors.streams import FloatArray

_SIGMAS = 4.0  # how far inertial figures may be off by the filters' own account before a wheel is blamed
_STANDSTILL_SD = 1e-3  # of speed and acceleration, known to be zero
_PRINTED_BALISE_SD_M = 0.01  # the printed form takes the balise as exact
_PRINTED_BALISE_WINDOW_M = 5.0
_PARTED_SHARE = 0.25  # of eta_v: below it wheel and inertial speed differ by noise alone
_RECOVERED_SHARE = 0.5  # of eta_v: a wheel under force has to come closer than that to be trusted again
_GRADIENT_MPS2 = 0.5  # what gravity gives a free train on the steepest line, with room


@dataclasses.dataclass(slots=True)
class _Tick:
    """One tick's readings in carbody axes, the filters' state before it, and how it went."""

    force: FloatArray
    rate: FloatArray
    wheel_mps: float
    window: WindowReading
    balise_m: float
    balise_age_s: float
    before: tuple[FloatArray, ...]
    origin_m: float
    gained_mps: float = 0.0
    drift_mps: float = 0.0
    speed_mps: float = 0.0


class InsOdo:
    """Speed, position, acceleration, gradient and orientation. Bounds: `bound_sigmas` standard deviations from P."""

    Parameters = InsOdoParameters

    def __init__(self, parameters: InsOdoParameters) -> None:
        self.parameters = parameters
        self.period_s = parameters.orientation.period_s
        self.orientation = OrientationFilter(parameters.orientation)
        self.odometry = OdometryFilter(self.period_s, parameters.acceleration_walk_mps2_per_rts)
        self.reset(Initial())

    def reset(self, initial: Initial) -> None:
        """Start anew, with the wheel trusted."""
        parameters = self.parameters
        self._rotation = believed_rotation(initial.imu_roll_rad, initial.imu_pitch_rad)
        self._window = WheelWindow(self.period_s, parameters.orientation.smoothing_s)
        self._lookback: deque[_Tick] = deque(maxlen=max(round(parameters.lookback_s / self.period_s), 1))
        self._recovery = Confirmation(self.period_s, parameters.confirmation_s)
        self._stillness = Confirmation(self.period_s, parameters.standstill_s)
        self.wheel_trusted = True
        self.standstill = False
        self.orientation.reset(initial)
        self.odometry.reset(initial)
        self._origin_m = 0.0
        if parameters.balise == "printed":  # there p counts from the last balise
            self._origin_m = initial.position_m
            self.odometry.kalman.x[P, 0] = 0.0
        self._rolled_mps = abs(initial.speed_mps)
        self._inertial_s = 0.0

    def step(self, sample: Sample) -> Estimate:
        """One tick."""
        tick = self._tick(sample)
        inertial_mps2 = self._inertial_acceleration_mps2(tick)
        margin_mps2 = max(
            self.parameters.adhesion_acceleration_mps2, _SIGMAS * GRAVITY_MPS2 * self.orientation.pitch_sd_rad
        )
        turning = bool((sample.valid & (sample.axle_speed_mps != 0.0)).any())
        # Locked wheels on a falling line may slide without inertial acceleration: the speed has to allow for zero, too.
        slow = abs(self.odometry.speed_mps) < self._speed_margin_mps()
        still = slow and sample.valid.any() and not turning and abs(inertial_mps2) < margin_mps2
        if self._stillness.agreed(bool(still)) and not self.standstill:
            self.standstill = True
        elif self.standstill and turning:
            self.standstill = False
            self._trust()
        if not self.standstill:
            self._judge(tick, inertial_mps2, margin_mps2, sample.direction)
        self._advance(tick)
        self._lookback.append(tick)
        return self._estimate(sample)

    def _tick(self, sample: Sample) -> _Tick:
        force = self._rotation @ sample.specific_force_mps2
        rate = self._rotation @ sample.angular_rate_radps
        wheel = self.parameters.orientation.wheelset - 1
        wheel_mps = float(sample.axle_speed_mps[wheel]) if sample.valid[wheel] else math.nan
        self._window.push(wheel_mps, force, rate)
        tick = _Tick(
            force, rate, wheel_mps, self._window.reading(), sample.balise_position_m, sample.balise_age_s, (), 0.0
        )
        tick.gained_mps = (float(force[0]) + self.orientation.gravity_x_mps2) * self.period_s
        tick.drift_mps = self._lasting_sd_mps2(tick) * self.period_s
        return tick

    def _inertial_acceleration_mps2(self, tick: _Tick) -> float:
        """f_x + (R_nb g)_x at the moment of the wheel's smoothed acceleration (the source prints a minus)."""
        sign = 1.0 if self.parameters.adhesion_sign == "sound" else -1.0
        gravity = self.orientation.gravity_x_before_mps2(tick.window.delay_s)
        return float(tick.window.specific_force_mps2[0]) + sign * gravity

    def _lasting_sd_mps2(self, tick: _Tick) -> float:
        """Standard deviation of that part of the inertial acceleration's error which stays for long."""
        parameters = self.parameters
        return math.hypot(
            GRAVITY_MPS2 * self.orientation.pitch_sd_rad,
            parameters.orientation.mounting_yaw_sd_rad * float(tick.force[1]),
            parameters.accelerometer_sd_mps2,
        )

    def _judge(self, tick: _Tick, inertial_mps2: float, margin_mps2: float, direction: int) -> None:
        """Whether the wheel is trusted from this tick on; on the change to distrust, do the last ticks again."""
        difference_mps2 = tick.window.wheel_acceleration_mps2 - inertial_mps2
        if self.wheel_trusted:
            # A window that is not full yet has no acceleration (nan): then the speed decides alone.
            if abs(difference_mps2) >= margin_mps2 or not self._speed_agrees(tick):
                self.wheel_trusted = False
                self._recovery.restart()
                self._redo()
            return
        force = direction * float(tick.window.specific_force_mps2[0])
        if abs(force) < self.parameters.wheel_force_mps2:
            free = abs(tick.window.wheel_acceleration_mps2) < _GRADIENT_MPS2
            agrees = free and self._may_roll(tick, difference_mps2)
        else:
            faster_mps = direction * self._faster_mps(tick)
            agrees = abs(difference_mps2) < margin_mps2 and (
                faster_mps * math.copysign(1.0, force) < _RECOVERED_SHARE * self.parameters.adhesion_speed_mps
            )
        if self._recovery.agreed(agrees):
            self._trust()
            if abs(difference_mps2) >= margin_mps2:
                self.orientation.doubt_pitch(difference_mps2 / GRAVITY_MPS2)

    def _faster_mps(self, tick: _Tick) -> float:
        """By how much the wheel is faster than the inertial speed."""
        return tick.wheel_mps - self.odometry.speed_mps - tick.gained_mps

    def _speed_margin_mps(self) -> float:
        """What the speed may be off by on the filter's own account."""
        return self.parameters.adhesion_speed_mps + _SIGMAS * self.odometry.speed_sd_mps

    def _may_roll(self, tick: _Tick, difference_mps2: float) -> bool:
        """Whether a wheel without force may be rolling at its speed: the inertial speed has to allow for it.

        A pitch that is off by more than the filter thinks makes the accelerations differ, and has done so to the speed
        for as long as no wheel was trusted. One that does not turn says nothing of the pitch: its brake may hold it.
        """
        margin_mps = self._speed_margin_mps()
        if tick.wheel_mps != 0.0:
            margin_mps += abs(difference_mps2) * self._inertial_s
        return abs(self._faster_mps(tick)) < margin_mps

    def _trust(self) -> None:
        self.wheel_trusted = True
        self._lookback.clear()

    def _speed_agrees(self, tick: _Tick) -> bool:
        """Wheel against the estimate of `lookback_s` ago carried on by the accelerometer."""
        if math.isnan(tick.wheel_mps):
            return False
        if not self._lookback:
            return True
        recent = list(self._lookback)
        inertial_mps = recent[0].speed_mps + sum(past.gained_mps for past in recent[1:]) + tick.gained_mps
        drift_mps = sum(past.drift_mps for past in recent) + tick.drift_mps
        margin_mps = max(self.parameters.adhesion_speed_mps, _SIGMAS * drift_mps)
        return abs(tick.wheel_mps - inertial_mps) < margin_mps

    def _redo(self) -> None:
        """Go back to where the wheel began to part from the inertial speed and come here again without the wheel."""
        ticks = list(self._lookback)
        if not ticks:
            return
        inertial_mps = ticks[0].speed_mps
        began = 0
        for k, tick in enumerate(ticks):
            inertial_mps += tick.gained_mps if k else 0.0
            if abs(tick.wheel_mps - inertial_mps) < _PARTED_SHARE * self.parameters.adhesion_speed_mps:
                began = k
        first = ticks[began]
        (
            self.orientation.kalman.x,
            self.orientation.kalman.P,
            self.odometry.kalman.x,
            self.odometry.kalman.P,
        ) = first.before
        self._origin_m = first.origin_m
        self._rolled_mps = abs(self.odometry.speed_mps)
        for tick in ticks[began:]:
            self._advance(tick)

    def _advance(self, tick: _Tick) -> None:
        """Both filters over one tick."""
        parameters = self.parameters
        tick.before = (
            self.orientation.kalman.x,
            self.orientation.kalman.P,
            self.odometry.kalman.x,
            self.odometry.kalman.P,
        )
        tick.origin_m = self._origin_m
        self.orientation.step(tick.rate, tick.window, self.wheel_trusted or self.standstill)
        rolling = self.wheel_trusted or self.standstill
        if rolling:
            self.odometry.predict(0.0, parameters.wheel_radius_sd_share)
            self._rolled_mps = abs(self.odometry.speed_mps)
            self._inertial_s = 0.0
        else:
            self._inertial_s += self.period_s
            self.odometry.predict(self._lasting_sd_mps2(tick), 0.0)
        self.odometry.update(self._rows(tick))
        tick.speed_mps = self.odometry.speed_mps

    def _rows(self, tick: _Tick) -> list[tuple[int, float, float]]:
        parameters = self.parameters
        if self.standstill:
            rows = [(A, 0.0, _STANDSTILL_SD), (V, 0.0, _STANDSTILL_SD)]
        else:
            inertial_mps2 = float(tick.force[0]) + self.orientation.gravity_x_mps2
            good = self.wheel_trusted
            sd_a = parameters.acceleration_distrusted_sd_mps2 if good else parameters.acceleration_sd_mps2
            sd_v = parameters.wheel_speed_sd_mps if good else parameters.wheel_speed_distrusted_sd_mps
            rows = [(A, inertial_mps2, sd_a)]
            if not math.isnan(tick.wheel_mps):
                rows.append((V, tick.wheel_mps, sd_v))
        if parameters.balise == "sound":
            if not math.isnan(tick.balise_m):
                here_m = tick.balise_m + self.odometry.speed_mps * tick.balise_age_s
                rows.append((P, here_m, parameters.balise_sd_m))
        elif abs(self.odometry.position_m - parameters.balise_spacing_m) < _PRINTED_BALISE_WINDOW_M:
            self._origin_m += parameters.balise_spacing_m
            rows.append((P, 0.0, _PRINTED_BALISE_SD_M))
        return rows

    def _estimate(self, sample: Sample) -> Estimate:
        parameters, odometry, orientation = self.parameters, self.odometry, self.orientation
        position_m, speed_mps = self._origin_m + odometry.position_m, odometry.speed_mps
        spread_m = parameters.bound_sigmas * odometry.position_sd_m
        # The radius' error stands in the speed for as long as that comes from a wheel, or from what a wheel said last.
        radius_mps = parameters.wheel_radius_sd_share * self._rolled_mps
        spread_mps = parameters.bound_sigmas * math.hypot(odometry.speed_sd_mps, radius_mps)
        return Estimate(
            t_s=sample.t_s,
            position_m=position_m,
            position_lower_m=position_m - spread_m,
            position_upper_m=position_m + spread_m,
            speed_mps=speed_mps,
            speed_lower_mps=speed_mps - spread_mps,
            speed_upper_mps=speed_mps + spread_mps,
            acceleration_mps2=odometry.acceleration_mps2,
            gradient_permille=-1000.0 * math.tan(orientation.pitch_rad),
            roll_rad=orientation.roll_rad,
            pitch_rad=orientation.pitch_rad,
            yaw_rad=orientation.yaw_rad,
            direction=sample.direction,
            valid=True,
        )
