"""Degraded adhesion that cleaning restores: the specific-energy model, with what the rail keeps.

f = (1 - lambda) f_d + lambda f_r, lambda = 1 - exp(-tau (E + W)), W = f N e: f_d and f_r are the creep law on the
degraded and on the recovered friction curve, W is what the wheel itself dissipates per metre of rail (e its creep), and
E what the rail has kept from the wheels before, both in J/m. f depends on W and W on f; the equation is solved exactly.
Source: B. Allotta, E. Meli, A. Ridolfi, A. Rindi, Tribology International 2014 and Meccanica 49, 2014, where each wheel
meets W alone; the rail that keeps E is added here.
"""

import math
from typing import Any

from numba.extending import overload

from wheel_rail.compiled import Array, Vector, compiled, inlined
from wheel_rail.creep_laws import POLACH, creep_force
from wheel_rail.lane_arrays import lanes_at
from wheel_rail.lanes import LANES, Lanes, LanesType, every, greater, lane, lanes_of, lesser, where
from wheel_rail.polach import polach_on_curve, polach_slip

# layout of a wheel's rail condition: two friction curves, what lies between them, and what the rail carries
MU0, FALLING_A, FALLING_B, K_ADHESION, K_SLIP = range(5)
DEGRADED, RECOVERED, TAU, ENERGY, SAND = 0, 5, 10, 11, 12
CONDITION = 13
"""(mu0, A, B in s/m, kA, kS) of the degraded and of the recovered curve, tau in m/J, E in J/m, sand in g/m."""

LOWEST_SPEED_MPS = 0.1
"""Speed that counts at least where work is referred to the way: a wheel that spins at rest does not clean for ever."""


@inlined
def _growth(z: Lanes) -> Lanes:
    """g = exp(x) with x exp(-x) = z and x <= 1 (Lambert's W: x = -W0(-z)), for z <= 1/e.

    Where wheels mostly are, a polynomial fitted to it (1e-12).
    """
    if every((z >= -0.01) & (z <= 0.12)):
        z2 = z * z
        z4 = z2 * z2
        low = 1.0000000000240095 + 1.4999999641113373 * z + z2 * (2.666667853818012 + 5.208555257506981 * z)
        middle = 10.78054332110237 + 24.031436323605 * z + z2 * (38.78765701510455 + 265.68515807306676 * z)
        return 1.0 + z * (low + z4 * (middle + z4 * (3404.9470485670136 * z - 644.414883801599)))
    return _growth_of_each(z)


@compiled
def _growth_anywhere(z: float) -> float:
    """`_growth` by a start good to 2e-5 and one step of fourth order: relative error below 1e-13 but for a few 1e-9
    near z = 1/e. Source of the step: F. N. Fritsch, R. E. Shafer, W. P. Crowley, Commun. ACM 16 (1973) 123-124.
    """
    steps = 1
    if z >= 0.0:
        q = math.sqrt(max(1.0 - math.e * z, 0.0))
        g = 2.71822512 + q * (-3.8388459 + q * (4.4421839 + q * (-4.44196584 + q * (3.43422443 + q * (
            -1.69262695 + q * 0.3788261)))))  # fmt: skip
    else:
        g = (1.0 - z) ** -0.8
        steps = 2
    for _ in range(steps):
        x = z * g
        rest = x - math.log(g)
        slope = max(1.0 - x, 1e-6)
        twice = 2.0 * slope * (slope + 2.0 / 3.0 * rest)
        g += g * rest * (twice - rest) / (slope * (twice - 2.0 * rest))
    return g


def _growth_of_each(z: Lanes) -> Lanes:
    """`_growth_anywhere` in every lane."""
    return _growth_anywhere(z)


def _growth_of_lanes(z: Lanes) -> Lanes:
    return lanes_of(
        (
            _growth_anywhere(lane(z, 0)), _growth_anywhere(lane(z, 1)), _growth_anywhere(lane(z, 2)),
            _growth_anywhere(lane(z, 3)), _growth_anywhere(lane(z, 4)), _growth_anywhere(lane(z, 5)),
            _growth_anywhere(lane(z, 6)), _growth_anywhere(lane(z, 7)),
        )
    )  # fmt: skip


@overload(_growth_of_each)
def _growth_by_type(z: Lanes) -> Any:
    return _growth_of_lanes if isinstance(z, LanesType) else _growth_of_each


@inlined
def share_degraded(
    degraded_n: Lanes, recovered_n: Lanes, tau_mpj: Lanes, energy_jpm: Lanes, way_creep: Lanes
) -> tuple[Lanes, Lanes]:
    """Solve p = (1 - lambda) p_d + lambda p_r with 1 - lambda = exp(-tau (E + p e)); returns 1 - lambda, and x.

    `degraded_n`, `recovered_n`: the forces against the slip p_d, p_r >= 0; `way_creep`: slide per metre of rail, e.
    With k = tau e and p = p_r - u the equation reads x exp(-x) = k (p_r - p_d) exp(-tau E - k p_r), x = k u <= 1. x is
    also the slope of its right-hand side over p: the solution is the only one, and p follows the curves steadily.
    """
    k = tau_mpj * way_creep
    least = math.exp(-tau_mpj * energy_jpm - k * recovered_n)
    z = k * (recovered_n - degraded_n) * least
    g = _growth(z)
    return lesser(least * g, 1.0), lesser(z * g, 1.0)


