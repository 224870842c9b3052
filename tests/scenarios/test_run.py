"""Whole runs through every part: what lies in the run folder, what seeds change, and what breaking off leaves."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

from scenarios import run as run_module
from scenarios.cli import app
from scenarios.errors import RunFailed, RunInterrupted, SolveFailed
from scenarios.run import RunResult, Watcher, run_scenario
from scenarios.scenario_file import load_scenario
from scenarios.schema import Scenario
from scenarios.truth import Truth

SHORT_STOP = """
[scenario]
extends = "low-adhesion-stop"
title = "A short stop"
[simulation]
initial_speed_kmh = 30.0
initial_position_m = 1400.0
[[driver.phases]]
from_m = 0.0
action = "brake"
demand = 1.0
[balises]
first_m = 1410.0
"""

TRUE_TABLES = ("truth.parquet", "wheelsets.parquet", "brake.parquet", "rail.parquet", "readings/tachometers.parquet")
SENSED_TABLES = ("readings/imu.parquet", "readings/balises.parquet", "estimates/ins-odo.parquet")


@pytest.fixture(scope="module")
def scenario_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(SHORT_STOP)
    return path


@pytest.fixture(scope="module")
def short(scenario_file: Path) -> Scenario:
    return load_scenario(scenario_file)


@pytest.fixture(scope="module")
def done(short: Scenario, tmp_path_factory: pytest.TempPathFactory) -> RunResult:
    """One whole run, figures included."""
    return run_scenario(short, tmp_path_factory.mktemp("runs"), command=["railslide", "run", "short.toml"])


def tables(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*.parquet"))}


def test_the_run_folder_has_all_its_parts(done: RunResult) -> None:
    found = {path.relative_to(done.folder).as_posix() for path in done.folder.rglob("*") if path.is_file()}
    assert found == {
        "scenario.toml",
        "provenance.json",
        "metrics.json",
        *TRUE_TABLES,
        "readings/axle-speeds.parquet",
        "readings/imu.parquet",
        "readings/balises.parquet",
        "estimates/scmt.parquet",
        "estimates/orientation.parquet",
        "estimates/ins-odo.parquet",
        *(f"figures/{name}.png" for name in ("axle-speeds", "slip-and-adhesion", "estimates", "imu", "line", "rail")),
    }
    assert [figure.is_file() for figure in done.figures] == [True] * 6


def test_every_column_has_its_unit_and_meaning(done: RunResult) -> None:
    for path in done.folder.rglob("*.parquet"):
        for field in pq.read_schema(path):
            assert field.metadata[b"unit"], f"{path.name}: {field.name}"
            assert field.metadata[b"description"], f"{path.name}: {field.name}"


def test_metrics_file_says_what_the_result_says_and_is_plain_json(done: RunResult) -> None:
    def refuse(constant: str) -> None:
        raise ValueError(f"{constant} is not JSON")

    text = (done.folder / "metrics.json").read_text(encoding="utf-8")
    metrics = json.loads(text, parse_constant=refuse)
    assert metrics == done.metrics
    assert len(metrics["wheelsets"]) == 4
    assert set(metrics["estimators"]) == {"scmt", "orientation", "ins-odo"}
    assert metrics["solve"]["step_s"] == 0.005


def test_the_stop_is_one_that_physics_allows(done: RunResult) -> None:
    """From 30 km/h with all of a peak adhesion of 0.08 a stop is not shorter than v^2/(2 mu g).

    The shortest stop is that on the rail as found; wheels that clean it may stop a little shorter.
    """
    stop = done.metrics["stop"]
    least_m = (30.0 / 3.6) ** 2 / (2.0 * 0.09 * 9.81)
    assert least_m < stop["shortest_distance_m"]
    assert least_m < stop["distance_m"]
    assert stop["distance_m"] > 0.95 * stop["shortest_distance_m"]
    assert 0.3 < stop["adhesion_utilisation"] <= 1.01
    assert stop["air_nl"] > 0.0


def test_provenance_tells_what_produced_the_run(done: RunResult) -> None:
    provenance = json.loads((done.folder / "provenance.json").read_text(encoding="utf-8"))
    assert provenance["program"] == "railslide"
    assert {"railslide", "python", "exudyn", "numba", "numpy"} <= set(provenance["versions"])
    assert provenance["seeds"] == {"world": 1, "sensor": 1}
    assert provenance["command"] == ["railslide", "run", "short.toml"]
    assert provenance["presets"]["coach"] == "malvezzi-2014"
    assert provenance["wall_s"]["solve"] > 0.0


def test_the_resolved_scenario_gives_the_same_bytes_again(done: RunResult, tmp_path: Path) -> None:
    again = run_scenario(load_scenario(done.folder / "scenario.toml", ["scenario.name=again"]), tmp_path, figures=False)
    assert tables(again.folder) == tables(done.folder)
    assert not (again.folder / "figures").exists()


def test_another_sensor_seed_gives_other_readings_of_the_same_truth(
    done: RunResult, scenario_file: Path, tmp_path: Path
) -> None:
    other = tables(
        run_scenario(load_scenario(scenario_file, ["scenario.sensor_seed=2"]), tmp_path, figures=False).folder
    )
    first = tables(done.folder)
    for name in (*TRUE_TABLES, "readings/axle-speeds.parquet"):
        assert other[name] == first[name], name
    for name in SENSED_TABLES:
        assert other[name] != first[name], name


def test_another_world_seed_gives_another_rail(done: RunResult, scenario_file: Path, tmp_path: Path) -> None:
    other = tables(
        run_scenario(load_scenario(scenario_file, ["scenario.world_seed=2"]), tmp_path, figures=False).folder
    )
    assert other["wheelsets.parquet"] != tables(done.folder)["wheelsets.parquet"]


def test_the_command_shows_the_figures_and_where_the_pictures_are(scenario_file: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["run", str(scenario_file), "--out", str(tmp_path), "--no-figures"])
    assert result.exit_code == 0, result.stderr
    metrics = json.loads((tmp_path / "short" / "metrics.json").read_text(encoding="utf-8"))
    for words in ("A short stop", "shortest possible", "adhesion utilisation", "locked", "air used", "ins-odo"):
        assert words in result.stdout
    assert f"{metrics['stop']['distance_m']:.1f} m" in result.stdout
    assert str(tmp_path / "short") in result.stdout.replace("\n", "")


class Impatient(Watcher):
    """Asks to stop after some calls."""

    def __init__(self, patience: int) -> None:
        self.patience = patience
        self.asked = 0

    def stop_requested(self) -> bool:
        self.asked += 1
        return self.asked > self.patience


@pytest.mark.parametrize("patience", [0, 1, 5, 30])
def test_a_run_that_is_asked_to_stop_leaves_nothing(short: Scenario, tmp_path: Path, patience: int) -> None:
    with pytest.raises(RunInterrupted):
        run_scenario(short, tmp_path / "runs", Impatient(patience), figures=False)
    assert os.listdir(tmp_path) == []


BREAKING_CONTROLLER = """
from pydantic import BaseModel
from wsp.controllers import CONTROLLERS


