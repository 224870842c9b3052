"""Adhesion along the rail: peaks, places, patches, random fields, seeds, speed law, bad input."""

import dataclasses
import json
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from tests.wheel_rail.rail_kinds import CONTACT, LOAD_N, adhesion, condition_at, fresh, parameters, peak
from wheel_rail import REFERENCE_LOAD_N, REFERENCE_SPEED_MPS, SURFACES, Adhesion, AdhesionParameters
from wheel_rail.adhesion_condition import NO_KIND, past_conditions, rail_condition, rail_conditions
from wheel_rail.adhesion_curves import curtius_kniffler
from wheel_rail.adhesion_state import RailState, RailTables
from wheel_rail.compiled import Array, compiled
from wheel_rail.creep_laws import CREEP_LAWS
from wheel_rail.lanes import LANES
from wheel_rail.peak_adhesion import offered_adhesion
from wheel_rail.recovery import CONDITION, DEGRADED, ENERGY, MU0, RECOVERED, SAND, TAU
from wheel_rail.recovery_parameters import load_recovery

DRY = {"surface": "dry", "peak_adhesion": 0.3}
LOW = {"surface": "low", "peak_adhesion": 0.07}
RECOVERING = {"recovery": "low-recovering", "peak_adhesion": 0.07}
LEVELS = load_recovery("low-recovering").model_dump()
FIELD = parameters(DRY, {"from_m": 1000.0, **LOW, "spread": 0.01, "correlation_length_m": 40.0})


@pytest.mark.parametrize(
    "of", [DRY, LOW, {"surface": "wet", "peak_adhesion": 0.2}, RECOVERING, {**RECOVERING, "recovery": "allotta-2014"}]
)
def test_the_rail_as_found_peaks_where_the_scenario_says(of: dict[str, Any]) -> None:
    assert peak(condition_at(fresh(parameters(of)), 500.0)) == pytest.approx(of["peak_adhesion"], rel=1e-6)


def test_the_random_fields_peaks_are_those_of_the_law() -> None:
    rail = adhesion(FIELD, 3000.0)
    tables = rail.tables(RailState(3000.0))
    for s_m in (1200.0, 2000.0, 2900.0):
        assert peak(condition_at(tables, s_m)) == pytest.approx(rail.peak[0, round(s_m / 0.5)], rel=1e-5)


def test_the_creep_law_in_force_decides_on_mu0() -> None:
    law = CREEP_LAWS["fastsim"].in_force()
    contact = dataclasses.replace(CONTACT, law=law)
    rail = Adhesion(parameters(LOW), 100.0, contact, np.random.default_rng(1))
    found = condition_at(rail.tables(RailState(100.0)), 50.0)
    patch = contact.at_load(REFERENCE_LOAD_N).patch
    got, _ = offered_adhesion(
        law.number, law.address, law.extra, REFERENCE_SPEED_MPS, LOAD_N, patch, found, 82e9, False
    )
    assert got == pytest.approx(0.07, rel=1e-6)
    # and it is another mu0 than Polach's formula needs for the same peak
    assert abs(found[MU0] / condition_at(fresh(parameters(LOW), 100.0), 50.0)[MU0] - 1.0) > 0.01


@pytest.mark.parametrize("surface", SURFACES)
def test_a_surface_without_a_peak_is_the_published_one(surface: str) -> None:
    found = condition_at(fresh(parameters({"surface": surface})), 500.0)
    s = SURFACES[surface]
    published = (s.mu0, s.falling_a, s.falling_b_spm, s.k_adhesion, s.k_slip)
    assert found[DEGRADED:RECOVERED] == pytest.approx(published, rel=1e-6)
    assert found[TAU] == 0.0


def test_stretches_blend_over_one_cell() -> None:
    rail = fresh(parameters(DRY, {"from_m": 400.0, **LOW}))
    before, between, after = (condition_at(rail, s)[: TAU + 1] for s in (399.5, 399.75, 400.0))
    assert between == pytest.approx(0.5 * (before + after), rel=1e-12)
    assert condition_at(rail, 10.0)[: TAU + 1] == pytest.approx(before)
    assert condition_at(rail, 900.0)[: TAU + 1] == pytest.approx(after)


def test_beyond_its_ends_the_rail_goes_on() -> None:
    rail = fresh(FIELD, 1500.0)
    for outside, end in ((-5.0, 0.0), (1600.0, 1500.5)):
        assert condition_at(rail, outside)[:TAU] == pytest.approx(condition_at(rail, end)[:TAU])


