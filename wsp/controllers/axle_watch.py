"""What is believed of the axles: smooth speeds, worn wheels allowed for, frozen and impossible readings left out.

An axle without a believable speed is "blind": its speed is nan.
"""

import numpy as np
from numpy.typing import NDArray

from wsp.axle_speed import compare_wheels, fading_memory_after
from wsp.compiled import Record
from wsp.controllers.interface import AXLES
from wsp.controllers.records import part_of_tick

_LARGEST_NOISE_MPS2 = 5.0  # in the acceleration of a wheel that rolls freely
_LEVEL_SHARE = 0.01  # within this readings count as equal; a frozen one stands out by more
_LEVEL_MPS = 0.1

# An axle that slides without its brake gains speed with its whole adhesion, 0.6 m/s2 at least even deep in the slide on
# rail of 0.02; one that rolls gains none but what the train may gain downhill.
_ROLLS_FOR_S = 0.5
_GAINS_LESS_MPS = 0.1
_ROLLS_ABOVE_SHARE = 0.6  # of the reference: no wheel diameter or tooth count is wrong by more


@part_of_tick
def _frozen(s: Record, c: Record, reading_mps: NDArray[np.float64], axle: int) -> bool:
    """Whether an axle's reading has not moved by a bit for too long while all the others are slower.

    Only then does it do harm: the reference speed would stay up with it. A locked axle reads zero all the time.
    """
    if reading_mps[axle] == s.last_reading_mps[axle]:
        s.same_reading[axle] = min(s.same_reading[axle] + 1, c.frozen_after)
    else:
        s.last_reading_mps[axle] = reading_mps[axle]
        s.same_reading[axle] = 0
    if s.same_reading[axle] < c.frozen_after:
        return False
    for other in range(AXLES):
        if other != axle and abs(reading_mps[other]) > (1.0 - _LEVEL_SHARE) * abs(reading_mps[axle]):
            return False
    return True


@part_of_tick
def follow_axles(
    s: Record, c: Record, reading_mps: NDArray[np.float64], valid: NDArray[np.uint8], direction: int
) -> None:
    """Filtered speed and acceleration of every axle in the direction of travel, >= 0; nan for a blind one."""
    for axle in range(AXLES):
        frozen = _frozen(s, c, reading_mps, axle)
        measured = max(0.0, direction * reading_mps[axle] / s.wheel_ratio[axle])
        if frozen or s.distrusted[axle] or not valid[axle] or not np.isfinite(reading_mps[axle]):
            s.speed_mps[axle] = np.nan
        elif np.isnan(s.speed_mps[axle]):
            s.speed_mps[axle] = measured
            s.acceleration_mps2[axle] = -s.deceleration_mps2
        else:
            s.speed_mps[axle], s.acceleration_mps2[axle] = fading_memory_after(
                s.speed_mps[axle], s.acceleration_mps2[axle], measured, c.filter_memory, c.period_s
            )


@part_of_tick
def _against_others(s: Record, reading_mps: NDArray[np.float64], valid: NDArray[np.uint8], axle: int) -> float:
    """How far an axle is from the mean of the others that are believed, as a share of it; nan without two of them."""
    total = 0.0
    count = 0
    for other in range(AXLES):
        if other != axle and valid[other] and not s.distrusted[other]:
            total += reading_mps[other]
            count += 1
    if count < 2 or total == 0.0:  # of two that differ, neither is known to be the wrong one
        return np.nan
    return abs(reading_mps[axle] * count / total - 1.0)


@part_of_tick
def _judge(s: Record, c: Record, reading_mps: NDArray[np.float64], valid: NDArray[np.uint8]) -> None:
    """Stop believing the axle that differs most, if it has differed for too long; believe one that agrees again.

    Either starts the reference speed anew.
    """
    worst, farthest = -1, 0.0
    for axle in range(AXLES):
        difference = _against_others(s, reading_mps, valid, axle)
        if valid[axle] and not s.distrusted[axle] and difference > farthest:
            worst, farthest = axle, difference
    for axle in range(AXLES):
        if s.distrusted[axle]:
            counts = bool(valid[axle]) and _against_others(s, reading_mps, valid, axle) <= c.largest_wheel_difference
        else:
            counts = axle == worst and farthest > c.largest_wheel_difference
        s.judged[axle] = s.judged[axle] + 1 if counts else 0
        if s.judged[axle] >= c.distrust_after:
            s.distrusted[axle] = 1 - s.distrusted[axle]
            s.judged[axle] = 0
            s.started = False


@part_of_tick
def compare_axles(s: Record, c: Record, reading_mps: NDArray[np.float64], valid: NDArray[np.uint8]) -> None:
    """While unbraked: find liars, learn the readings' noise and the wheels' ratios (running means, fading later)."""
    if not s.reference_mps >= c.compare_above_mps or abs(s.deceleration_mps2) > c.compare_below_mps2:
        return
    _judge(s, c, reading_mps, valid)
    s.compared = min(s.compared + 1, c.compare_memory)
    for axle in range(AXLES):
        noise = abs(s.acceleration_mps2[axle] + s.deceleration_mps2)
        if not np.isnan(s.speed_mps[axle]) and noise < _LARGEST_NOISE_MPS2:
            s.noise_mps2[axle] += (noise - s.noise_mps2[axle]) / s.compared
    if valid.all():
        compare_wheels(s.wheel_ratio, reading_mps, s.distrusted == 0, 1.0 / s.compared, c.largest_wheel_difference)


@part_of_tick
def _rolls_unbraked(s: Record, c: Record, axle: int) -> bool:
    """Whether an axle below the reference speed has gained none for some time although its brake must be out."""
    speed, reference = s.speed_mps[axle], s.reference_mps
    below = _ROLLS_ABOVE_SHARE * reference < speed < (1.0 - _LEVEL_SHARE) * reference - _LEVEL_MPS
    if not below or s.vented[axle] < c.empty_after or axle == s.relieved:
        s.rolls[axle] = 0
        return False
    if s.rolls[axle] == 0 or speed > s.rolls_from_mps[axle] + _GAINS_LESS_MPS:
        s.rolls[axle] = 0
        s.rolls_from_mps[axle] = speed
    s.rolls[axle] += 1
    return bool(s.rolls[axle] * c.period_s >= _ROLLS_FOR_S)


@part_of_tick
def motion_of_rolling_axles(s: Record, c: Record) -> tuple[float, float]:
    """Speed (m/s) and mean acceleration (m/s2) of two or more axles that roll alike below the reference speed.

    nan if none do. They have no brake and do not slide, so that the train goes at their speed. Whoever is ahead of them
    is not believed any more: a wheel smaller than supposed, too many teeth counted.
    """
    count = 0
    speed = 0.0
    slowest = np.inf
    acceleration = 0.0
    for axle in range(AXLES):
        if _rolls_unbraked(s, c, axle):
            count += 1
            speed = max(speed, s.speed_mps[axle])
            slowest = min(slowest, s.speed_mps[axle])
            acceleration += s.acceleration_mps2[axle]
    if count < 2 or slowest < (1.0 - _LEVEL_SHARE) * speed - _LEVEL_MPS:
        return np.nan, np.nan
    for axle in range(AXLES):
        if s.speed_mps[axle] > (1.0 + _LEVEL_SHARE) * speed + _LEVEL_MPS:
            s.distrusted[axle] = 1
    return speed, acceleration / count
