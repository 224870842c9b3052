"""The coach's FMU as a tool meets it: it validates, moves as in process, and neither crashes nor hangs its host."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from scenarios.coach_fmu.export import export_fmu
from scenarios.coach_fmu.host import CoachFmu, brake
from scenarios.coach_fmu.variables import GOT, VARIABLES
from scenarios.cosimulation.simulation import simulate
from scenarios.observe import observe
from scenarios.scenario_file import load_scenario
from scenarios.schema import TICK_S, Scenario
from wsp import FILL, HOLD, VENT

SETTINGS = (
    "simulation.initial_speed_kmh=60",
    "simulation.initial_position_m=1350",
    'driver.phases=[{from_m=0.0, action="brake", demand=1.0}]',
    "track.length_m=1800",
    "brake.valve_dead_time_s=0.02",
    "traction.anti_skid=false",
)
WAIT_S = 20.0
RECORDED = (
    "true_position_m",
    "true_speed_mps",
    "axle_speed_mps",
    "axle_speed_valid",
    "cylinder_pressure_bar",
    "distributor_pressure_bar",
    "reservoir_pressure_bar",
    "air_nl",
    "demand_in_force",
    "pulse_count",
    "imu_specific_force_x_mps2",
    "imu_angular_rate_z_radps",
    "imu_temperature_degc",
)


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario("low-adhesion-stop", SETTINGS)


@pytest.fixture(scope="module")
def files(scenario: Scenario, tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """The FMU for FMI 2.0 and 3.0."""
    folder = tmp_path_factory.mktemp("fmu")
    files = {fmi: folder / f"coach{fmi}.fmu" for fmi in (2, 3)}
    export_fmu(scenario, files[2], 2)
    export_fmu(scenario, files[3], 3)
    return files


@pytest.fixture(scope="module")
def folders(files: dict[int, Path], tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """The same, unpacked, at a path that has to be escaped in a URI."""
    parent = tmp_path_factory.mktemp("with space, 100 % ü")
    for fmi, file in files.items():
        extract(str(file), str(parent / str(fmi)))
    return {fmi: parent / str(fmi) for fmi in files}


@pytest.fixture(scope="module")
def shared(folders: dict[int, Path]) -> Iterator[CoachFmu]:
    with CoachFmu(folders[2]) as coach:
        yield coach


@pytest.fixture
def coach(shared: CoachFmu) -> CoachFmu:
    """A coach that has not started yet: one process serves many runs."""
    shared.calls.reset()
    shared.messages.clear()
    return shared


def processes() -> list[int]:
    """Children of this process that compute coaches, zombies included."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            name, _, rest = (entry / "stat").read_text().rpartition(")")
        except (OSError, ValueError):
            continue
        if int(rest.split()[1]) == os.getpid() and "python" in name:
            found.append(int(entry.name))
    return found


def is_running(pid: int) -> bool:
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("fmi", [2, 3])
def test_fmpy_finds_no_fault(files: dict[int, Path], fmi: int) -> None:
    assert validate_fmu(str(files[fmi])) == []


HOST = """
import sys
import numpy as np
from pathlib import Path
from scenarios.compile_cache import use_compile_cache
use_compile_cache()
from scenarios.coach_fmu.host import CoachFmu, brake
from scenarios.scenario_file import load_scenario
folder, scenario, ticks, out, *recorded = sys.argv[1:]
controller = load_scenario(scenario).make_controller()
with CoachFmu(Path(folder)) as coach:
    coach.start()
    braked = brake(coach, controller, int(ticks), recorded)
np.savez(out, t_s=braked.t_s, factor=braked.realtime_factor, **braked.outputs)
"""


