"""Adhesion along the rail: places, random field, seeds, bad input."""

import numpy as np
import pytest
from pydantic import ValidationError

from wheel_rail import (
    REFERENCE_LOAD_N,
    REFERENCE_SPEED_MPS,
    Adhesion,
    AdhesionParameters,
    Contact,
    ContactParameters,
)
from wheel_rail.contact_parameters import ConicalGeometry
from wheel_rail.polach import peak_adhesion

CONTACT = Contact(
    ContactParameters(
        geometry="conical",
        conical=ConicalGeometry(conicity=0.05, rail_head_radius_m=0.3, flange_clearance_m=0.007),
        shear_modulus_pa=82e9,
        poisson=0.28,
        track_stiffness_npm=1e8,
        damping_nspm=3e4,
        flange_stiffness_npm=1e7,
        creep_speed_mps=0.2,
    ),
    0.46,
    70e3,
)
FIELD = AdhesionParameters.model_validate(
    {
        "stretches": [
            {"from_m": 0.0, "surface": "dry", "peak_adhesion": 0.3},
            {"from_m": 1000.0, "surface": "low", "peak_adhesion": 0.07, "spread": 0.01, "correlation_length_m": 40.0},
        ]
    }
)


def make(seed: int, length_m: float = 3000.0) -> Adhesion:
    return Adhesion(FIELD, length_m, CONTACT, np.random.default_rng(seed))


def test_the_law_peaks_where_the_scenario_says() -> None:
    rail = make(1)
    patch = CONTACT.at_load(REFERENCE_LOAD_N).patch
    for s_m in (500.0, 1200.0, 2000.0):
        k = int(s_m / rail.cell_m)
        found, _ = peak_adhesion(REFERENCE_SPEED_MPS, REFERENCE_LOAD_N, patch, rail.table[0, k], 82e9)
        assert found == pytest.approx(rail.peak[k], rel=2e-3)


def test_the_random_field_stays_in_its_band_and_fills_it() -> None:
    field = make(1, 100_000.0).peak[2100:]
    assert np.all((field >= 0.06) & (field <= 0.08))
    assert field.mean() == pytest.approx(0.07, abs=0.0005)
    # evenly spread over the band: standard deviation of a uniform distribution
    assert field.std() == pytest.approx(0.02 / np.sqrt(12.0), rel=0.05)


def test_the_random_field_forgets_itself_over_its_correlation_length() -> None:
    field = make(2, 100_000.0).peak[2100:]
    field = (field - field.mean()) / field.std()
    cells = int(40.0 / 0.5)
    assert np.mean(field[:-cells] * field[cells:]) == pytest.approx(np.exp(-0.5), abs=0.06)
    assert np.mean(field[: -4 * cells] * field[4 * cells :]) == pytest.approx(0.0, abs=0.06)


def test_one_seed_one_rail() -> None:
    assert np.array_equal(make(3).table, make(3).table)
    assert not np.array_equal(make(3).table, make(4).table)


BAD = [
    ({"from_m": 5.0, "surface": "dry", "peak_adhesion": 0.3}, "starts at 0"),
    ({"from_m": 0.0, "surface": "dry", "peak_adhesion": 1.2}, "less than or equal to 1"),
    ({"from_m": 0.0, "surface": "dry", "peak_adhesion": -0.1}, "greater than 0"),
    ({"from_m": 0.0, "surface": "dry", "peak_adhesion": float("nan")}, "finite"),
    ({"from_m": 0.0, "surface": "ice", "peak_adhesion": 0.1}, "'dry', 'wet', 'low' or 'very-low'"),
    ({"from_m": 0.0, "surface": "low", "peak_adhesion": 0.05, "spread": 0.06}, "stay within 0..1"),
]


@pytest.mark.parametrize(("stretch", "message"), BAD)
def test_bad_stretches_are_refused(stretch: dict, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        AdhesionParameters.model_validate({"stretches": [stretch]})


def test_stretches_must_come_in_order() -> None:
    one = {"from_m": 0.0, "surface": "dry", "peak_adhesion": 0.3}
    with pytest.raises(ValidationError, match="beyond the stretch before"):
        AdhesionParameters.model_validate({"stretches": [one, one]})
