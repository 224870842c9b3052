"""`railslide wsp-test` as a user meets it, on a programme of a few short stops."""

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from scenarios.cli import app

PROGRAMME = """
[programme]
name = "tiny"
title = "Three short stops"
scenario = "base.toml"
dry = ['adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]']
[groups.low]
title = "low adhesion"
limits = ["low"]
[groups.lower]
title = "lower adhesion"
limits = ["lower"]
[[stops]]
name = "low-20"
group = "low"
speed_kmh = 20
load = "empty"
[[stops]]
name = "low-15"
group = "low"
speed_kmh = 15
load = "empty"
[[stops]]
name = "lower-15"
group = "lower"
speed_kmh = 15
load = "empty"
settings = ["adhesion.stretches.0.peak_adhesion=0.04"]
"""
BASE = """
[simulation]
step_s = 0.005
longest_s = 60.0
initial_speed_kmh = 20.0
[coach]
preset = "malvezzi-2014"
[track]
length_m = 200.0
[[adhesion.stretches]]
from_m = 0.0
surface = "low"
peak_adhesion = 0.06
[creep_law]
name = "polach"
[[driver.phases]]
from_m = 0.0
action = "coast"
[[driver.phases]]
from_m = 30.0
action = "brake"
demand = 1.0
[brake]
preset = "lhb-discs-56t"
[wsp]
controller = "none"
[imu]
preset = "malvezzi-2014"
"""
LIMITS = """
[[limits]]
metric = "distance_over_dry"
at_most = 1.01
unit = "1"
applies_to = ["lower"]
known = "second-hand"
source = "made up for this test, and beyond what the rail can give"
"""
NAMES = ("low-20", "low-15", "lower-15", "dry-reference-20-empty", "dry-reference-15-empty")


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.toml").write_text(PROGRAMME)
    (tmp_path / "base.toml").write_text(BASE)
    (tmp_path / "limits.toml").write_text(LIMITS)
    return tmp_path


ARGUMENTS = ("--programme", "tiny.toml", "--limits", "limits.toml", "--workers", "1", "--figures", "none")


def invoke(controller: str, *more: str, arguments: tuple[str, ...] = ARGUMENTS) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, ["wsp-test", controller, *arguments, *more])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.stdout, result.stderr


def stops_of(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "stops").iterdir()}


def computed(folder: Path) -> int:
    return int(json.loads((folder / "provenance.json").read_text())["stops_computed"])


def test_scorecard_and_resuming(place: Path) -> None:
    code, output, errors = invoke("rule-table", "--json", "card.json")
    assert (code, errors) == (0, "")
    folder = place / "runs" / "wsp-test-rule-table"
    first = stops_of(folder)
    assert set(first) == {f"{name}.json" for name in NAMES}
    for name in NAMES[:3]:
        assert name in output
    assert "beyond: lower-15: distance over dry" in output
    assert "(M)" in output
    assert "3 stops, 1 with a figure beyond a limit" in output
    tree = json.loads((folder / "scorecard.json").read_text())
    assert tree == json.loads((place / "card.json").read_text())
    _check_figures(tree)
    rows = list(csv.DictReader((folder / "scorecard.csv").read_text().splitlines()))
    assert [row["name"] for row in rows] == ["low-20", "low-15", "lower-15"]
    assert float(rows[0]["distance_m"]) == tree["stops"][0]["distance_m"]

    # nothing is run again; what is missing, damaged or from other parameters is
    assert invoke("rule-table")[0] == 0
    assert computed(folder) == 0
    (folder / "stops" / "low-15.json").unlink()
    (folder / "stops" / "low-20.json").write_text('{"key": ')
    assert invoke("rule-table")[0] == 0
    assert computed(folder) == 2
    assert stops_of(folder) == first
    assert invoke("rule-table", "--set", "wsp.parameters.fill_pulse_s=0.03")[0] == 0
    assert computed(folder) == 3
    assert stops_of(folder)["lower-15.json"] != first["lower-15.json"]
    assert stops_of(folder)["dry-reference-20-empty.json"] == first["dry-reference-20-empty.json"]

    assert invoke("rule-table", "--strict")[0] == 1
    assert invoke("rule-table", "--strict", "--only", "low")[0] == 0


def _check_figures(tree: dict[str, Any]) -> None:
    """Physics that any sound stop obeys."""
    low, low_15, lower = tree["stops"]
    for stop in tree["stops"]:
        assert stop["ended"] == "standstill"
        # the point mass uses all the adhesion there is
        assert 1.0 <= stop["distance_over_shortest"] < 1.3
        assert stop["dry_distance_m"] < stop["shortest_distance_m"]
        assert stop["valve_operations"] > 0
    assert lower["distance_m"] > low_15["distance_m"]
    assert low["distance_m"] > low_15["distance_m"]
    assert low["dry_distance_m"] > low_15["dry_distance_m"] == lower["dry_distance_m"]
    mean = tree["groups"]["low"]["mean"]["distance_m"]
    assert mean == pytest.approx(0.5 * (low["distance_m"] + low_15["distance_m"]))


