"""Polach's creep law with falling friction.

mu(w) = mu0 [(1 - A) exp(-B w) + A], w the slip speed in m/s;
eps = (1/4) G pi a b c s / (Q mu); F = (2 Q mu/pi) [kA eps/(1 + (kA eps)^2) + atan(kS eps)].
Sources: O. Polach, Wear 258 (2005) 992-1000 (large creep, falling friction); O. Polach, A fast wheel-rail forces
calculation computer code, Vehicle System Dynamics Supplement 33 (1999) 728-739 (lateral force due to spin).
"""

import math
from dataclasses import dataclass

import numpy as np

from wheel_rail.compiled import Array, Vector, compiled


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
    mu = rail[0] * ((1.0 - rail[1]) * math.exp(-rail[2] * slip_speed_mps) + rail[1])
    limit = mu * normal_force_n
    # lateral creepage that counts: spin adds where it increases it (Polach 1999, eq. 4)
    creep_yc = creep_y + spin_1pm * a
    if abs(creep_yc) <= abs(creep_y):
        creep_yc = creep_y
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
    # friction falls as the slip speed rises with the creep: what does not follow from the creep follows the limit
    fall = -rail[2] * (mu - rail[0] * rail[1]) / mu
    tangent += (force - tangent * total) * fall * slip_speed_mps / total
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


@compiled
def adhesion_at(
    creep: float, speed_mps: float, normal_force_n: float, patch: Vector, rail: Array, shear_modulus_pa: float
) -> float:
    """Utilised adhesion |F|/N at a purely longitudinal creep."""
    fx, _, _, _ = polach_force(creep, 0.0, 0.0, creep * speed_mps, normal_force_n, patch, rail, shear_modulus_pa)
    return abs(fx) / normal_force_n


@compiled
def peak_adhesion(
    speed_mps: float, normal_force_n: float, patch: Vector, rail: Array, shear_modulus_pa: float
) -> tuple[float, float]:
    """Largest adhesion over longitudinal creep up to 0.3 and the creep where it lies.

    The curve has a single maximum in creep: golden-section search over the logarithm of creep.
    """
    golden = 0.6180339887498949
    low, high = math.log(1e-4), math.log(0.3)
    x1 = high - golden * (high - low)
    x2 = low + golden * (high - low)
    f1 = adhesion_at(math.exp(x1), speed_mps, normal_force_n, patch, rail, shear_modulus_pa)
    f2 = adhesion_at(math.exp(x2), speed_mps, normal_force_n, patch, rail, shear_modulus_pa)
    for _ in range(24):
        if f1 < f2:
            low, x1, f1 = x1, x2, f2
            x2 = low + golden * (high - low)
            f2 = adhesion_at(math.exp(x2), speed_mps, normal_force_n, patch, rail, shear_modulus_pa)
        else:
            high, x2, f2 = x2, x1, f1
            x1 = high - golden * (high - low)
            f1 = adhesion_at(math.exp(x1), speed_mps, normal_force_n, patch, rail, shear_modulus_pa)
    if f1 > f2:
        return f1, math.exp(x1)
    return f2, math.exp(x2)


def mu0_for_peak(
    peak: np.ndarray,
    surface: Surface,
    speed_mps: float,
    normal_force_n: float,
    patch: np.ndarray,
    shear_modulus_pa: float,
) -> np.ndarray:
    """The law's mu0 that gives these peak adhesions (any shape, 0 < peak <= 1) at `speed_mps` and `normal_force_n`.

    Raises ValueError where no mu0 reaches the peak.
    """
    peak = np.asarray(peak, dtype=float)
    # peak over mu0 is smooth and monotone: tabulated once and inverted by interpolation
    grid = np.geomspace(0.002, 3.0, 200)
    reached = np.array(
        [
            peak_adhesion(
                speed_mps,
                normal_force_n,
                patch,
                np.array([m, surface.falling_a, surface.falling_b_spm, surface.k_adhesion, surface.k_slip]),
                shear_modulus_pa,
            )[0]
            for m in grid
        ]
    )
    if np.any(peak < reached[0]) or np.any(peak > reached[-1]):
        raise ValueError(
            f"peak adhesion {float(np.min(peak)):.4g} to {float(np.max(peak)):.4g}: this surface reaches "
            f"{reached[0]:.4g} to {reached[-1]:.4g}"
        )
    return np.exp(np.interp(np.log(peak), np.log(reached), np.log(grid)))
