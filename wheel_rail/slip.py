"""What the creep laws share: the friction at a slip speed, the total creepage and its direction.

Functions of `Lanes` take floats as well.
"""

import math

from wheel_rail.compiled import Array, compiled, inlined
from wheel_rail.lanes import Lanes, where


@inlined
def friction(rail: Array, slip_speed_mps: Lanes) -> Lanes:
    """mu(w) = mu0 ((1 - A) exp(-B w) + A), `rail` = (mu0, A, B in s/m, kA, kS). O. Polach, Wear 258 (2005) 992-1000."""
    return rail[0] * ((1.0 - rail[1]) * math.exp(-rail[2] * slip_speed_mps) + rail[1])


@inlined
def tangent_with_fall(
    tangent: Lanes, force_n: Lanes, creep: Lanes, slip_speed_mps: Lanes, mu: Lanes, rail: Array
) -> Lanes:
    """Tangent dF/ds when the slip speed grows with the creep, from the `tangent` at fixed friction.

    `force_n` along the slip at resultant creepage `creep` without spin. Forces are homogeneous in creepage and mu N, so
    what the force does not owe to the creepage, F - s dF/ds, it owes to mu N (exact without spin).
    """
    fall = -rail[2] * (mu - rail[0] * rail[1]) / mu
    return where(creep < 1e-14, tangent, tangent + (force_n - tangent * creep) * fall * slip_speed_mps / creep)


@compiled
def total_creep(creep_x: float, creep_y: float, spin_1pm: float, a_m: float) -> float:
    """Resultant creepage sqrt(xi^2 + etac^2), etac the larger in size of eta and eta + phi a.

    Source: O. Polach, Vehicle System Dynamics Supplement 33 (1999) 728-739, eq. 4.
    """
    counted = counted_lateral_creep(creep_y, spin_1pm, a_m)
    return math.sqrt(creep_x * creep_x + counted * counted)


@inlined
def counted_lateral_creep(creep_y: Lanes, spin_1pm: Lanes, a_m: Lanes) -> Lanes:
    """Lateral creepage with spin where spin increases it (etac of `total_creep`)."""
    with_spin = creep_y + spin_1pm * a_m
    return where(abs(with_spin) > abs(creep_y), with_spin, creep_y)


@compiled
def slip_direction(creep_x: float, creep_y: float) -> tuple[float, float]:
    """Unit vector along the creepage without spin; along the track where there is none."""
    size = math.sqrt(creep_x * creep_x + creep_y * creep_y)
    if size < 1e-14:
        return 1.0, 0.0
    return creep_x / size, creep_y / size
