"""Hertz' elliptic contact of two bodies of one material.

Source: K. L. Johnson, Contact Mechanics, 1985, section 4.2: the exact solution with complete elliptic integrals.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk


@dataclass(frozen=True)
class EllipticContact:
    """Hertz contact with semi-axes `a_m` (along x), `b_m` (along y), approach and peak pressure."""

    a_m: float
    b_m: float
    approach_m: float
    peak_pressure_pa: float


def _curvature_ratio(minor_over_major: float) -> float:
    """Larger over smaller relative curvature that yields this ratio of the semi-axes (Johnson, eq. 4.28)."""
    e2 = 1.0 - minor_over_major**2
    k, e = ellipk(e2), ellipe(e2)
    return float((e / minor_over_major**2 - k) / (k - e))


def elliptic_contact(
    normal_force_n: float, curvature_x_1pm: float, curvature_y_1pm: float, shear_modulus_pa: float, poisson: float
) -> EllipticContact:
    """Contact ellipse under `normal_force_n`.

    `curvature_x_1pm`, `curvature_y_1pm`: sums 1/R_wheel + 1/R_rail in the rolling and the lateral direction, 1/m.
    Raises ValueError unless force, curvatures and modulus are positive.
    """
    for name, value in (
        ("normal_force_n", normal_force_n),
        ("curvature_x_1pm", curvature_x_1pm),
        ("curvature_y_1pm", curvature_y_1pm),
        ("shear_modulus_pa", shear_modulus_pa),
    ):
        if not value > 0.0:
            raise ValueError(f"{name} = {value}: must be positive")
    # both bodies of one material: 1/E* = 2 (1 - nu^2)/E with E = 2 G (1 + nu)
    e_star = shear_modulus_pa / (1.0 - poisson)
    small, large = sorted((curvature_x_1pm, curvature_y_1pm))
    target = large / small
    if target < 1.0 + 1e-9:
        ratio = 1.0
        k = ellipk(0.0)
        e_term = np.pi / 4  # limit of (E/(b/a)^2 - K)/e^2 for a circle
    else:
        ratio = brentq(lambda g: _curvature_ratio(g) - target, 1e-4, 1.0 - 1e-9, xtol=1e-15)
        e2 = 1.0 - ratio**2
        k = ellipk(e2)
        e_term = (ellipe(e2) / ratio**2 - k) / e2
    # the larger relative curvature belongs to the minor axis: large/2 = p0 b/(e^2 a^2 E*) ((a/b)^2 E - K)
    major = (3.0 * normal_force_n * e_term / (np.pi * e_star * large)) ** (1.0 / 3.0)
    minor = ratio * major
    peak = 1.5 * normal_force_n / (np.pi * major * minor)
    approach = peak * minor * k / e_star
    a, b = (major, minor) if curvature_x_1pm <= curvature_y_1pm else (minor, major)
    return EllipticContact(a_m=float(a), b_m=float(b), approach_m=float(approach), peak_pressure_pa=float(peak))
