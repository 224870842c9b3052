"""Peak adhesion: the highest point of adhesion over longitudinal creep up to LARGEST_CREEP, and where it lies.

The curve may have two maxima, a steep one and one made by cleaning. It is scanned over the logarithm of creep, values
and slopes: the cubics between its places tell which of its maxima is the highest. Cubics then close in on it and, where
they do not get on (at the kink of a law that is cut off, say), golden sections. One search serves a wheel under any law
and, in lanes, eight wheels at once under Polach's.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from wheel_rail.compiled import Array, Vector, compiled, inlined
from wheel_rail.creep_laws import POLACH
from wheel_rail.lane_arrays import lanes_at, put_lanes
from wheel_rail.lane_functions import cube_root
from wheel_rail.lanes import LANES, Lanes, every, greater, where
from wheel_rail.recovery import (
    CONDITION,
    DEGRADED,
    ENERGY,
    RECOVERED,
    TAU,
    adhesive_force,
    curves_of_wheels,
    polach_adhesion,
)

LARGEST_CREEP = 0.3
_LOWEST_CREEP = 1e-4
_PARTS = 9  # of the scan
_PART = math.log(LARGEST_CREEP / _LOWEST_CREEP) / _PARTS
_RATIO = math.exp(_PART)
_CLOSE = 3e-5  # to the maximum, in the logarithm of creep, and
_GAIN = 1e-6  # what may be missing, of the peak, if the curve bends no way but down
_MOST = 30  # golden sections alone come as close in 21
_GOLDEN = 0.3819660112501051


@compiled
def offered_adhesion(
    law: int, address: int, extra: Array, speed_mps: float, normal_force_n: float, patch: Vector, condition: Array,
    shear_modulus_pa: float, own_cleaning: bool,
) -> tuple[float, float]:  # fmt: skip
    """Peak adhesion on offer to one wheel, and the creep where it lies.

    `own_cleaning`: whether the wheel may clean the rail for itself (what it can use), or the rail is taken as it lies
    before the wheel (as found). The other arguments are those of `adhesive_force`.
    """
    wheel = (
        law, address, extra, speed_mps, _cleaning_speed(speed_mps, own_cleaning), normal_force_n, patch, condition,
        shear_modulus_pa,
    )  # fmt: skip
    return _search(_one_wheel, wheel)


@compiled
def offered_to_wheels(
    law: int, address: int, extra: Array, speed_mps: Array, normal_force_n: Array, patch: Vector,
    reference_load_n: float, conditions: Array, shear_modulus_pa: float, own_cleaning: bool, peak: Array, creep: Array,
) -> None:  # fmt: skip
    """`offered_adhesion` to eight wheels, into `peak` and `creep`; zero to those that bear nothing.

    `speed_mps`, `normal_force_n`, `peak`, `creep` (LANES,); `conditions` (CONDITION, LANES); `patch`: the contact
    ellipse under `reference_load_n`, which grows with the cube root of the load.
    """
    if law == POLACH:
        speed, load = lanes_at(speed_mps, 0), lanes_at(normal_force_n, 0)
        borne = where(load > 0.0, load, reference_load_n)
        wheels = (
            speed, _cleaning_speed(speed, own_cleaning), borne, _grown(patch, borne, reference_load_n),
            curves_of_wheels(conditions, DEGRADED), curves_of_wheels(conditions, RECOVERED),
            lanes_at(conditions, TAU * LANES), lanes_at(conditions, ENERGY * LANES), shear_modulus_pa,
        )  # fmt: skip
        found, place = _search(_polach_wheels, wheels)
        put_lanes(peak, 0, where(load > 0.0, found, 0.0))
        put_lanes(creep, 0, where(load > 0.0, place, 0.0))
        return
    condition = np.empty(CONDITION)
    for w in range(LANES):
        peak[w] = creep[w] = 0.0
        condition[:] = conditions[:, w]
        if normal_force_n[w] > 0.0:
            peak[w], creep[w] = offered_adhesion(
                law, address, extra, speed_mps[w], normal_force_n[w],
                _grown(patch, normal_force_n[w], reference_load_n), condition, shear_modulus_pa, own_cleaning,
            )  # fmt: skip


@inlined
def _cleaning_speed(speed_mps: Lanes, own_cleaning: bool) -> Lanes:
    """Speed to which the wheel's work is referred; over an endless way it cleans nothing."""
    return speed_mps if own_cleaning else speed_mps + math.inf


@inlined
def _grown(patch: Vector, load_n: Lanes, reference_load_n: float) -> Vector:
    growth = cube_root(load_n / reference_load_n)
    return patch[0] * growth, patch[1] * growth, patch[2], patch[3], patch[4], patch[5]


@compiled
def _one_wheel(creep: float, wheel: Any) -> tuple[float, float]:
    """Adhesion |Fx|/N of a wheel under any law, and its slope over the logarithm of creep."""
    law, address, extra, speed, cleaning_speed, load, patch, condition, shear = wheel
    fx, _, tangent, _ = adhesive_force(
        law, address, extra, creep, 0.0, 0.0, creep * speed, cleaning_speed, load, patch, condition, shear
    )
    return -fx / load, tangent * creep / load