def test_results_do_not_depend_on_the_number_of_workers(place: Path) -> None:
    assert invoke("rule-table")[0] == 0
    two = ("--programme", "tiny.toml", "--limits", "limits.toml", "--workers", "2", "--out", "two")
    code, output, _ = invoke("rule-table", arguments=two)
    assert code == 0
    one, other = place / "runs" / "wsp-test-rule-table", place / "two" / "wsp-test-rule-table"
    assert computed(other) == len(NAMES)
    assert stops_of(one) == stops_of(other)
    for name in ("scorecard.json", "scorecard.csv"):
        assert (one / name).read_bytes() == (other / name).read_bytes()
    pictures = sorted(path.name for path in (other / "figures").iterdir())
    summaries = ["brake-performance.png", "distances.png", "slip-histogram.png", "utilisation-air.png"]
    assert [name for name in pictures if not name.startswith("stop-")] == summaries
    assert sum(name.startswith("stop-low") for name in pictures) == 2  # the worst of each group
    for picture in pictures:
        assert (other / "figures" / picture).read_bytes().startswith(b"\x89PNG")
        assert picture in output


BREAKS_DOWN = """
from wsp.controllers.none import NoProtection


class BreaksDown(NoProtection):
    def step(self, t_s, axle_speed_mps, *rest):
        if axle_speed_mps[0] > 5.0:
            raise ArithmeticError("too fast for me")
        return super().step(t_s, axle_speed_mps, *rest)
"""


def test_a_stop_that_breaks_down_is_told_and_the_others_go_on(place: Path) -> None:
    (place / "mine.py").write_text(BREAKS_DOWN)
    code, output, _ = invoke("mine.py:BreaksDown")
    assert code == 1
    assert re.search(
        r"failed: low-20: controller at t = \d+\.\d+ s: ArithmeticError: too fast for me", " ".join(output.split())
    )
    assert "2 stops," in output
    folder = place / "runs" / "wsp-test-BreaksDown"
    assert "low-20.json" not in stops_of(folder)
    tree = json.loads((folder / "scorecard.json").read_text())
    assert [stop["name"] for stop in tree["stops"]] == ["low-15", "lower-15"]
    assert list(tree["failures"]) == ["low-20"]
    # what broke down is tried again, the rest is not
    assert invoke("mine.py:BreaksDown")[0] == 1
    assert computed(folder) == 1


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (["--programme", "gone.toml"], "gone.toml: there is no such file"),
        (["--limits", "gone.toml"], "gone.toml: there is no such file"),
        (["--only", "nothing"], "--only: nothing: no group and no stop of this name"),
        (["--figures", "some"], "--figures: some: must be one of none, summary, worst, all"),
        (["--set", "wsp.parameters.fill=1"], "--set: wsp.parameters.fill: unknown key"),
        (["--json", "no/such/file.json"], "--json: no/such/file.json: cannot be written"),
        (["--out", "base.toml"], "--out: "),
    ],
)
def test_bad_arguments_end_in_one_message_before_any_stop(more: list[str], told: str, place: Path) -> None:
    code, output, errors = invoke("rule-table", *more)
    assert (code, output) == (2, "")
    assert errors.startswith(f"error: {told}")
    assert len(errors.splitlines()) == 1
    assert not (place / "runs").exists()


def test_unknown_controller_ends_in_one_message(place: Path) -> None:
    code, _, errors = invoke("rule-tabel")
    assert code == 2
    assert errors.startswith("error: CONTROLLER: wsp.controller: controller 'rule-tabel' not found")


def test_a_folder_of_somebody_else_is_left_alone(place: Path) -> None:
    strange = place / "runs" / "wsp-test-rule-table"
    strange.mkdir(parents=True)
    (strange / "thesis.txt").write_text("mine")
    code, _, errors = invoke("rule-table")
    assert code == 2
    assert "thesis.txt" in errors
    assert os.listdir(strange) == ["thesis.txt"]


def test_ctrl_c_keeps_finished_stops_and_the_next_call_goes_on(place: Path) -> None:
    folder = place / "runs" / "wsp-test-rule-table"
    # stops so long that the command is still at work when the first of them is there
    (place / "tiny.toml").write_text(PROGRAMME.replace("speed_kmh = 15", "speed_kmh = 60"))
    (place / "base.toml").write_text(BASE.replace("length_m = 200.0", "length_m = 2000.0").replace("= 30.0", "= 100.0"))
    program = "import sys; from scenarios.cli import main; sys.exit(main())"
    call = [sys.executable, "-c", program, "wsp-test", "rule-table", *ARGUMENTS, "--workers", "2"]
    with subprocess.Popen(
        call, cwd=place, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as running:
        until_s = time.monotonic() + 120.0
        while running.poll() is None and time.monotonic() < until_s and not list((folder / "stops").glob("l*.json")):
            time.sleep(0.005)
        os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to all processes of the command
        output, errors = running.communicate(timeout=60.0)
    finished = stops_of(folder)
    assert running.returncode == 130
    assert output == ""
    assert len(errors.splitlines()) == 1, errors
    assert f"interrupted; {len(finished)} of " in errors
    assert all(json.loads(content)["score"]["ended"] == "standstill" for content in finished.values())
    assert not list((folder / "stops").glob(".*"))
    assert invoke("rule-table")[0] == 0
    assert computed(folder) == len(NAMES) - len(finished)
    assert all(stops_of(folder)[name] == content for name, content in finished.items())
