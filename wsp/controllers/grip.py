"""Which axles grip: a sliding wheelset answers to its brake, one that grips does not.

Sliding, a rim's acceleration is f - b p: adhesion f, which is nearly constant for a moment, less what its brake takes.
One that grips goes on with the train, whatever its pressure p does. So the changes of the speed and those of the
brake's effect, each freed of what is constant or steady,

    answer = H v,   expected = H (-integral of b p dt),   H = s^2/(s + 1/T)^2

are equal for a sliding wheelset, while there is no answer to be seen of one that grips. Where the adhesion changes
along the rail, control lets the pressure follow it and there is as little answer: grip is then found where there is
none. Hence the limits on what follows from it: between two speeds known for certain the reference is lowered by no more
than what a little more slip does no harm to.
"""

from typing import Any

import numpy as np

from wsp.compiled import Record
from wsp.controllers.axle_release import NO_AXLE
from wsp.controllers.cylinder_model import committed_before
from wsp.controllers.interface import AXLES
from wsp.controllers.limits import sighted
from wsp.controllers.records import part_of_tick

_MEMORY_S = 0.25  # T
_LEAST_EXPECTED_MPS = 0.2  # several times the noise of a speed
_EXPECTED_S = 0.01  # times the adhesion, which changes by a third within T at most
_ANSWER_SHARE = 0.3  # of what is expected, below which there is none
_TICKS = 8
_LEVEL_MPS = 0.1
_CREEP_SHARE = 0.3  # of its set-point that a gripping axle may creep
_FALLS_MPS2 = 0.6  # so much faster than the train a gripping axle does not lose speed
_LOWERED_MPS2, _LOWERED_MPS = 0.4, 0.3


def grip_state() -> dict[str, Any]:
    """State by name, by axle: means over T of speed, of its change, of the brake's effect and its change; ticks."""
    return {
        "steady_mps": np.full(AXLES, np.nan),
        "steady_change_mps": np.zeros(AXLES),
        "steady_mps2": np.zeros(AXLES),
        "steady_change_mps2": np.zeros(AXLES),
        "grips_for": np.zeros(AXLES, np.int64),
    }


@part_of_tick
def _follow(s: Record, c: Record, axle: int) -> None:
    """Answer and expectation of an axle one tick on."""
    share = c.period_s / _MEMORY_S
    speed = s.speed_mps[axle]
    effect = c.mps2_per_bar * committed_before(s, axle, c.delay)
    if np.isnan(speed):
        s.grips_for[axle] = 0
        s.steady_mps[axle] = np.nan
        return
    if np.isnan(s.steady_mps[axle]):
        s.steady_mps[axle] = speed
        s.steady_change_mps[axle] = 0.0
    s.steady_mps[axle] += share * (speed - s.steady_mps[axle])
    change = speed - s.steady_mps[axle]
    s.steady_change_mps[axle] += share * (change - s.steady_change_mps[axle])
    answer = change - s.steady_change_mps[axle]
    s.steady_mps2[axle] += share * (effect - s.steady_mps2[axle])
    s.steady_change_mps2[axle] += share * (s.steady_mps2[axle] - s.steady_change_mps2[axle])
    expected = _MEMORY_S * abs(s.steady_mps2[axle] - s.steady_change_mps2[axle])
    enough = _LEAST_EXPECTED_MPS + _EXPECTED_S * s.adhesion_mps2[axle]
    falls = -s.steady_change_mps[axle] / _MEMORY_S - s.deceleration_mps2 > _FALLS_MPS2
    silent = expected > enough and abs(answer) < _ANSWER_SHARE * expected and not falls
    s.grips_for[axle] = s.grips_for[axle] + 1 if silent else 0


@part_of_tick
def grips(s: Record, axle: int) -> bool:
    """Whether an axle has been found to grip just now."""
    return bool(s.grips_for[axle] >= _TICKS)


@part_of_tick
def go_by_gripping_axles(s: Record, c: Record) -> None:
    """The train is not faster than an axle that grips; once a tick."""
    fastest = NO_AXLE
    for axle in range(AXLES):
        _follow(s, c, axle)
        if sighted(s, axle) and (fastest == NO_AXLE or s.speed_mps[axle] > s.speed_mps[fastest]):
            fastest = axle
    if fastest == NO_AXLE:
        return
    for axle in range(AXLES):
        over = s.reference_mps - s.speed_mps[fastest] - _CREEP_SHARE * s.slip_set_mps[axle]
        level = sighted(s, axle) and s.speed_mps[axle] > s.speed_mps[fastest] - _LEVEL_MPS
        if level and grips(s, axle):
            lowered = s.supported_mps - s.reckoned_mps - s.reference_mps
            s.reference_mps -= max(0.0, min(over, _LOWERED_MPS2 * c.period_s, _LOWERED_MPS - lowered))
            return
