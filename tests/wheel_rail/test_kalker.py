"""Kalker's coefficients against the published table and CONTACT's interpolation."""

import pytest

from wheel_rail.kalker import creep_coefficients

PUBLISHED = [  # a/b, nu, C11, C22, C23
    (0.1, 0.0, 2.51, 2.51, 0.334),
    (0.3, 0.25, 3.44, 2.75, 0.715),
    (0.5, 0.5, 4.83, 3.14, 1.07),
    (1.0, 0.25, 4.12, 3.67, 1.47),
    (1 / 0.9, 0.0, 3.51, 3.51, 1.44),
    (1 / 0.5, 0.25, 5.10, 4.90, 2.62),
    (1 / 0.1, 0.5, 12.9, 16.0, 18.0),
]


@pytest.mark.parametrize(("a_over_b", "poisson", "c11", "c22", "c23"), PUBLISHED)
def test_table_is_met_at_its_points(a_over_b: float, poisson: float, c11: float, c22: float, c23: float) -> None:
    assert creep_coefficients(a_over_b, poisson) == pytest.approx((c11, c22, c23), rel=1e-12)


def test_interpolation_in_poisson_gives_the_figure_of_contact() -> None:
    assert creep_coefficients(0.5, 0.28)[0] == pytest.approx(3.7335, abs=5e-5)


@pytest.mark.parametrize(("a_over_b", "poisson"), [(0.05, 0.25), (11.0, 0.25), (1.0, 0.6), (1.0, -0.1)])
def test_outside_the_table_is_refused(a_over_b: float, poisson: float) -> None:
    with pytest.raises(ValueError, match="table covers"):
        creep_coefficients(a_over_b, poisson)