@inlined
def _curve(condition: Array, at: int) -> Vector:
    """The friction curve that begins at `condition[at]`: a tuple, since a view of the array costs as much as a law."""
    return condition[at], condition[at + 1], condition[at + 2], condition[at + 3], condition[at + 4]


@inlined
def curves_of_wheels(conditions: Array, at: int) -> Vector:
    """The friction curves of eight wheels, lanes, that begin at row `at` of `conditions` (CONDITION, LANES)."""
    return (
        lanes_at(conditions, at * LANES),
        lanes_at(conditions, (at + 1) * LANES),
        lanes_at(conditions, (at + 2) * LANES),
        lanes_at(conditions, (at + 3) * LANES),
        lanes_at(conditions, (at + 4) * LANES),
    )


@compiled
def _force_on_curve(
    law: int, address: int, extra: Array, creep_x: float, creep_y: float, spin_1pm: float, slip_speed_mps: float,
    normal_force_n: float, patch: Vector, condition: Array, at: int, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """`creep_force` on the curve that begins at `condition[at]`."""
    return creep_force(
        law, address, extra, creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, patch, _curve(condition, at),
        shear_modulus_pa,
    )  # fmt: skip


@inlined
def adhesive_force(
    law: int, address: int, extra: Array, creep_x: float, creep_y: float, spin_1pm: float, slip_speed_mps: float,
    speed_mps: float, normal_force_n: float, patch: Vector, condition: Array, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Creep force on the wheel (Fx, Fy) in N on rail that may recover; tangent and secant in N per unit creep.

    `law`, `address`, `extra`: the creep law in force; `speed_mps`: the wheel's speed along the rail, to which its work
    is referred; `condition` (CONDITION,): what `rail_condition` says. Results as in `creep_force`; the tangent is that
    of the composed law at a constant ratio of slide to creep. Costs no more than the law where nothing recovers.
    """
    if law == POLACH:
        return polach_adhesion(
            creep_x, creep_y, spin_1pm, slip_speed_mps, speed_mps, normal_force_n, patch, _curve(condition, DEGRADED),
            _curve(condition, RECOVERED), condition[TAU], condition[ENERGY], shear_modulus_pa,
        )  # fmt: skip
    on_degraded = _force_on_curve(
        law, address, extra, creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, patch, condition, DEGRADED,
        shear_modulus_pa,
    )  # fmt: skip
    if condition[TAU] <= 0.0:
        return on_degraded
    on_recovered = _force_on_curve(
        law, address, extra, creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, patch, condition, RECOVERED,
        shear_modulus_pa,
    )  # fmt: skip
    return _between(
        on_degraded, on_recovered, creep_x, creep_y, slip_speed_mps, speed_mps, condition[TAU], condition[ENERGY]
    )


@inlined
def polach_adhesion(
    creep_x: Lanes, creep_y: Lanes, spin_1pm: Lanes, slip_speed_mps: Lanes, speed_mps: Lanes, normal_force_n: Lanes,
    patch: Vector, degraded: Vector, recovered: Vector, tau_mpj: Lanes, energy_jpm: Lanes, shear_modulus_pa: float,
) -> tuple[Lanes, Lanes, Lanes, Lanes]:  # fmt: skip
    """`adhesive_force` under Polach's law, the law of most runs, for one wheel or for all at once.

    `degraded`, `recovered`: the friction curves, as in `polach_force`; what they share is worked out once.
    """
    slip = polach_slip(creep_x, creep_y, spin_1pm, patch, shear_modulus_pa)
    on_degraded = polach_on_curve(creep_x, creep_y, slip_speed_mps, normal_force_n, slip, degraded)
    if every(tau_mpj <= 0.0):
        return on_degraded
    on_recovered = polach_on_curve(creep_x, creep_y, slip_speed_mps, normal_force_n, slip, recovered)
    return _between(on_degraded, on_recovered, creep_x, creep_y, slip_speed_mps, speed_mps, tau_mpj, energy_jpm)


@inlined
def _between(
    on_degraded: Vector, on_recovered: Vector, creep_x: Lanes, creep_y: Lanes, slip_speed_mps: Lanes, speed_mps: Lanes,
    tau_mpj: Lanes, energy_jpm: Lanes,
) -> tuple[Lanes, Lanes, Lanes, Lanes]:  # fmt: skip
    """Force, tangent and secant on rail that recovers, from those on its two curves."""
    fx, fy, tangent, secant = on_degraded
    rx, ry, r_tangent, r_secant = on_recovered
    creep = math.sqrt(creep_x * creep_x + creep_y * creep_y)
    per_creep = where(creep < 1e-14, 0.0, 1.0 / creep)
    # what works is the force against the slip; with spin it may push along
    degraded = greater(-(fx * creep_x + fy * creep_y) * per_creep, 0.0)
    recovered = greater(-(rx * creep_x + ry * creep_y) * per_creep, 0.0)
    way_creep = slip_speed_mps / greater(abs(speed_mps), LOWEST_SPEED_MPS)
    kept, x = share_degraded(degraded, recovered, tau_mpj, energy_jpm, way_creep)
    gained = 1.0 - kept
    force = (degraded + gained * (recovered - degraded)) * per_creep
    # dp/ds (1 - x) = (1 - lambda) p_d' + lambda p_r' + x p/s
    tangent = (kept * tangent + gained * r_tangent + x * force) / greater(1.0 - x, 1e-3)
    return kept * fx + gained * rx, kept * fy + gained * ry, tangent, kept * secant + gained * r_secant
