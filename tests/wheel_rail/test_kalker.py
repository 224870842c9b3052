"""Kalker's coefficients between and outside the points of the table, whose figures are cases of the verification."""

import numpy as np
import pytest

from wheel_rail.kalker import creep_coefficients


def test_between_the_points_coefficients_are_continuous_and_grow_with_poissons_number() -> None:
    ratios = np.geomspace(0.1, 10.0, 400)
    before = np.zeros((ratios.size, 3))
    for poisson in np.linspace(0.0, 0.5, 11):
        found = np.array([creep_coefficients(ratio, poisson) for ratio in ratios])
        assert np.max(np.abs(np.diff(np.log(found), axis=0))) < 0.025  # steps of the ratio are 0.0115
        assert np.all(found > before)
        before = found


@pytest.mark.parametrize(("a_over_b", "poisson"), [(0.05, 0.25), (11.0, 0.25), (1.0, 0.6), (1.0, -0.1)])
def test_outside_the_table_is_refused(a_over_b: float, poisson: float) -> None:
    with pytest.raises(ValueError, match="table covers"):
        creep_coefficients(a_over_b, poisson)