class Breaking(CONTROLLERS["none"]):
    def step(self, t_s, *inputs):
        if t_s > 0.5:
            raise ZeroDivisionError("out of ideas")
        return super().step(t_s, *inputs)
"""


def test_a_controller_that_breaks_down_leaves_a_failed_run_and_says_why(scenario_file: Path, tmp_path: Path) -> None:
    (tmp_path / "breaking.py").write_text(BREAKING_CONTROLLER)
    out = tmp_path / "runs"
    arguments = ["run", str(scenario_file), "--out", str(out)]
    arguments += ["--set", f"wsp.controller={tmp_path / 'breaking.py'}:Breaking"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 1
    assert "out of ideas" in result.stderr
    assert str(out / "short.failed") in result.stderr
    assert os.listdir(out) == ["short.failed"]
    assert "out of ideas" in (out / "short.failed" / "failure.txt").read_text(encoding="utf-8")
    assert load_scenario(out / "short.failed" / "scenario.toml").wsp.controller.endswith("breaking.py:Breaking")


def test_a_solve_that_fails_keeps_the_truth_so_far(
    short: Scenario, tmp_path: Path, truth: Truth, monkeypatch: pytest.MonkeyPatch
) -> None:
    def diverge(*arguments: Any) -> Truth:
        raise SolveFailed("diverged at 3.2 s, 1432 m, with a step of 5 ms", truth)

    monkeypatch.setattr(run_module, "simulate", diverge)
    with pytest.raises(RunFailed, match=r"diverged at 3\.2 s") as caught:
        run_scenario(short, tmp_path)
    assert caught.value.folder == tmp_path / "short.failed"
    assert pq.read_table(tmp_path / "short.failed" / "truth.parquet").num_rows == len(truth.motion)
    assert (tmp_path / "short.failed" / "failure.txt").read_text().startswith("diverged at 3.2 s")


def test_ctrl_c_in_the_terminal(scenario_file: Path, tmp_path: Path) -> None:
    """The signal is sent as soon as the run folder is begun; nothing is left, the parents made for it included."""
    out = tmp_path / "deep" / "runs"
    program = "from scenarios.cli import main; main()"
    arguments = [sys.executable, "-c", program, "run", str(scenario_file), "--out", str(out)]
    process = subprocess.Popen(arguments, stderr=subprocess.PIPE, text=True, stdout=subprocess.PIPE)
    until = time.monotonic() + 60.0
    while not (out.exists() and os.listdir(out)) and time.monotonic() < until and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60.0)
    assert process.returncode == 130
    assert errors.strip() == "interrupted, nothing was kept"
    assert os.listdir(tmp_path) == []