def test_the_random_field_stays_in_its_band_and_fills_it() -> None:
    field = adhesion(FIELD, 100_000.0).peak[0, 2100:]
    assert np.all((field >= 0.06) & (field <= 0.08))
    assert field.mean() == pytest.approx(0.07, abs=0.0005)
    # evenly spread over the band: standard deviation of a uniform distribution
    assert field.std() == pytest.approx(0.02 / np.sqrt(12.0), rel=0.05)


def test_the_random_field_forgets_itself_over_its_correlation_length() -> None:
    field = adhesion(FIELD, 100_000.0, seed=2).peak[0, 2100:]
    field = (field - field.mean()) / field.std()
    cells = int(40.0 / 0.5)
    assert np.mean(field[:-cells] * field[cells:]) == pytest.approx(np.exp(-0.5), abs=0.06)
    assert np.mean(field[: -4 * cells] * field[4 * cells :]) == pytest.approx(0.0, abs=0.06)


def test_both_rails_are_alike_unless_said_otherwise() -> None:
    rail = adhesion(FIELD, 3000.0)
    assert np.array_equal(rail.peak[0], rail.peak[1])


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_rails_apart_have_the_correlation_that_is_stated(correlation: float) -> None:
    stretch = {**LOW, "spread": 0.01, "correlation_length_m": 20.0}
    apart = adhesion(parameters({**stretch, "rails_correlation": correlation}), 200_000.0)
    left, right = apart.peak
    # the bounding takes a normal correlation r to (6/pi) asin(r/2)
    expected = 6.0 / np.pi * np.arcsin(0.5 * correlation)
    assert np.corrcoef(left, right)[0, 1] == pytest.approx(expected, abs=0.03)
    assert np.array_equal(left, adhesion(parameters(stretch), 200_000.0).peak[0])
    assert right.std() == pytest.approx(left.std(), rel=0.03)


def test_one_seed_one_rail() -> None:
    one, same, other = (adhesion(FIELD, 3000.0, seed=seed).places for seed in (3, 3, 4))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_patches_and_a_moved_border_leave_the_rest_of_the_field_alone() -> None:
    plain = adhesion(FIELD, 3000.0).peak
    patch = {"surface": "very-low", "peak_adhesion": 0.03, "starts_m": (2000.0,), "length_m": 50.0, "rails": "left"}
    patched = adhesion(FIELD.model_copy(update={"patches": parameters(LOW, patches=[patch]).patches}), 3000.0).peak
    inside = np.zeros(plain.shape[1], dtype=bool)
    inside[4000:4100] = True
    assert np.all(patched[0, inside] == pytest.approx(0.03))
    assert np.array_equal(patched[0, ~inside], plain[0, ~inside])
    assert np.array_equal(patched[1], plain[1])
    moved = parameters(DRY, {**FIELD.stretches[1].model_dump(exclude_none=True), "from_m": 1500.0})
    assert np.array_equal(adhesion(moved, 3000.0).peak[:, 3000:], plain[:, 3000:])


def test_patches_in_a_row() -> None:
    row = {**LOW, "from_m": 100.0, "to_m": 400.0, "length_m": 20.0, "spacing_m": 70.0}
    laid = parameters(DRY, patches=[row])
    assert laid.patches[0].spans_m == [(100.0, 120.0), (170.0, 190.0), (240.0, 260.0), (310.0, 330.0), (380.0, 400.0)]
    found = adhesion(laid).peak
    assert (found[0] < 0.1).sum() * 0.5 == pytest.approx(5 * 20.0)


@pytest.mark.parametrize("speed_kmh", [0.0, 10.0, 33.0, 100.0, 160.0, 300.0])
def test_curtius_kniffler_is_the_peak_at_every_speed(speed_kmh: float) -> None:
    expected = 0.161 + 7.5 / (speed_kmh + 44.0)
    assert curtius_kniffler(speed_kmh) == pytest.approx(expected, rel=1e-12)
    v = speed_kmh / 3.6
    found = peak(condition_at(fresh(parameters({"surface": "dry", "speed_law": "curtius-kniffler"})), 50.0, v), v)
    assert found == pytest.approx(expected, rel=5e-3)
    scaled = {"surface": "wet", "speed_law": "curtius-kniffler", "peak_adhesion": 0.1}
    found = peak(condition_at(fresh(parameters(scaled)), 50.0, v), v)
    assert found == pytest.approx(0.1 * expected / (0.161 + 7.5 / 144.0), rel=5e-3)


