"""Polach's creep law with falling friction.

mu(w) = mu0 [(1 - A) exp(-B w) + A], w the slip speed in m/s;
eps = (1/4) G pi a b c s / (Q mu); F = (2 Q mu/pi) [kA eps/(1 + (kA eps)^2) + atan(kS eps)].
Sources: O. Polach, Wear 258 (2005) 992-1000 (large creep, falling friction); O. Polach, A fast wheel-rail forces
calculation computer code, Vehicle System Dynamics Supplement 33 (1999) 728-739 (lateral force due to spin).
"""

import math
from dataclasses import dataclass

from wheel_rail.compiled import Array, Vector, compiled
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
    a, b, c11, c22, c23 = patch[0], patch[1], patch[2], patch[3], patch[4]
    mu = friction(rail, slip_speed_mps)
    limit = mu * normal_force_n
    creep_yc = counted_lateral_creep(creep_y, spin_1pm, a)
    total = math.sqrt(creep_x * creep_x + creep_yc * creep_yc)
    if total < 1e-14 or limit <= 0.0:
        slope = 0.25 * shear_modulus_pa * math.pi * a * b * c11 * (rail[3] + rail[4]) * 2.0 / math.pi
        return 0.0, 0.0, slope, slope
    c = math.sqrt((c11 * creep_x) ** 2 + (c22 * creep_yc) ** 2) / total
    stiffness = 0.25 * shear_modulus_pa * math.pi * a * b * c
    eps = stiffness * total / limit
    eps_a = rail[3] * eps
    eps_s = rail[4] * eps
    denominator = 1.0 + eps_a * eps_a
    force = limit * 2.0 / math.pi * (eps_a / denominator + math.atan(eps_s))
    tangent = (
        2.0
        / math.pi
        * stiffness
        * (rail[3] * (1.0 - eps_a * eps_a) / (denominator * denominator) + rail[4] / (1.0 + eps_s * eps_s))
    )
    tangent = tangent_with_fall(tangent, force, total, slip_speed_mps, mu, rail)
    fx = -force * creep_x / total
    fy = -force * creep_y / total
    if spin_1pm != 0.0:
        aspect = patch[5]
        eps_spin = 8.0 / 3.0 * shear_modulus_pa * b * math.sqrt(a * b) * c23 * abs(creep_yc) / (aspect * limit)
        delta = (eps_spin * eps_spin - 1.0) / (eps_spin * eps_spin + 1.0)
        # sqrt(1 - delta^2) = 2 eps/(eps^2 + 1)
        k_moment = (
            eps_spin * (delta * delta * delta / 3.0 - 0.5 * delta * delta + 1.0 / 6.0)
            - (2.0 * eps_spin / (eps_spin * eps_spin + 1.0)) ** 3 / 3.0
        )
        # k_moment is negative: the force of spin acts against the lateral creepage that spin makes
        fy += 9.0 / 16.0 * a * limit * k_moment * aspect * spin_1pm / total
        size2 = fx * fx + fy * fy
        if size2 > limit * limit:
            shrink = limit / math.sqrt(size2)
            fx *= shrink
            fy *= shrink
    return fx, fy, tangent, force / total