@pytest.mark.parametrize("fmi", [2, 3])
def test_controller_in_a_tool_makes_the_motion_that_it_makes_in_process(
    scenario: Scenario, folders: dict[int, Path], tmp_path: Path, fmi: int
) -> None:
    """Rule table in a host process of its own against the same one inside of `simulate`: equal to the last bit."""
    from scenarios.scenario_file import dump_scenario

    (tmp_path / "scenario.toml").write_text(dump_scenario(scenario))
    truth = simulate(scenario, lambda *_: None, lambda: False)
    rows = len(truth.motion.t_s)
    command = [sys.executable, "-c", HOST, str(folders[fmi]), str(tmp_path / "scenario.toml"), str(rows - 1)]
    subprocess.run([*command, str(tmp_path / "braked.npz"), *RECORDED], check=True)
    with np.load(tmp_path / "braked.npz") as braked:
        print(f"FMI {fmi}.0: {braked['factor']:.1f} times real time")
        np.testing.assert_allclose(braked["t_s"], truth.motion.t_s, rtol=0.0, atol=1e-9)
        np.testing.assert_array_equal(braked["true_position_m"], truth.motion.position_m)
        np.testing.assert_array_equal(braked["true_speed_mps"], truth.motion.speed_mps)
        np.testing.assert_array_equal(braked["axle_speed_mps"], truth.axle_speeds.axle_speed_mps[:rows])
        np.testing.assert_array_equal(braked["axle_speed_valid"], truth.axle_speeds.valid[:rows])
        np.testing.assert_array_equal(braked["cylinder_pressure_bar"], truth.brake.cylinder_pressure_bar)
        np.testing.assert_array_equal(braked["distributor_pressure_bar"], truth.brake.distributor_pressure_bar)
        np.testing.assert_array_equal(braked["reservoir_pressure_bar"], truth.brake.reservoir_pressure_bar)
        np.testing.assert_array_equal(braked["air_nl"], truth.brake.air_nl)
        np.testing.assert_array_equal(braked["demand_in_force"], truth.brake.demand)
        imu = observe(scenario, truth).imu
        np.testing.assert_array_equal(braked["imu_specific_force_x_mps2"], imu.specific_force_mps2[:, 0])
        np.testing.assert_array_equal(braked["imu_angular_rate_z_radps"], imu.angular_rate_radps[:, 2])
        np.testing.assert_array_equal(braked["imu_temperature_degc"], imu.temperature_degc)
        pulses = truth.tachometer
        for axle in range(4):
            mine = (pulses.wheelset == axle + 1) & (pulses.t_s > 0.0) & (pulses.t_s <= truth.motion.t_s[-1])
            assert braked["pulse_count"][-1, axle] == pulses.direction[mine].sum()
        assert np.ptp(braked["cylinder_pressure_bar"], axis=0).min() > 1.0  # the controller has been at work


def test_inputs_act_from_the_start_of_the_step_that_they_were_set_before(coach: CoachFmu) -> None:
    """Valves: energised after their dead time of two ticks, seen at the end of the tick in which they are."""
    coach.start()
    for _ in range(5):
        coach.step()
    coach.set("valve_command", [HOLD, VENT, FILL, FILL])
    seen = []
    for tick in range(6):
        if tick == 1:
            coach.set("valve_command", [FILL] * 4)
        coach.step()
        seen.append(coach.get("valve_state"))
    assert seen == [[FILL] * 4, [FILL] * 4, [HOLD, VENT, FILL, FILL], [FILL] * 4, [FILL] * 4, [FILL] * 4]


def test_traction_acts_from_the_start_of_its_step(coach: CoachFmu, scenario: Scenario) -> None:
    coach.set("external_driver", [True])
    coach.start()
    accelerations = []
    for force_n in (0.0, 0.0, 40_000.0):
        coach.set("traction_n", [force_n])
        coach.step(20 * TICK_S)
        accelerations.append(coach.get("true_acceleration_mps2")[0])
    mass_kg = 4.0 * 2.0 * scenario.coach.static_wheel_load_n / 9.81
    gained = (accelerations[2] - accelerations[1]) * mass_kg / 40_000.0
    assert 0.85 < gained < 1.0  # what is left turns the wheels


def test_a_driver_outside_overrules_the_scenario_s(coach: CoachFmu, scenario: Scenario) -> None:
    coach.set("external_driver", [True])
    coach.set("demand", [0.5])
    coach.start()
    coach.step(8.0)
    full_bar = scenario.brake.full_service_pressure_bar
    assert coach.get("distributor_pressure_bar")[0] == pytest.approx(0.5 * full_bar)
    assert coach.get("demand_in_force") == [0.5]
    coach.set("demand", [0.0])
    coach.step()
    assert coach.get("distributor_pressure_bar")[0] < 0.5 * full_bar


def all_outputs(coach: CoachFmu) -> dict[str, float]:
    return {variable.name: coach.get(variable.name)[0] for variable in GOT}