def test_the_speed_law_acts_on_both_curves_and_either_direction() -> None:
    rail = fresh(parameters({**RECOVERING, "speed_law": "curtius-kniffler"}))
    slow, fast, back = (condition_at(rail, 50.0, v) for v in (2.0, 40.0, -40.0))
    ratio = slow[RECOVERED + MU0] / fast[RECOVERED + MU0]
    assert ratio > 1.1
    assert slow[DEGRADED + MU0] / fast[DEGRADED + MU0] == pytest.approx(ratio, rel=1e-12)
    assert np.array_equal(fast[:TAU], back[:TAU])


def test_a_relative_recovered_curve_moves_with_the_degraded_one() -> None:
    ratio = LEVELS["recovered"]["mu0"] / LEVELS["degraded"]["mu0"]
    relative = {**LEVELS, "recovered_level": "relative"}
    found = condition_at(fresh(parameters({"recovery": relative, "peak_adhesion": 0.2})), 50.0)
    assert found[RECOVERED + MU0] / found[DEGRADED + MU0] == pytest.approx(ratio, rel=1e-12)


def test_a_wheel_meets_the_energy_ahead_of_it_and_not_its_own() -> None:
    state = RailState(1000.0)
    rail = adhesion(parameters(RECOVERING)).tables(state)
    state.energy_jpm[:] = np.arange(state.energy_jpm.shape[1])
    found = np.empty(CONDITION)
    for s_m, speed_mps, expected in ((50.02, 20.0, 501.2), (50.02, 0.0, 501.2), (50.02, -20.0, 498.2)):
        rail_condition(s_m, 1, speed_mps, rail, found)
        assert found[ENERGY] == pytest.approx(expected, abs=1e-6)
    state.energy_jpm[:, :501] = 1e6  # all that wheels have left behind
    rail_condition(50.099, 0, 20.0, rail, found)
    assert found[ENERGY] < 1000.0


