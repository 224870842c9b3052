"""Equivalent conicity: closed forms. Published figures are cases of the verification."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wheel_rail.equivalent_conicity import equivalent_conicity, kinematic_wavelength_m

GRID = np.arange(-240, 241) * 5e-5


@given(conicity=st.floats(0.005, 0.5), amplitude_m=st.floats(5e-4, 8e-3), centre_m=st.floats(-2e-3, 2e-3))
@settings(max_examples=30, deadline=None)
def test_a_cone_has_its_own_conicity_and_klingels_wave(conicity: float, amplitude_m: float, centre_m: float) -> None:
    difference = 2.0 * conicity * (GRID - centre_m)
    found = equivalent_conicity(GRID, difference, np.array([amplitude_m]), 0.46)
    assert found == pytest.approx(conicity, rel=1e-6)
    wave = kinematic_wavelength_m(GRID, difference, np.array([amplitude_m]), 0.46, 1.5)
    assert wave == pytest.approx(2.0 * np.pi * np.sqrt(0.46 * 0.75 / conicity), rel=1e-6)


def test_a_cubic_difference_has_duffings_period() -> None:
    """y'' + c y^3 = 0 swings with the period 7.4163/(sqrt(c) a)."""
    stiffness, amplitude = 2e4, 0.005
    wave = kinematic_wavelength_m(GRID, stiffness * GRID**3 * 1.5 * 0.46, np.array([amplitude]), 0.46)
    assert wave == pytest.approx(7.416298709 / (np.sqrt(stiffness) * amplitude), rel=2e-4)


def test_no_wave_where_nothing_steers_back_and_no_amplitude_beyond_the_table() -> None:
    assert np.isnan(equivalent_conicity(GRID, -0.1 * GRID, np.array([0.003]), 0.46))
    for bad in (0.0, 0.012, float("nan")):
        with pytest.raises(ValueError, match="amplitude_m"):
            equivalent_conicity(GRID, 0.1 * GRID, np.array([bad]), 0.46)
