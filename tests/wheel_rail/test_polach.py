"""Polach's law: the invariants of a creep law. Published peaks and curves are cases of the verification."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.wheel_rail.conftest import LOAD_N, SHEAR_PA, law
from wheel_rail.kalker import creep_coefficients
from wheel_rail.polach import SURFACES, mu0_for_peak, peak_adhesion, polach_force


def test_the_peak_is_the_largest_of_a_scan(patch: np.ndarray) -> None:
    creeps = np.geomspace(1e-4, 0.3, 2000)
    for surface in SURFACES:
        scan = [abs(polach_force(c, 0.0, 0.0, 30.0 * c, LOAD_N, patch, law(surface), SHEAR_PA)[0]) for c in creeps]
        found, _ = peak_adhesion(30.0, LOAD_N, patch, law(surface), SHEAR_PA)
        assert found == pytest.approx(max(scan) / LOAD_N, rel=1e-5)


def test_small_creep_gives_kalkers_linear_forces(patch: np.ndarray) -> None:
    a, b = patch[:2]
    c11, c22, c23 = creep_coefficients(0.5, 0.28)
    constant = np.array([0.33, 1.0, 0.0, 1.0, 1.0])
    fx, _, tangent, secant = polach_force(1e-7, 0.0, 0.0, 0.0, LOAD_N, patch, constant, SHEAR_PA)
    assert -fx / 1e-7 == pytest.approx(SHEAR_PA * a * b * c11, rel=1e-3)
    assert tangent == pytest.approx(SHEAR_PA * a * b * c11, rel=1e-3)
    assert secant == pytest.approx(tangent, rel=1e-3)
    _, fy, _, _ = polach_force(0.0, 1e-7, 0.0, 0.0, LOAD_N, patch, constant, SHEAR_PA)
    assert -fy / 1e-7 == pytest.approx(SHEAR_PA * a * b * c22, rel=1e-3)
    # spin alone, where Polach's approximation follows Kalker within a few per cent
    _, fy, _, _ = polach_force(0.0, 0.0, 0.01, 0.0, LOAD_N, patch, constant, SHEAR_PA)
    assert -fy / 0.01 == pytest.approx(SHEAR_PA * (a * b) ** 1.5 * c23, rel=0.05)


creeps = st.floats(-1.0, 1.0)
spins = st.floats(-1.0, 1.0)


@settings(max_examples=300, deadline=None)
@given(creeps, creeps, spins, st.floats(0.0, 60.0), st.floats(100.0, 3e5), st.sampled_from(sorted(SURFACES)))
def test_invariants(x: float, y: float, spin: float, speed: float, load: float, surface: str) -> None:
    patch = np.array([6e-3, 7e-3, 4.1, 3.6, 1.4, 1.0 + 6.3 * (1.0 - np.exp(-6 / 7))])
    rail = law(surface)
    slip = math.hypot(x, y) * speed
    fx, fy, _, secant = polach_force(x, y, spin, slip, load, patch, rail, SHEAR_PA)
    friction = rail[0] * ((1.0 - rail[1]) * math.exp(-rail[2] * slip) + rail[1])
    assert math.hypot(fx, fy) <= friction * load * (1.0 + 1e-12)
    assert secant >= 0.0
    mirrored = polach_force(-x, -y, -spin, slip, load, patch, rail, SHEAR_PA)
    assert mirrored[:2] == pytest.approx((-fx, -fy), abs=1e-9)
    if spin == 0.0:
        assert fx * x + fy * y <= 0.0


def test_continuous_through_zero_creep(patch: np.ndarray) -> None:
    values = [
        polach_force(x, 0.0, 0.0, 0.0, LOAD_N, patch, law("dry"), SHEAR_PA)[0] for x in np.linspace(-1e-9, 1e-9, 41)
    ]
    assert np.all(np.diff(values) <= 0.0)
    assert np.max(np.abs(np.diff(values))) < 0.01


@settings(max_examples=30, deadline=None)
@given(st.floats(0.03, 0.5), st.sampled_from(sorted(SURFACES)))
def test_mu0_reproduces_the_peak_asked_for(peak: float, surface: str) -> None:
    patch = np.array([6e-3, 7e-3, 4.1, 3.6, 1.4, 4.6])
    mu0 = mu0_for_peak(np.array([peak]), SURFACES[surface], 27.8, 68.7e3, patch, SHEAR_PA)[0]
    rail = law(surface)
    rail[0] = mu0
    assert peak_adhesion(27.8, 68.7e3, patch, rail, SHEAR_PA)[0] == pytest.approx(peak, rel=2e-3)


def test_an_unreachable_peak_is_refused(patch: np.ndarray) -> None:
    with pytest.raises(ValueError, match="this surface reaches"):
        mu0_for_peak(np.array([1e-4]), SURFACES["dry"], 27.8, 68.7e3, patch, SHEAR_PA)
