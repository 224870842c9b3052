"""Reference speed of the WSP: the fastest axle or the mean of them, with a limited fall.

While braking no wheel runs faster than the train, so the fastest one is the best guess; but when all slide it falls
with them. The estimate is a speed and a deceleration, carried on from tick to tick:

    predicted = speed - deceleration dt,   e = fastest - predicted
    e >= 0: the speed follows up by at most rise_limit dt; the deceleration declines by at most jerk_decline dt
    e <  0: the speed falls below the prediction by at most fall_margin dt; the deceleration grows by at most
            jerk_limit dt

so a wheel that slides away pulls the reference down by little more than the train's own deceleration, and the next
one that grips puts it right. A fixed fall limit of 1.5..2 m/s2 alone does not do: on rail of 0.05 the train brakes at
0.5 m/s2 and four wheels sliding together at 1.5 m/s2 would take the reference down with them. Hence two sets of
limits: wide ones while no axle is being controlled (a full service application is 0.25 m/s3), narrow ones while the
WSP is at work.

Even so, four wheels that slide away together slowly (rail below 0.03, part of the brake demanded) take it along for as
long as none of them grips. `axle-release` therefore counts the time in which no axle has come up to the prediction;
when it is over, one axle, the next in rotation, is relieved until it rolls evenly. Its speed is the train's; the
deceleration is then the one that leads from the last speed known for certain to this one.
"""

from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from wsp.compiled import compiled

SOURCES = ("mean-of-axles", "fastest-axle", "axle-release")


class ReferenceSpeedParameters(BaseModel):
    """Source and limits. The narrow limits and the release were chosen on the rails of the tests, 0.02..0.08.

    An outside speed, where the controller is given one, replaces that of any source.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    source: Literal["mean-of-axles", "fastest-axle", "axle-release"] = Field(
        default="axle-release", description="axle-release: the fastest axle, and one axle relieved when all slide"
    )
    fall_limit_mps2: float = Field(
        default=1.8,
        gt=0.0,
        le=5.0,
        description="largest deceleration believed; M: 1.5..2, normal braking stays below 1.2",
    )
    fall_margin_mps2: float = Field(default=0.25, gt=0.0, le=5.0, description="fall beyond the deceleration learned")
    fall_margin_at_work_mps2: float = Field(
        default=0.05, gt=0.0, le=5.0, description="the same while the WSP is at work"
    )
    jerk_limit_mps3: float = Field(
        default=0.5, gt=0.0, le=10.0, description="growth of the deceleration; full service in 4 s is 0.25"
    )
    jerk_limit_at_work_mps3: float = Field(
        default=0.05, gt=0.0, le=10.0, description="the same while the WSP is at work"
    )
    jerk_decline_mps3: float = Field(default=1.0, gt=0.0, le=10.0, description="decline of the deceleration")
    jerk_gain_ps2: float = Field(default=20.0, gt=0.0, le=1000.0, description="jerk per m/s of e, up to those limits")
    rise_limit_mps2: float = Field(
        default=8.0,
        gt=0.0,
        le=50.0,
        description="a gripping wheel spins up at 5..10 m/s2; a faulty pulse jumps further",
    )
    release_after_s: float = Field(
        default=4.0, gt=0.0, le=60.0, description="at the latest, with no axle up to the prediction; M: 1..3 s"
    )
    release_error_mps: float = Field(
        default=0.2,
        gt=0.0,
        le=5.0,
        description="or when the speed may have gone wrong by this, as the last relief found the deceleration wrong",
    )
    release_longest_s: float = Field(default=4.0, gt=0.0, le=5.0, description="an axle is relieved no longer than this")
    rolling_s: float = Field(
        default=0.15, gt=0.0, le=5.0, description="memory of a relieved axle's mean acceleration, ..."
    )
    rolling_mps2: float = Field(
        default=0.5,
        gt=0.0,
        le=5.0,
        description="... and it rolls evenly when that has been within this of the train's for as long",
    )


@compiled
def reference_after(
    speed_mps: float,
    deceleration_mps2: float,
    fastest_mps: float,
    period_s: float,
    fall_margin_mps2: float,
    jerk_limit_mps3: float,
    common_limits: tuple[float, float, float, float],
) -> tuple[float, float]:
    """Reference speed (m/s, >= 0) and deceleration (m/s2) one period on: the equations at the head of this file.

    fastest_mps nan: no axle to go by, dead reckoning. common_limits: fall_limit_mps2, jerk_decline_mps3, jerk_gain_ps2,
    rise_limit_mps2.
    """
    fall_limit_mps2, jerk_decline_mps3, jerk_gain_ps2, rise_limit_mps2 = common_limits
    speed = speed_mps - deceleration_mps2 * period_s
    deceleration = deceleration_mps2
    if not np.isnan(fastest_mps):
        error = fastest_mps - speed
        if error >= 0.0:
            speed += min(error, rise_limit_mps2 * period_s)
            deceleration -= min(jerk_gain_ps2 * error, jerk_decline_mps3) * period_s
        else:
            speed += max(error, -fall_margin_mps2 * period_s)
            deceleration += min(-jerk_gain_ps2 * error, jerk_limit_mps3) * period_s
    if speed <= 0.0:
        return 0.0, 0.0
    return speed, min(max(deceleration, -fall_limit_mps2), fall_limit_mps2)
