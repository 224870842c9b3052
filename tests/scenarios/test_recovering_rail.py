"""Whole runs on rails that recover: energy, what later axles meet, locked wheels, and a coach that comes later."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

from scenarios.cli import app
from scenarios.parquet import read_columns
from scenarios.run import RunResult, run_scenario
from scenarios.scenario_file import load_scenario
from wheel_rail.adhesion_state import STATE_CELL_M

KMH = 1.0 / 3.6
BRAKE_AT_ONCE = (
    "simulation.initial_speed_kmh=50",
    "simulation.initial_position_m=100",
    "track.length_m=500",
    "track.curves=[]",
    "track.gradients=[]",
    'adhesion.stretches=[{from_m=0.0, recovery="low-recovering", peak_adhesion=0.07}]',
    'driver.phases=[{from_m=0.0, action="brake", demand=1.0}]',
    "balises.first_m=200",
    "estimators.names=[]",
)


class Axles(NamedTuple):
    """Columns of wheelsets.parquet, (n, 4) each."""

    t_s: np.ndarray
    speed_mps: np.ndarray
    rim_speed_mps: np.ndarray
    slip: np.ndarray
    peak_adhesion: np.ndarray
    utilised: np.ndarray
    friction_power_w: np.ndarray


def axles(folder: Path) -> Axles:
    columns = read_columns(folder / "wheelsets.parquet")

    def of_wheelsets(name: str, unit: str = "") -> np.ndarray:
        return np.stack([columns[f"{name}_{k}{unit}"] for k in range(1, 5)], axis=1)

    def both_wheels(name: str) -> np.ndarray:
        return np.stack([columns[f"{name}_{k}l_n"] + columns[f"{name}_{k}r_n"] for k in range(1, 5)], axis=1)

    return Axles(
        columns["t_s"],
        of_wheelsets("speed", "_mps"),
        of_wheelsets("rim_speed", "_mps"),
        of_wheelsets("slip"),
        of_wheelsets("peak_adhesion"),
        -both_wheels("longitudinal_force") / both_wheels("normal_force"),
        of_wheelsets("friction_power", "_w"),
    )


def energy_on_rails_j(folder: Path) -> float:
    rail = read_columns(folder / "rail.parquet")
    return STATE_CELL_M * float(rail["energy_left_jpm"].sum() + rail["energy_right_jpm"].sum())


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("runs")


def run(out: Path, *settings: str) -> RunResult:
    return run_scenario(load_scenario("low-adhesion-stop", [*BRAKE_AT_ONCE, *settings]), out, figures=False)


@pytest.fixture(scope="module")
def first(out: Path) -> RunResult:
    """A coach with WSP on rails as found."""
    return run(out, "scenario.name=first")


@pytest.fixture(scope="module")
def locked(out: Path) -> RunResult:
    """A coach without WSP on rails as found."""
    return run(out, "scenario.name=locked", "wsp.controller=none")


@pytest.fixture(scope="module")
def second(locked: RunResult, out: Path) -> RunResult:
    """The same on the rails that the coach before has left; no WSP, whose valves would make the two stops differ."""
    state = f"adhesion.rail_state_file={locked.folder / 'rail.parquet'}"
    return run(out, "scenario.name=second", "wsp.controller=none", state)


def test_what_the_contacts_dissipate_lies_on_the_rails(first: RunResult, locked: RunResult, second: RunResult) -> None:
    """Of the second coach, what it added to what it found."""
    for done, before_j in ((first, 0.0), (locked, 0.0), (second, energy_on_rails_j(locked.folder))):
        wheelsets = axles(done.folder)
        dissipated = float(np.trapezoid(wheelsets.friction_power_w.sum(axis=1), wheelsets.t_s))
        found = energy_on_rails_j(done.folder) - before_j
        print(f"{done.folder.name}: dissipated {dissipated:.0f} J, on the rails {found:.0f} J")
        assert dissipated > 1e5
        assert found == pytest.approx(dissipated, rel=0.01)


def test_energy_lies_where_wheels_have_slid(first: RunResult) -> None:
    rail = read_columns(first.folder / "rail.parquet")
    truth = read_columns(first.folder / "truth.parquet")
    start, stop = truth["position_m"][0], truth["position_m"][-1]
    energy = rail["energy_left_jpm"]
    assert np.all(energy[rail["position_m"] < start - 10.0] == 0.0)
    assert np.all(energy[rail["position_m"] > stop + 10.0] == 0.0)
    between = energy[(rail["position_m"] > start + 30.0) & (rail["position_m"] < stop - 10.0)]
    assert np.all(between > 0.0)
    # straight and level: both rails alike
    assert rail["energy_right_jpm"] == pytest.approx(energy, rel=0.02, abs=1.0)


def test_later_axles_meet_and_use_more_adhesion_than_the_first(first: RunResult) -> None:
    """Compared by place, as the rail's adhesion goes by place: from where all slide to where the first axle stops."""
    wheelsets = axles(first.folder)
    sliding = np.any(wheelsets.slip > 0.03, axis=1) & (wheelsets.speed_mps[:, 0] > 10.0 * KMH)
    assert sliding.sum() > 50
    columns = read_columns(first.folder / "wheelsets.parquet")
    positions = [columns[f"position_{k}_m"] for k in range(1, 5)]
    begin_m = positions[0][np.argmax(sliding)] + 20.0
    end_m = positions[3][wheelsets.speed_mps[:, 3] > 10.0 * KMH].max()
    assert end_m > begin_m + 50.0
    places = np.arange(begin_m, end_m, 0.5)

    def mean_by_place(values: np.ndarray) -> np.ndarray:
        by_place = [np.interp(places, np.maximum.accumulate(place), values[:, k]) for k, place in enumerate(positions)]
        return np.mean(by_place, axis=1)

    offered = mean_by_place(wheelsets.peak_adhesion)
    used = mean_by_place(wheelsets.utilised)
    print("offered", np.round(offered, 4), "used", np.round(used, 4))
    assert np.all(np.diff(offered) > 0.0)
    assert np.all(np.diff(used) > 0.0)
    assert np.all(offered[1:] > 1.01 * offered[0])
    assert np.all(used[1:] > 1.01 * used[0])


