"""Largest adhesion that a creep law offers at a place, for any law; `wheel_rail.polach` has the same for Polach's."""

import math

import numpy as np

from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.creep_laws import LawInForce, creep_force
from wheel_rail.polach import Surface

_GOLDEN = 0.6180339887498949


@compiled
def adhesion_of_law(
    law: int, address: int, extra: Array, creep: float, speed_mps: float, normal_force_n: float, patch: Vector,
    rail: Array, shear_modulus_pa: float,
) -> float:  # fmt: skip
    """Utilised adhesion |F|/N at a purely longitudinal creep."""
    fx, _, _, _ = creep_force(
        law, address, extra, creep, 0.0, 0.0, creep * speed_mps, normal_force_n, patch, rail, shear_modulus_pa
    )
    return abs(fx) / normal_force_n


@compiled
def peak_of_law(
    law: int, address: int, extra: Array, speed_mps: float, normal_force_n: float, patch: Vector, rail: Array,
    shear_modulus_pa: float,
) -> tuple[float, float]:  # fmt: skip
    """Largest adhesion over longitudinal creep up to 0.3 and the creep where it lies (a point of the flat, if any).

    Golden-section search over the logarithm of creep: the curve must not have two maxima.
    """
    low, high = math.log(1e-4), math.log(0.3)
    x1 = high - _GOLDEN * (high - low)
    x2 = low + _GOLDEN * (high - low)
    f1 = adhesion_of_law(law, address, extra, math.exp(x1), speed_mps, normal_force_n, patch, rail, shear_modulus_pa)
    f2 = adhesion_of_law(law, address, extra, math.exp(x2), speed_mps, normal_force_n, patch, rail, shear_modulus_pa)
    for _ in range(24):
        if f1 < f2:
            low, x1, f1 = x1, x2, f2
            x2 = low + _GOLDEN * (high - low)
            f2 = adhesion_of_law(
                law, address, extra, math.exp(x2), speed_mps, normal_force_n, patch, rail, shear_modulus_pa
            )
        else:
            high, x2, f2 = x2, x1, f1
            x1 = high - _GOLDEN * (high - low)
            f1 = adhesion_of_law(
                law, address, extra, math.exp(x1), speed_mps, normal_force_n, patch, rail, shear_modulus_pa
            )
    if f1 > f2:
        return f1, math.exp(x1)
    return f2, math.exp(x2)


def mu0_for_peak_of_law(
    law: LawInForce,
    peak: np.ndarray,
    surface: Surface,
    speed_mps: float,
    normal_force_n: float,
    patch: np.ndarray,
    shear_modulus_pa: float,
) -> np.ndarray:
    """mu0 with which `law` reaches these peak adhesions (any shape, 0 < peak <= 1) at `speed_mps` and `normal_force_n`.

    Raises ValueError where no mu0 from 0.002 to 3 reaches the peak.
    """
    peak = np.asarray(peak, dtype=float)
    # peak over mu0 is smooth and monotone: tabulated once and inverted by interpolation
    grid = np.geomspace(0.002, 3.0, 200)
    reached = np.empty(grid.size)
    for i, mu0 in enumerate(grid):
        rail = np.array([mu0, surface.falling_a, surface.falling_b_spm, surface.k_adhesion, surface.k_slip])
        reached[i] = peak_of_law(
            law.number, law.address, law.extra, speed_mps, normal_force_n, patch, rail, shear_modulus_pa
        )[0]
    if np.any(peak < reached[0]) or np.any(peak > reached[-1]):
        raise ValueError(
            f"peak adhesion {float(np.min(peak)):.4g} to {float(np.max(peak)):.4g}: this surface reaches "
            f"{reached[0]:.4g} to {reached[-1]:.4g} with this creep law"
        )
    return np.exp(np.interp(np.log(peak), np.log(reached), np.log(grid)))