def test_steps_of_any_length_and_a_second_run_give_the_same(coach: CoachFmu) -> None:
    found = []
    for steps in ([TICK_S] * 60, [3 * TICK_S] * 20, [20 * TICK_S] * 3):
        coach.calls.reset()
        coach.start()
        coach.set("valve_command", [FILL, FILL, VENT, FILL])
        for step_s in steps:
            coach.step(step_s)
        found.append(all_outputs(coach))
    assert found[0] == found[1] == found[2]


def test_time_starts_where_the_tool_wants(coach: CoachFmu) -> None:
    found = []
    for start_s in (0.0, 1000.0):
        coach.calls.reset()
        coach.start(start_s)
        coach.step(0.5)
        found.append(all_outputs(coach))
    for name in found[0]:
        timely = name in ("time", "imu_sampled_s") or name.startswith("last_pulse_s")
        assert found[1][name] - found[0][name] == pytest.approx(1000.0 if timely else 0.0, abs=1e-9), name


def test_pulses_give_the_speeds_of_the_front_end(coach: CoachFmu, scenario: Scenario) -> None:
    pitch_m = 2.0 * np.pi * np.array(scenario.tachometers.wheel_radius_m) / scenario.tachometers.pulses_per_revolution
    coach.start()
    coach.step()
    for _ in range(5):
        counts, times = np.array(coach.get("pulse_count")), np.array(coach.get("last_pulse_s"))
        coach.step()
        counted = np.array(coach.get("pulse_count")) - counts
        lasted_s = np.array(coach.get("last_pulse_s")) - times
        np.testing.assert_allclose(pitch_m * counted / lasted_s, coach.get("axle_speed_mps"), rtol=1e-9)


def test_bad_calls_are_refused_with_one_message_and_can_be_put_right(coach: CoachFmu) -> None:
    coach.start()
    refused = {
        "valve_command[2] = 7": lambda: coach.set("valve_command", [0, 7, 0, 0]),
        "demand = nan": lambda: coach.set("demand", [float("nan")]),
        "traction_n = inf": lambda: coach.set("traction_n", [float("inf")]),
    }
    for message, spoil in refused.items():
        spoil()
        with pytest.raises(FMICallException):
            coach.step()
        assert len(coach.messages) == 1
        assert message in coach.messages.pop()
        coach.set("valve_command", [0, 0, 0, 0])
        coach.set("demand", [0.0])
        coach.set("traction_n", [0.0])
        coach.step()


def test_wrong_times_types_and_states_are_refused(coach: CoachFmu) -> None:
    speed = next(k for k, variable in enumerate(VARIABLES) if variable.name == "axle_speed_mps[1]")
    wrong = {
        "must be a whole multiple of 0.01 s": lambda: coach.calls.doStep(0.0, 0.015),
        "the coach is at 0 s": lambda: coach.calls.doStep(5.0, TICK_S),
        "an output cannot be set": lambda: coach.calls.setReal([speed], [1.0]),
        "no variable of the type": lambda: coach.calls.getInteger([speed]),
        "value reference 9999": lambda: coach.calls.getReal([9999]),
        "before the first step": lambda: coach.set("external_driver", [True]),
        "not in this state": coach.calls.enterInitializationMode,
        "fmi2GetString: not supported": lambda: coach.calls.getString([0]),
    }
    coach.start()
    for message, call in wrong.items():
        with pytest.raises(FMICallException):
            call()
        assert len(coach.messages) == 1
        assert message in coach.messages.pop()
    coach.step()


def test_the_end_of_the_track_ends_the_run_not_the_fmu(coach: CoachFmu) -> None:
    coach.set("external_driver", [True])
    coach.start()
    with pytest.raises(FMICallException):
        coach.step(60.0)
    for _ in range(2):
        assert "left the track" in coach.messages[-1]
        with pytest.raises(FMICallException):
            coach.step()
    coach.calls.reset()
    coach.start()
    coach.step()


def test_several_coaches_at_once(folders: dict[int, Path], coach: CoachFmu) -> None:
    """Two versions of the FMU in one host, one braked and one vented, and none left when they are freed."""
    with CoachFmu(folders[3]) as second:
        coach.start()
        second.start()
        second.set("valve_command", [VENT] * 4)
        for _ in range(10):
            coach.step(10 * TICK_S)
            second.step(10 * TICK_S)
        assert min(coach.get("cylinder_pressure_bar")) > 0.3
        assert max(second.get("cylinder_pressure_bar")) < 0.01
        assert len(processes()) == 2
    assert len(processes()) == 1
    coach.step()