def test_locked_wheels_stay_locked_and_the_later_ones_find_cleaned_rail(locked: RunResult) -> None:
    wheelsets = axles(locked.folder)
    fast = wheelsets.speed_mps[:, 0] > 5.0 * KMH
    stands = np.abs(wheelsets.rim_speed_mps) < 0.05 * wheelsets.speed_mps
    for axle in range(4):
        first_locked = int(np.argmax(stands[:, axle]))
        assert stands[first_locked, axle], "without WSP it locks"
        assert np.all(stands[first_locked:, axle][fast[first_locked:]])
    all_locked = fast & stands.all(axis=1)
    assert all_locked.mean() > 0.4
    used = wheelsets.utilised[all_locked].mean(axis=0)
    print("locked wheels use", np.round(used, 4))
    assert np.all(used[1:] > used[0])


def test_a_second_coach_meets_more_adhesion_and_stops_shorter(locked: RunResult, second: RunResult) -> None:
    offered = []
    for done in (locked, second):
        columns = read_columns(done.folder / "wheelsets.parquet")
        place, peak = columns["position_1_m"], columns["peak_adhesion_1"]
        there = (place > 160.0) & (place < 200.0)  # where all wheels of the coach before have slid
        offered.append(float(peak[there].mean()))
    stops, shortest = (
        [done.metrics["stop"][key] for done in (locked, second)] for key in ("distance_m", "shortest_distance_m")
    )
    print("the first axle is offered", np.round(offered, 4))
    print("stops", np.round(stops, 1), "shortest on the rail as found", np.round(shortest, 1))
    assert offered[1] > 1.1 * offered[0]
    assert stops[1] < 0.98 * stops[0]
    assert shortest[1] < 0.9 * shortest[0]


def test_what_one_run_saves_is_what_the_next_begins_with(locked: RunResult, second: RunResult) -> None:
    once, twice = (read_columns(done.folder / "rail.parquet") for done in (locked, second))
    assert once.keys() == twice.keys()
    assert np.all(twice["energy_left_jpm"] >= once["energy_left_jpm"])
    beyond = once["position_m"] > 400.0
    assert np.array_equal(twice["energy_left_jpm"][beyond], once["energy_left_jpm"][beyond])


@pytest.fixture
def bad_states(first: RunResult, tmp_path: Path) -> Path:
    """Files that are no state of this line, called after what is wrong."""
    table = pq.read_table(first.folder / "rail.parquet")
    pq.write_table(table.slice(0, 100), tmp_path / "another-line.parquet")
    pq.write_table(table.drop_columns(["energy_right_jpm"]), tmp_path / "column-missing.parquet")
    texts = pa.array(["dirty"] * table.num_rows)
    column = table.column_names.index("energy_left_jpm")
    pq.write_table(table.set_column(column, "energy_left_jpm", texts), tmp_path / "text.parquet")
    negative = pa.array(np.full(table.num_rows, -1.0))
    pq.write_table(table.set_column(column, "energy_left_jpm", negative), tmp_path / "negative.parquet")
    whole = (first.folder / "rail.parquet").read_bytes()
    (tmp_path / "broken.parquet").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "folder.parquet").mkdir()
    return tmp_path


@pytest.mark.parametrize("verb", ["check", "run"])
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("another-line.parquet", "the state of another line; this one is 500 m long"),
        ("column-missing.parquet", "energy_right_jpm: the column is missing"),
        ("text.parquet", "energy_left_jpm: must hold numbers"),
        ("negative.parquet", "energy_left_jpm = -1 at 0.0 m: must be finite and not negative"),
        ("broken.parquet", "cannot be read as Parquet"),
        ("folder.parquet", "is a folder"),
        ("gone.parquet", "there is no such file"),
    ],
)
def test_a_state_that_is_none_of_this_line_is_refused(bad_states: Path, verb: str, name: str, words: str) -> None:
    lines = ['[scenario]\nextends = "low-adhesion-stop"', '[coach.contact]\ngeometry = "conical"']
    lines += [f'[adhesion]\nrail_state_file = "{name}"', "[track]\nlength_m = 500.0\ncurves = []\ngradients = []"]
    (bad_states / "my.toml").write_text("\n".join(lines) + "\n[simulation]\ninitial_position_m = 100.0\n")
    out = bad_states / "runs"
    arguments = [verb, str(bad_states / "my.toml"), *(["--out", str(out)] if verb == "run" else [])]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert f"my.toml: adhesion.rail_state_file = {bad_states / name}: " in result.stderr
    assert words in result.stderr
    assert not out.exists()
