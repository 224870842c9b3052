"""Polach's creep law with falling friction.

mu(w) = mu0 [(1 - A) exp(-B w) + A], w the slip speed in m/s;
eps = (1/4) G pi a b c s / (Q mu); F = (2 Q mu/pi) [kA eps/(1 + (kA eps)^2) + atan(kS eps)].
Sources: O. Polach, Wear 258 (2005) 992-1000 (large creep, falling friction); O. Polach, A fast wheel-rail forces
calculation computer code, Vehicle System Dynamics Supplement 33 (1999) 728-739 (lateral force due to spin).
"""

import math
from dataclasses import dataclass

from wheel_rail.compiled import Array, Vector, compiled, inlined
from wheel_rail.lanes import Lanes, where
from wheel_rail.slip import counted_lateral_creep, friction, tangent_with_fall


@dataclass(frozen=True)
class Surface:
    """Parameters of the friction curve of one rail condition; `mu0` is the law's friction at zero slip speed."""

    mu0: float
    falling_a: float
    falling_b_spm: float
    k_adhesion: float
    k_slip: float


# Polach 2005; `low` and `very-low` at second hand from later papers that use his law
SURFACES: dict[str, Surface] = {
    "dry": Surface(0.55, 0.40, 0.60, 1.00, 0.40),
    "wet": Surface(0.30, 0.40, 0.20, 0.30, 0.10),
    "low": Surface(0.06, 0.40, 0.20, 1.00, 0.40),
    "very-low": Surface(0.03, 0.40, 0.10, 1.00, 0.40),
}


@compiled
def polach_force(
    creep_x: float, creep_y: float, spin_1pm: float, slip_speed_mps: float, normal_force_n: float, patch: Vector,
    rail: Array, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Creep force on the wheel (Fx, Fy) in N; tangent dF/ds along the slip and secant F/s in N per unit creep.

    `patch`: (a_m, b_m, C11, C22, C23, 1 + 6.3 (1 - exp(-a/b))); `rail`: (mu0, A, B, kA, kS). The force opposes the
    creepages and stays within mu N.
    """
    slip = polach_slip(creep_x, creep_y, spin_1pm, patch, shear_modulus_pa)
    return polach_on_curve(creep_x, creep_y, slip_speed_mps, normal_force_n, slip, rail)


@inlined
def polach_slip(
    creep_x: Lanes, creep_y: Lanes, spin_1pm: Lanes, patch: Vector, shear_modulus_pa: float
) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    """What does not depend on friction, once for all friction curves of a rail.

    Total creepage; stiffness k = (1/4) G pi a b c, so that eps = k s/(mu N) (N per unit creep); the same for the
    lateral force of spin (N), and that force's factor of mu N (Polach 1999).
    """
    a, b, c11, c22, c23 = patch[0], patch[1], patch[2], patch[3], patch[4]
    counted = counted_lateral_creep(creep_y, spin_1pm, a)
    total = math.sqrt(creep_x * creep_x + counted * counted)
    rests = total < 1e-14
    per_total = where(rests, 0.0, 1.0 / total)
    scale = 0.25 * shear_modulus_pa * math.pi * a * b
    cx, cy = c11 * creep_x, c22 * counted
    stiffness = scale * where(rests, c11, math.sqrt(cx * cx + cy * cy) * per_total)
    aspect = patch[5]
    spin_stiffness = 8.0 / 3.0 * shear_modulus_pa * b * math.sqrt(a * b) * c23 * abs(counted) / aspect
    return where(rests, 0.0, total), stiffness, spin_stiffness, 9.0 / 16.0 * a * aspect * spin_1pm * per_total


@inlined
def polach_on_curve(
    creep_x: Lanes, creep_y: Lanes, slip_speed_mps: Lanes, normal_force_n: Lanes,
    slip: tuple[Lanes, Lanes, Lanes, Lanes], rail: Vector,
) -> tuple[Lanes, Lanes, Lanes, Lanes]:  # fmt: skip
    """`polach_force` on one friction curve, from what `polach_slip` has found."""
    total, stiffness, spin_stiffness, spin_factor = slip
    k_adhesion, k_slip = rail[3], rail[4]
    mu = friction(rail, slip_speed_mps)
    limit = mu * normal_force_n
    rests = (total <= 0.0) | (limit <= 0.0)
    per_limit = 1.0 / limit
    eps = stiffness * total * per_limit
    eps_a, eps_s = k_adhesion * eps, k_slip * eps
    share = 1.0 / (1.0 + eps_a * eps_a)
    force = limit * (2.0 / math.pi) * (eps_a * share + math.atan(eps_s))
    initial = 2.0 / math.pi * stiffness
    tangent = initial * (k_adhesion * (1.0 - eps_a * eps_a) * share * share + k_slip / (1.0 + eps_s * eps_s))
    tangent = tangent_with_fall(tangent, force, total, slip_speed_mps, mu, rail)
    secant = force / total
    # Polach's lateral force of spin; delta of the source; sqrt(1 - delta^2) = 2 eps/(eps^2 + 1)
    eps_spin = spin_stiffness * per_limit
    square = eps_spin * eps_spin
    share = 1.0 / (square + 1.0)
    delta = (square - 1.0) * share
    root = 2.0 * eps_spin * share
    k_moment = eps_spin * (delta * delta * (delta / 3.0 - 0.5) + 1.0 / 6.0) - root * root * root / 3.0
    # k_moment is negative: the force of spin acts against the lateral creepage that spin makes
    fx, fy = -secant * creep_x, spin_factor * limit * k_moment - secant * creep_y
    size = math.sqrt(fx * fx + fy * fy)
    shrink = where(size > limit, limit / size, 1.0)
    slope = initial * (k_adhesion + k_slip)
    return (
        where(rests, 0.0, fx * shrink),
        where(rests, 0.0, fy * shrink),
        where(rests, slope, tangent),
        where(rests, slope, secant),
    )
