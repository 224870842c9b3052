"""Scenarios with controllers in C, as FMU, from a file and from a record: whole runs and refusals."""

import os
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from scenarios.cli import app
from scenarios.cosimulation.simulation import simulate
from scenarios.errors import BadInput
from scenarios.names import display_name
from scenarios.parquet import read_columns
from scenarios.run import run_scenario
from scenarios.scenario_file import dump_scenario, load_scenario
from scenarios.truth import Truth
from tests.conftest import EXAMPLES

SHORT_STOP = """
[scenario]
extends = "low-adhesion-stop"
name = "short"
[simulation]
initial_speed_kmh = 40.0
initial_position_m = 1390.0
[[driver.phases]]
from_m = 0.0
action = "brake"
demand = 1.0
[estimators]
names = []
[[sanding.sanders]]
wheelset = 1
rate_gps = 30.0
"""


@pytest.fixture
def short_file(tmp_path: Path, built_controllers: Path) -> Path:
    """A scenario file with the built controllers beside it, under `built/`."""
    (tmp_path / "built").symlink_to(built_controllers)
    path = tmp_path / "short.toml"
    path.write_text(SHORT_STOP)
    return path


def truth(file: Path, controller: str) -> Truth:
    return simulate(load_scenario(file, [f"wsp.controller={controller}"]), lambda *_: None, lambda: False)


def test_the_same_scenario_runs_python_c_and_fmus_alike(short_file: Path, built_controllers: Path) -> None:
    wanted = truth(short_file, f"{EXAMPLES / 'example_controller.py'}:ExampleController")
    assert set(np.unique(wanted.brake.valve_command)) == {0, 1, 2}
    assert wanted.brake.sand_command.any()
    for name in ("example.so", "example2.fmu", "example3.fmu"):
        found = truth(short_file, str(built_controllers / name))
        np.testing.assert_array_equal(found.brake.valve_command, wanted.brake.valve_command)
        np.testing.assert_array_equal(found.brake.reference_speed_mps, wanted.brake.reference_speed_mps)
        np.testing.assert_array_equal(found.wheelsets.wheel_angle_rad, wanted.wheelsets.wheel_angle_rad)


def test_a_replayed_run_has_the_same_bytes(short_file: Path, tmp_path: Path) -> None:
    first = run_scenario(load_scenario(short_file), tmp_path / "first", figures=False).folder
    replayed = short_file.with_name("replayed.toml")
    replayed.write_text(
        '[scenario]\nextends = "short.toml"\nname = "short"\n[wsp]\ncontroller = "replay"\n'
        '[wsp.parameters]\nfile = "first/short"\n'
    )
    again = run_scenario(load_scenario(replayed), tmp_path / "again", figures=False).folder
    assert set(read_columns(first / "brake.parquet")["valve_command_1"]) == {0, 1, 2}
    for name in ("truth.parquet", "wheelsets.parquet", "brake.parquet", "rail.parquet"):
        assert (again / name).read_bytes() == (first / name).read_bytes()


def test_a_crash_in_the_run_ends_it_with_a_message_and_what_it_had(
    short_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    short_file.write_text(
        SHORT_STOP + '[wsp]\ncontroller = "built/misbehaving.so"\n[wsp.parameters]\ndeed = 1\nat_s = 2.0\n'
    )
    result = CliRunner().invoke(app, ["run", "short.toml"])
    assert result.exit_code == 1
    assert result.stderr.startswith(
        "error: the run failed: controller misbehaving.so at t = 2.00 s: "
        "crashed: killed by SIGSEGV (Segmentation fault); it had printed: first line | [2Jlast words"
    )
    assert len(result.stderr.splitlines()) == 1
    assert capfd.readouterr() == ("", "")
    assert os.listdir(tmp_path / "runs") == ["short.failed"]
    failed = tmp_path / "runs" / "short.failed"
    assert (failed / "failure.txt").read_text().startswith("controller misbehaving.so at t = 2.00 s: crashed")
    assert read_columns(failed / "brake.parquet")["t_s"][-1] == pytest.approx(1.99, abs=0.011)


@pytest.mark.parametrize(
    ("wsp", "message"),
    [
        ('controller = "gone.so"', "wsp.controller: controller '{folder}/gone.so' not found: there is no such file"),
        ('controller = "built/text.so"', "wsp.controller = '{folder}/built/text.so': cannot be loaded as a shared"),
        ('controller = "built/text.fmu"', "wsp.controller = '{folder}/built/text.fmu': cannot be read as an FMU"),
        (
            'controller = "built/another_version.so"',
            "wsp.controller = '{folder}/built/another_version.so': is built for version 7",
        ),
        (
            'controller = "built/example.so"\nparameters.slip = 0.1',
            "wsp.controller = '{folder}/built/example.so': railslide_create refused: there is no parameter slip",
        ),
        (
            'controller = "built/example2.fmu"\nparameters.slip = 0.1',
            "wsp.parameters.slip = 0.1: the FMU has no parameter of that name, best matches are",
        ),
        (
            'controller = "built/example.so"\nparameters.process.tick_limit_s = 0',
            "wsp.parameters.process.tick_limit_s = 0: must be greater than 0",
        ),
        (
            'controller = "built/example.so"\nparameters.process.period_s = 0.015',
            "its period_s = 0.015 must be a whole multiple of 0.01",
        ),
        ('controller = "built/example.so"\nparameters.x = [1, 2]', "wsp.parameters.x: must be a number, true, false"),
        (
            'controller = "replay"\nparameters.file = "gone"',
            "wsp.parameters.file = '{folder}/gone': there is no",
        ),
        ('controller = "replay"', "wsp.parameters.file: is missing (brake.parquet of a run, or the run's folder)"),
    ],
)
def test_check_refuses_controllers_that_cannot_serve(
    wsp: str, message: str, short_file: Path, built_controllers: Path
) -> None:
    for name in ("text.so", "text.fmu"):
        (built_controllers / name).write_text("neither library nor archive")
    short_file.write_text(f"{SHORT_STOP}[wsp]\n{wsp}\n")
    with pytest.raises(BadInput) as caught:
        load_scenario(short_file)
    folder = str(short_file.parent)
    told = str(caught.value).replace(str(built_controllers), f"{folder}/built")
    assert told.startswith(f"{short_file}: ")
    assert message.format(folder=folder) in told


def test_paths_count_from_the_file_and_parameters_survive_being_written(short_file: Path, tmp_path: Path) -> None:
    short_file.write_text(
        SHORT_STOP
        + '[wsp]\ncontroller = "built/example2.fmu"\n[wsp.parameters]\nvent_slip = 0.2\npulse_ticks = 2\n'
        + 'process.tick_limit_s = 1.5\nvariables.demand = "demand"\n'
    )
    scenario = load_scenario(short_file)
    assert Path(scenario.wsp.controller).is_absolute()
    assert display_name(scenario.wsp.controller) == "example2"
    resolved = tmp_path / "resolved.toml"
    resolved.write_text(dump_scenario(scenario))
    assert load_scenario(resolved).wsp.parameters == scenario.wsp.parameters