def test_a_coach_meets_what_each_of_its_wheels_meets_alone() -> None:
    """On every kind of rail and where two of them meet, from place to place, with energy and sand; also in hindsight,
    when the rails have other energy and sand by then."""
    kinds_of_rail = (
        DRY,
        {"from_m": 300.0, **RECOVERING},
        {"from_m": 600.0, "surface": "dry", "speed_law": "curtius-kniffler"},
    )
    state = RailState(1000.0)
    made = adhesion(parameters(*kinds_of_rail))
    rail = made.tables(state)
    rng = np.random.default_rng(8)
    state.energy_jpm[:] = rng.uniform(0.0, 1e4, state.energy_jpm.shape)
    state.sand_gpm[:] = rng.uniform(0.0, 3.0, state.sand_gpm.shape) * (rng.random(state.sand_gpm.shape) < 0.5)
    other = made.tables(RailState(1000.0))
    found, kinds = np.empty((CONDITION, LANES)), np.full(LANES, NO_KIND)
    past, past_kinds = np.empty((CONDITION, LANES)), np.full(LANES, NO_KIND)
    for centre in (100.0, 100.3, 299.7, 299.9, 300.2, 450.0, 599.8, 700.0, 100.0):
        s = centre + rng.uniform(-0.4, 0.4, 4)
        speed = rng.uniform(-5.0, 40.0, 4)
        _meet(s, speed, rail, found, kinds)
        for w in range(LANES):
            alone = condition_at(rail, s[w // 2], speed[w // 2], w % 2)
            assert found[:, w] == pytest.approx(alone, rel=1e-13), (centre, w)
        past_conditions(s, speed, found[ENERGY], found[SAND], other, past, past_kinds)
        assert past == pytest.approx(found, rel=1e-13)
    assert len(set(kinds)) == 1


@compiled
def _meet(s_m: Array, speed_mps: Array, rail: RailTables, found: Array, kinds: Array) -> None:
    for i in range(4):
        rail_conditions(i, s_m[i], speed_mps[i], rail, found, kinds)


def test_a_scenario_file_names_its_preset_and_is_written_with_its_figures() -> None:
    """Strict JSON is how scenario files are validated."""
    loaded = AdhesionParameters.model_validate_json(
        json.dumps({"stretches": [{"from_m": 0.0, **RECOVERING}], "memory": {"distance_m": 1e-5}}), strict=True
    )
    written = loaded.model_dump_json(exclude_none=True)
    assert json.loads(written)["stretches"][0]["recovery"]["tau_mpj"] == 5e-4
    assert AdhesionParameters.model_validate_json(written, strict=True) == loaded


BAD = [
    ({**DRY, "from_m": 5.0}, "stretches.0.from_m = 5.0: the first stretch starts at 0"),
    ({**DRY, "peak_adhesion": 1.2}, "less than or equal to 1"),
    ({**DRY, "peak_adhesion": -0.1}, "greater than 0"),
    ({**DRY, "peak_adhesion": float("nan")}, "finite"),
    ({**DRY, "surface": "ice"}, "'dry', 'wet', 'low' or 'very-low'"),
    ({**LOW, "spread": 0.08}, "spread = 0.08: peak_adhesion .* stay within 0..1"),
    ({"surface": "low", "spread": 0.01}, "spread = 0.01: a random field needs peak_adhesion"),
    ({**LOW, "rails_correlation": -0.5}, "greater than or equal to 0"),
    ({**LOW, "correlation_length_m": 0.0}, "greater than or equal to 1"),
    ({**LOW, "file": "rail.csv"}, "peak_adhesion = 0.07: must not stand beside file"),
    ({"peak_adhesion": 0.1}, "surface: exactly one of surface and recovery"),
    ({**LOW, "recovery": "low-recovering"}, "surface = 'low' and recovery are given"),
    ({"recovery": "low-recovring"}, "must be one of allotta-2014, low-recovering, malvezzi-degraded, or a path"),
    ({**LOW, "speed_law": "curtius"}, "curtius-kniffler"),
    ({**LOW, "peak": 0.1}, "Extra inputs"),
]


@pytest.mark.parametrize(("stretch", "message"), BAD)
def test_bad_stretches_are_refused(stretch: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        parameters(stretch)


PLACED = {**LOW, "starts_m": (100.0, 200.0), "length_m": 20.0}
ROW = {**LOW, "from_m": 100.0, "to_m": 400.0, "length_m": 20.0, "spacing_m": 50.0}
BAD_PATCHES = [
    ([{**PLACED, "starts_m": (100.0, 110.0)}], "starts_m.1 = 110.0: overlaps the patch before, .* 120.0"),
    ([{**PLACED, "starts_m": (200.0, 100.0)}], "starts_m.1 = 100.0: overlaps"),
    ([{**PLACED, "starts_m": (-5.0,)}], "starts_m.0 = -5.0: must not be negative"),
    ([{**PLACED, "starts_m": ()}], "at least 1 item"),
    ([{**PLACED, "length_m": -20.0}], "greater than or equal to 1"),
    ([{**PLACED, "from_m": 3.0}], "from_m = 3.0: must not stand beside starts_m"),
    ([{**LOW, "length_m": 20.0, "from_m": 3.0}], "to_m: is missing"),
    ([{**ROW, "spacing_m": 10.0}], "spacing_m = 10.0: patches overlap"),
    ([{**ROW, "to_m": 110.0}], "to_m = 110.0: no patch of 20.0 m fits"),
    ([{**PLACED, "rails": "middle"}], "'left', 'right' or 'both'"),
    ([ROW, {**PLACED, "rails": "left"}], "patches.1: overlaps patches.0 on the left rail between 100.0 and 120.0 m"),
]


@pytest.mark.parametrize(("patches", "message"), BAD_PATCHES)
def test_bad_patches_are_refused(patches: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        parameters(DRY, patches=patches)


def test_patches_on_different_rails_do_not_overlap() -> None:
    parameters(DRY, patches=[{**PLACED, "rails": "left"}, {**PLACED, "rails": "right"}])


def test_stretches_must_come_in_order() -> None:
    with pytest.raises(ValidationError, match="stretches.1.from_m = 0.0: must lie beyond the stretch before"):
        parameters(DRY, DRY)


WEAK = {
    **LEVELS,
    "degraded": {**LEVELS["degraded"], "k_adhesion": 1e-3, "k_slip": 1e-3},
    "recovered_level": "relative",
}
MISFITS = [
    (
        {**RECOVERING, "peak_adhesion": 0.1},
        "adhesion.stretches.0.peak_adhesion: reaches 0.1, above the 0.08852 to",
    ),
    ({"recovery": WEAK, "peak_adhesion": 0.5}, "adhesion.stretches.0.peak_adhesion.* 0.5.* no peak adhesion above 0.0"),
    ({"surface": "low", "file": "/no/such.csv"}, "adhesion.stretches.0.file = /no/such.csv: cannot be read"),
]


@pytest.mark.parametrize(("stretch", "message"), MISFITS)
def test_peaks_that_cannot_be_are_refused(stretch: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        adhesion(parameters(stretch))


def test_what_lies_beyond_the_line_does_not_count() -> None:
    one = adhesion(parameters(DRY, {**LOW, "from_m": 5000.0}, patches=[{**PLACED, "starts_m": (4000.0,)}]))
    assert np.array_equal(one.peak, adhesion(parameters(DRY)).peak)
