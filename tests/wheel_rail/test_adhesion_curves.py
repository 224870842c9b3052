"""Peak adhesion of a friction curve and the way back to its mu0, for every creep law."""

import math
from dataclasses import astuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.wheel_rail.rail_kinds import LAW, PATCH, SHEAR_PA
from wheel_rail.adhesion_curves import REFERENCE_LOAD_N, REFERENCE_SPEED_MPS, PeakSearch
from wheel_rail.creep_laws import CREEP_LAWS, creep_force
from wheel_rail.polach import SURFACES, Surface

POLACH = PeakSearch(LAW, PATCH, SHEAR_PA)


def largest_of_a_scan(search: PeakSearch, mu0: float, surface: Surface, speed_mps: float) -> float:
    law, rail = search.law, np.array([mu0, *astuple(surface)[1:]])
    forces = [
        creep_force(
            law.number, law.address, law.extra, c, 0.0, 0.0, speed_mps * c, REFERENCE_LOAD_N, search.patch, rail,
            search.shear_modulus_pa,
        )
        for c in np.geomspace(1e-4, 0.3, 3000)
    ]  # fmt: skip
    return max(math.hypot(fx, fy) for fx, fy, _, _ in forces) / REFERENCE_LOAD_N


@pytest.mark.parametrize("name", sorted(CREEP_LAWS))
def test_the_peak_of_any_law_is_the_largest_of_a_scan_and_leads_back_to_mu0(name: str) -> None:
    search = PeakSearch(CREEP_LAWS[name].in_force(), PATCH, SHEAR_PA)
    for surface in SURFACES.values():
        peak = search.peak(surface.mu0, surface, 30.0)
        assert peak == pytest.approx(largest_of_a_scan(search, surface.mu0, surface, 30.0), rel=1e-5)
        assert search.peak(search.mu0(peak, surface, 30.0), surface, 30.0) == pytest.approx(peak, rel=1e-6)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.03, 0.5), st.sampled_from(sorted(SURFACES)))
def test_mu0_reproduces_the_peak_asked_for(peak: float, name: str) -> None:
    surface = SURFACES[name]
    assert POLACH.peak(POLACH.mu0(peak, surface), surface) == pytest.approx(peak, rel=1e-6)


def test_mu0_of_many_peaks_is_that_of_each() -> None:
    peaks = np.linspace(0.05, 0.12, 40).reshape(2, 20)
    found = POLACH.mu0_of(peaks, SURFACES["low"])
    assert found.shape == peaks.shape
    for peak, mu0 in zip(peaks.ravel()[::7], found.ravel()[::7], strict=True):
        assert POLACH.peak(float(mu0), SURFACES["low"], REFERENCE_SPEED_MPS) == pytest.approx(peak, rel=1e-4)


def test_an_unreachable_peak_is_refused() -> None:
    with pytest.raises(ValueError, match="this surface gives no peak adhesion above"):
        POLACH.mu0(20.0, SURFACES["dry"])
