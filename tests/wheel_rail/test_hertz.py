"""Hertz contact: the closed form for spheres, scaling, bad input. Published figures are cases of the verification."""

import numpy as np
import pytest

from wheel_rail.hertz import elliptic_contact

LOAD_N, SHEAR_PA, POISSON = 106_700.0, 82e9, 0.28


def test_spheres_have_the_closed_form() -> None:
    curvature = 2.0  # 1/R1 + 1/R2
    e_star = SHEAR_PA / (1.0 - POISSON)
    a = (3.0 * LOAD_N / (4.0 * e_star * curvature)) ** (1.0 / 3.0)
    ellipse = elliptic_contact(LOAD_N, curvature, curvature, SHEAR_PA, POISSON)
    assert (ellipse.a_m, ellipse.b_m) == pytest.approx((a, a), rel=1e-9)
    assert ellipse.approach_m == pytest.approx(a**2 * curvature, rel=1e-9)


def test_axes_follow_their_curvatures_and_load_scales_by_the_cube_root() -> None:
    one = elliptic_contact(LOAD_N, 1.0, 3.0, SHEAR_PA, POISSON)
    turned = elliptic_contact(LOAD_N, 3.0, 1.0, SHEAR_PA, POISSON)
    heavy = elliptic_contact(8.0 * LOAD_N, 1.0, 3.0, SHEAR_PA, POISSON)
    assert one.a_m > one.b_m
    assert (turned.a_m, turned.b_m) == pytest.approx((one.b_m, one.a_m))
    assert heavy.a_m == pytest.approx(2.0 * one.a_m, rel=1e-9)
    assert np.pi * one.a_m * one.b_m * one.peak_pressure_pa * 2.0 / 3.0 == pytest.approx(LOAD_N)


@pytest.mark.parametrize("bad", [0.0, -1.0, float("nan")])
def test_bad_input_is_named(bad: float) -> None:
    with pytest.raises(ValueError, match="curvature_y_1pm"):
        elliptic_contact(LOAD_N, 1.0, bad, SHEAR_PA, POISSON)
