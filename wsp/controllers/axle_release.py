"""Release of one axle in rotation: what the train's speed is when all axles slide.

When no axle has come up to the prediction of the reference speed for too long, one axle is relieved (the controller
takes pressure off it) until it rolls evenly. Its speed is the train's then, and the deceleration the one that leads to
it from the last speed known for certain.
"""

import numpy as np

from wsp.compiled import Record
from wsp.controllers.interface import AXLES
from wsp.controllers.records import part_of_tick

NO_AXLE = -1

# What the mean of a relieved axle's acceleration starts from, with the sign of what it does: valves and air need their
# time, and an axle that is not relieved yet may slide as evenly as a free one rolls.
_NOT_ROLLING_MPS2 = 2.0

_CREEP_COUNTS_FOR_S = 1.0
_LEVEL_WITH_FASTEST_MPS = 0.5  # only axles that slip so little more than the fastest are relieved: they soon grip
_SHORTEST_TIME_BETWEEN_S = 1.5
_STILL_FALLS_AFTER_S = 0.4
_TAKES_LONG_S, _MORE_TOLERANT = 1.0, 1.6


@part_of_tick
def still_falls(s: Record, c: Record) -> bool:
    """Whether the relieved axle goes on losing speed against the train although its relief must have acted by now."""
    return s.relieved_ticks * c.period_s >= _STILL_FALLS_AFTER_S and s.rolling_mps2 < -c.rolling_mps2


@part_of_tick
def take_as_certain(s: Record) -> None:
    """The reference speed is taken as known now."""
    s.unsupported = 0
    s.reckoned_mps = 0.0
    s.supported_mps = s.reference_mps


@part_of_tick
def _level_with_fastest(s: Record, axle: int) -> bool:
    """False for a blind axle."""
    for other in range(AXLES):
        if s.speed_mps[axle] < s.speed_mps[other] - _LEVEL_WITH_FASTEST_MPS:
            return False
    return not np.isnan(s.speed_mps[axle])


@part_of_tick
def _next_to_relieve(s: Record) -> int:
    """The next axle in rotation among those that slip least; NO_AXLE if all are blind."""
    axle = s.relieved_last
    for _ in range(AXLES):
        axle = (axle + 1) % AXLES
        if _level_with_fastest(s, axle):
            return axle
    return NO_AXLE


@part_of_tick
def _due(s: Record, c: Record) -> bool:
    """Whether the speed has gone without support for too long, or may by now have gone wrong by too much."""
    longest = max(_SHORTEST_TIME_BETWEEN_S, c.release_error_mps / s.unsure_mps2)
    return s.unsupported * c.period_s > min(c.release_after_s, longest)


@part_of_tick
def relieve_in_rotation(s: Record, c: Record, wanted: bool) -> None:
    """Choose the axle to be relieved, and take its speed for the train's when it rolls evenly; once a tick."""
    axle = s.relieved
    if axle == NO_AXLE:
        if wanted and _due(s, c):
            axle = _next_to_relieve(s)
            if axle != NO_AXLE:
                s.relieved = axle
                s.relieved_last = axle
                falls = s.acceleration_mps2[axle] + s.deceleration_mps2 < 0.0
                s.rolling_mps2 = -_NOT_ROLLING_MPS2 if falls else _NOT_ROLLING_MPS2
            s.relieved_ticks = 0
            s.rolled_ticks = 0
        return
    s.relieved_ticks += 1
    s.rolling_mps2 += (s.acceleration_mps2[axle] + s.deceleration_mps2 - s.rolling_mps2) * c.rolling_share
    # an axle that begins to gain speed passes through the train's acceleration as well, but does not stay at it; one
    # that takes long is judged less strictly, as it may be the train's that is not as supposed
    tolerance = c.rolling_mps2 * (1.0 if s.relieved_ticks * c.period_s < _TAKES_LONG_S else _MORE_TOLERANT)
    rolls = s.grips and abs(s.rolling_mps2) < tolerance and _level_with_fastest(s, axle)  # a locked one goes evenly too
    s.rolled_ticks = s.rolled_ticks + 1 if rolls else 0
    if wanted and s.rolled_ticks >= c.rolling_for:
        fallen = s.supported_mps - s.speed_mps[axle]
        # both speeds are wrong by a little creep, which over a short time would count for too much
        error = (fallen - s.reckoned_mps) / (s.unsupported * c.period_s + _CREEP_COUNTS_FOR_S)
        s.unsure_mps2 = max(abs(error), 0.5 * s.unsure_mps2)
        s.deceleration_mps2 = min(max(s.deceleration_mps2 + error, -c.fall_limit_mps2), c.fall_limit_mps2)
        s.reference_mps = s.speed_mps[axle]
        s.relieved = NO_AXLE
        take_as_certain(s)
    elif not wanted or np.isnan(s.speed_mps[axle]) or s.relieved_ticks >= c.release_longest:
        s.relieved = NO_AXLE