def wrapper(folder: Path, command: str) -> str:
    path = folder / "python-of-a-test"
    path.write_text(f"#!/bin/sh\nexec {command}\n")
    path.chmod(0o755)
    return str(path)


@pytest.mark.parametrize("fmi", [2, 3])
def test_without_a_python_it_says_so(folders: dict[int, Path], monkeypatch: pytest.MonkeyPatch, fmi: int) -> None:
    monkeypatch.setenv("RAILSLIDE_PYTHON", "/no/such/python")
    with pytest.raises(RuntimeError, match=r"needs a Python with railslide, and /no/such/python cannot be started"):
        CoachFmu(folders[fmi])


def test_without_railslide_it_says_so(
    folders: dict[int, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAILSLIDE_PYTHON", wrapper(tmp_path, f'"{sys.executable}" -S -E "$@"'))
    before = processes()
    with CoachFmu(folders[2]) as coach:
        with pytest.raises(FMICallException):
            coach.start()
        (message,) = coach.messages
        assert "needs a Python with railslide" in message
        assert "No module named 'scenarios'" in message
        assert "RAILSLIDE_PYTHON" in message
        with pytest.raises(FMICallException):
            coach.start()
    assert processes() == before


def test_a_process_that_hangs_is_given_up(
    folders: dict[int, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAILSLIDE_PYTHON", wrapper(tmp_path, "sleep 100"))
    monkeypatch.setenv("RAILSLIDE_TIMEOUT_S", "0.3")
    begin_s = time.monotonic()
    with CoachFmu(folders[2]) as coach:
        with pytest.raises(FMICallException):
            coach.start()
        assert "gave no answer within 0.3 s" in coach.messages[0]
    assert time.monotonic() - begin_s < 5.0


def test_a_python_of_another_railslide_is_refused(
    folders: dict[int, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its greeting is the digest of other variables."""
    greeting = "import os, struct; os.write(0, struct.pack('dd', 0, 32) + b'x' * 32); os.read(0, 1)"
    monkeypatch.setenv("RAILSLIDE_PYTHON", wrapper(tmp_path, f'"{sys.executable}" -S -c "{greeting}"'))
    with CoachFmu(folders[2]) as coach:
        with pytest.raises(FMICallException):
            coach.start()
        assert "export the FMU anew" in coach.messages[0]


def test_a_process_that_is_killed_fails_the_step_and_reset_starts_another(folders: dict[int, Path]) -> None:
    others = set(processes())
    with CoachFmu(folders[2]) as coach:
        coach.start()
        (pid,) = set(processes()) - others
        os.kill(pid, signal.SIGKILL)
        for _ in range(2):
            with pytest.raises(FMICallException):
                coach.step()
        assert "was ended by signal 9" in coach.messages[0]
        coach.calls.reset()
        coach.start()
        coach.step()
        assert coach.get("time") == [pytest.approx(TICK_S)]
    assert set(processes()) == others


DYING_HOST = """
import os, sys
from pathlib import Path
from scenarios.coach_fmu.host import CoachFmu
coach = CoachFmu(Path(sys.argv[1]))
coach.start()
children = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text().split()
print(*children, flush=True)
os.kill(os.getpid(), 9)
"""


def test_the_process_dies_with_its_host(folders: dict[int, Path]) -> None:
    host = subprocess.run([sys.executable, "-c", DYING_HOST, str(folders[2])], capture_output=True, text=True)
    assert host.returncode == -signal.SIGKILL
    (pid,) = map(int, host.stdout.split())
    deadline_s = time.monotonic() + WAIT_S
    while is_running(pid):
        assert time.monotonic() < deadline_s, f"process {pid} has outlived its host"
        time.sleep(0.02)


def test_brake_counts_its_time(coach: CoachFmu, scenario: Scenario) -> None:
    coach.start()
    braked = brake(coach, scenario.make_controller(), 100)
    assert braked.t_s[-1] == pytest.approx(1.0)
    assert braked.realtime_factor == pytest.approx(1.0 / braked.wall_s)
