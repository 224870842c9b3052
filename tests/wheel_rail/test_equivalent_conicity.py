"""Equivalent conicity: closed forms, EN 15302's case E1 and published figures of S1002 on UIC60."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wheel_rail.contact_geometry import ContactGeometry, ContactGeometryParameters, ContactTable
from wheel_rail.equivalent_conicity import equivalent_conicity, kinematic_wavelength_m

GRID = np.arange(-240, 241) * 5e-5


def table(profiles: tuple[str, str], inclination: float, gauge_m: float, level: bool) -> ContactTable:
    parameters = ContactGeometryParameters(
        wheel_profiles=(profiles[0],) * 2,
        rail_profiles=(profiles[1],) * 2,
        rail_inclination=inclination,
        gauge_m=gauge_m,
        back_to_back_m=1.36,
    )
    return ContactGeometry(parameters, (0.46, 0.46)).table(GRID, level=level)


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


def test_en_15302_case_e1() -> None:
    """Wheel A on rail A, gauge 1435.16 mm: the standard keeps the wheelset level."""
    published = np.array([0.125, 0.155, 0.188, 0.216, 0.254, 0.303])
    e1 = table(("en15302-a", "en15302-a"), 0.0, 1.43516, level=True)
    found = equivalent_conicity(GRID, e1.rolling_radius_difference_m[0], np.arange(1, 7) * 1e-3, 0.46)
    for y, f, p in zip(range(1, 7), found, published, strict=True):
        print(f"E1 at {y} mm: {f:.4f}, published {p}, error {f - p:+.4f} (0.005)")
    assert found == pytest.approx(published, abs=0.005)


@pytest.mark.parametrize(
    ("inclination", "gauge_m", "published"),
    [(1 / 40, 1.435, 0.180), (1 / 30, 1.435, 0.122), (1 / 20, 1.435, 0.0093), (1 / 40, 1.438, 0.127)],
)
def test_s1002_on_uic60_at_3_mm(inclination: float, gauge_m: float, published: float) -> None:
    """These figures belong to a wheelset that rolls as it shifts."""
    pair = table(("s1002", "uic60"), inclination, gauge_m, level=False)
    found = equivalent_conicity(GRID, pair.rolling_radius_difference_m[0], np.array([0.003]), 0.46)[0]
    print(f"S1002 on UIC60 1:{1 / inclination:.0f}, {gauge_m} m: {found:.4f}, published {published} (0.005)")
    assert found == pytest.approx(published, abs=0.005)


def test_s1002_in_narrow_gauge_lies_between_level_and_rolling() -> None:
    """Gauge 1430 mm: 0.463 published, 0.417 level, 0.488 rolling.

    Within the wave the contact leaps into the flange root, at 2.6 mm on the rolling wheelset and 0.4 mm later on the
    level one, and the conicity changes by 0.02 for each 0.1 mm of amplitude or gauge.
    """
    found = []
    for level in (True, False):
        pair = table(("s1002", "uic60"), 1 / 40, 1.43, level)
        found.append(equivalent_conicity(GRID, pair.rolling_radius_difference_m[0], np.array([0.003]), 0.46)[0])
    print(f"S1002 on UIC60 1:40, 1.43 m: {found[0]:.4f} level, {found[1]:.4f} rolling, published 0.463")
    assert found[0] < 0.463 < found[1]
    assert found[1] == pytest.approx(0.463, rel=0.06)