@compiled
def _polach_wheels(creep: Lanes, wheels: Any) -> tuple[Lanes, Lanes]:
    """The same of eight wheels under Polach's law."""
    speed, cleaning_speed, load, patch, degraded, recovered, tau, energy, shear = wheels
    each = creep + 0.0 * load
    fx, _, tangent, _ = polach_adhesion(
        each, 0.0, 0.0, each * speed, cleaning_speed, load, patch, degraded, recovered, tau, energy, shear
    )
    return -fx / load, tangent * each / load


@inlined
def _search(curve: Callable[..., tuple[Lanes, Lanes]], wheel: Any) -> tuple[Lanes, Lanes]:
    """Highest adhesion, and its creep; `curve(creep, wheel)` gives adhesion and its slope over the logarithm of creep.

    Slopes propose the places to look at, values decide. A lane that has arrived waits for the others.
    """
    creep = _LOWEST_CREEP
    ahead, ahead_slope = curve(creep, wheel)
    f, g = ahead, ahead_slope
    # the best place (logarithm of creep over the lowest), how far to the ends of its bracket, and what is there
    best, slope, low, low_slope, high, high_slope = f, g, f, g, f, g
    place = below = above = 0.0 * f
    highest = f - 1.0
    seen, seen_at = f, place
    for k in range(_PARTS + 1):
        behind, behind_slope, f, g = f, g, ahead, ahead_slope
        if k < _PARTS:
            creep *= _RATIO
            ahead, ahead_slope = curve(creep, wheel)
        seen, seen_at = where(f > seen, f, seen), where(f > seen, k * _PART, seen_at)
        down, up = _PART if k > 0 else 0.0, _PART if k < _PARTS else 0.0
        rises = g > 0.0
        _, top = _top(
            where(rises, up, down), f, abs(g), where(rises, ahead, behind), where(rises, ahead_slope, -behind_slope)
        )
        chosen = (f >= behind) & (f >= ahead) & (top > highest)
        highest = where(chosen, top, highest)
        best, slope, place = where(chosen, f, best), where(chosen, g, slope), where(chosen, k * _PART, place)
        low, low_slope = where(chosen, behind, low), where(chosen, behind_slope, low_slope)
        high, high_slope = where(chosen, ahead, high), where(chosen, ahead_slope, high_slope)
        below, above = where(chosen, down, below), where(chosen, up, above)
    last = place + math.inf  # step of a cubic; a new one that is no shorter than half of it gains too little
    for _ in range(_MOST):
        rises = slope > 0.0
        width = where(rises, above, below)
        step, _ = _top(width, best, abs(slope), where(rises, high, low), where(rises, high_slope, -low_slope))
        slow = step > 0.5 * last
        done = (where(slow, greater(above, below), step) <= _CLOSE) & (slow | (abs(slope) * width <= _GAIN * best))
        step = where(rises, step, -step)
        place = where(done, place + where(slow, 0.0, step), place)
        above, below = where(done, 0.0, above), where(done, 0.0, below)
        if every(done):
            break
        step = where(slow, where(above > below, _GOLDEN * above, -_GOLDEN * below), where(done, 0.0, step))
        f, g = curve(_LOWEST_CREEP * math.exp(place + step), wheel)
        better, worse = f > best, f <= best
        last = where(slow, math.inf, where(worse, 0.0, abs(step)))
        # of the two places the one that is not the best from here on is an end of the bracket
        new_low = ((step > 0.0) & better) | ((step < 0.0) & worse)
        new_high = ((step < 0.0) & better) | ((step > 0.0) & worse)
        end, end_slope = where(better, best, f), where(better, slope, g)
        low, low_slope = where(new_low, end, low), where(new_low, end_slope, low_slope)
        high, high_slope = where(new_high, end, high), where(new_high, end_slope, high_slope)
        below = where(new_low, abs(step), where(better, below + step, below))
        above = where(new_high, abs(step), where(better, above - step, above))
        best, slope, place = where(better, f, best), where(better, g, slope), where(better, place + step, place)
    # a cubic may have promised too much
    return greater(best, seen), _LOWEST_CREEP * math.exp(where(best < seen, seen_at, place))


@compiled
def _top(width: Lanes, near: Lanes, slope: Lanes, far: Lanes, far_slope: Lanes) -> tuple[Lanes, Lanes]:
    """Maximum of the cubic between two points with these values and slopes: how far it is from the near one, whose
    slope is not negative, and how high; the near point itself where there is none in between."""
    rise, a, b = far - near, width * slope, width * far_slope
    square, cube = 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise
    # this form of the root bears a cubic that is a parabola
    share = a / (math.sqrt(greater(square * square - 3.0 * cube * a, 0.0)) - square)
    share = where((share > 0.0) & (share < 1.0), share, 0.0)
    return share * width, near + share * (a + share * (square + share * cube))
