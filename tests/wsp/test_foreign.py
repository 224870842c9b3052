"""C libraries and FMUs as controllers: the same commands as Python, and no way to harm what runs them."""

import _ctypes
import os
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from tests.conftest import EXAMPLES, imported
from wsp.foreign.controller import ForeignController, foreign_controller
from wsp.foreign.errors import ControllerFailed, UnusableController
from wsp.foreign.parameters import ForeignParameters

SPEEDS = np.full(4, 20.0)
VALID = np.ones(4, bool)

# as in misbehaving_controller.c
DEEDS = {
    "good": 0, "crash": 1, "exit": 2, "hang": 3, "nan": 4, "infinite": 5, "valve": 6, "sand": 7, "error": 8,
    "silent": 9, "chatter": 10, "refuse": 20, "crash at start": 21, "hang at start": 22, "fork at start": 23,
}  # fmt: skip

Load = Callable[..., ForeignController]


@pytest.fixture
def load(built_controllers: Path) -> Iterator[Load]:
    """A controller from a built file with parameters; closed after the test."""
    made: list[ForeignController] = []

    def loaded(file: str | Path, **parameters: Any) -> ForeignController:
        controller = foreign_controller(built_controllers / file)(ForeignParameters(**parameters))
        controller.reset(0.0, 1)
        made.append(controller)
        return controller

    yield loaded
    for controller in made:
        controller.close()


def step(controller: Any, t_s: float = 0.0) -> Any:
    return controller.step(t_s, SPEEDS, VALID, 1.0, 1, np.nan)


def running(group: int) -> list[int]:
    """Processes of a group that have not ended."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, pgrp = stat.read_text().rpartition(")")[2].split()[:3]
        except OSError:
            continue
        if int(pgrp) == group and state not in "ZX":
            found.append(int(stat.parent.name))
    return found


def slide(seed: int) -> Iterator[tuple[float, np.ndarray, np.ndarray, float, int, float]]:
    """Inputs of a stop backwards or forwards with sliding axles, lost tachometers, and now and then a speed from
    elsewhere."""
    rng = np.random.default_rng(seed)
    direction = 1 if seed % 2 else -1
    speed, slips = 30.0, np.zeros(4)
    for tick in range(700):
        speed = max(0.0, speed - 0.05)
        slips = np.clip(slips + rng.normal(0.0, 0.02, 4), 0.0, 0.5)
        axles = direction * speed * (1.0 - slips) + rng.normal(0.0, 0.05, 4)
        valid = rng.random(4) < 0.98
        axles[~valid] = np.nan
        outside = speed if 300 < tick < 350 else np.nan
        yield 0.01 * tick, axles, valid, float(tick > 30), direction, outside


PARAMETERS: dict[str, Any] = {"vent_slip": 0.07, "pulse_ticks": 2, "fall_limit_mps2": 2.2}


@pytest.mark.parametrize("seed", [1, 2])
def test_python_c_and_fmus_give_the_same_commands_to_the_sample(load: Load, seed: int) -> None:
    example = imported(EXAMPLES / "example_controller.py")
    python = example.ExampleController(example.ExampleParameters(**PARAMETERS))
    others = [load(file, **PARAMETERS) for file in ("example.so", "example2.fmu", "example3.fmu")]
    seen = set()
    for again in range(2):  # and once more after a reset
        for controller in (python, *others):
            controller.reset(0.0, 1)
        for given in slide(seed + again):
            wanted = python.step(*given)
            for controller in others:
                found = controller.step(*given)
                assert found.valve.tolist() == wanted.valve.tolist()
                assert found.sand.tolist() == wanted.sand.tolist()
                assert found.track_brake == wanted.track_brake
                np.testing.assert_array_equal(found.reference_speed_mps, wanted.reference_speed_mps)
            seen.update(wanted.valve.tolist())
    assert seen == {0, 1, 2}


@pytest.mark.parametrize("file", ["example2.fmu", "example3.fmu"])
def test_the_example_fmus_are_valid(built_controllers: Path, file: str) -> None:
    assert validate_fmu(str(built_controllers / file)) == []


@pytest.mark.parametrize(
    ("deed", "message"),
    [
        ("crash", r"crashed: killed by SIGSEGV \(Segmentation fault\); it had printed: first line \| \[2Jlast words$"),
        ("exit", r"ended its process with exit code 3$"),
        ("hang", r"did not answer within process.tick_limit_s = 0.3 s$"),
        ("nan", r"gave reference_speed_mps = nan, must be a finite speed, or negative if there is none$"),
        ("infinite", r"gave reference_speed_mps = inf, must be a finite speed"),
        ("valve", r"gave valve = \[0, 7, 0, 0\], must be 0 \(fill\), 1 \(hold\) or 2 \(vent\) for every axle$"),
        ("sand", r"gave sand = \[0, 0, -1, 0\], track_brake = 0, must be 0 or 1$"),
        ("error", r"railslide_step failed: axle 3 is on fire$"),
        ("silent", r"railslide_step failed without saying why$"),
    ],
)
def test_what_a_c_library_does_wrong_is_told_with_its_time(
    load: Load, deed: str, message: str, capfd: pytest.CaptureFixture[str]
) -> None:
    controller = load("misbehaving.so", deed=DEEDS[deed], at_s=0.02, process={"tick_limit_s": 0.3})
    pid = controller._process.pid
    step(controller, 0.0)
    step(controller, 0.01)
    with pytest.raises(ControllerFailed, match=r"^controller misbehaving.so at t = 0.02 s: " + message):
        step(controller, 0.02)
    assert running(pid) == []
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("deed", "message"),
    [("crash", "crashed: killed by SIGSEGV"), ("hang", "did not answer within process.tick_limit_s = 0.3 s")],
)
def test_an_fmu_that_crashes_or_hangs_is_gone_with_its_folder(load: Load, deed: str, message: str) -> None:
    controller = load("misbehaving2.fmu", deed=DEEDS[deed], at_s=0.01, process={"tick_limit_s": 0.3})
    pid = controller._process.pid
    folders = [path for path in Path(os.environ.get("TMPDIR", "/tmp")).glob("railslide-fmu-*") if path.is_dir()]
    assert folders
    step(controller)
    with pytest.raises(ControllerFailed, match=message):
        step(controller, 0.01)
    assert running(pid) == []
    assert any(not folder.exists() for folder in folders)


def test_what_an_fmu_reports_before_its_error_is_told(load: Load) -> None:
    controller = load("example2.fmu", process={"period_s": 0.02})
    with pytest.raises(ControllerFailed, match=r"fmi2DoStep failed.*the communication step must be 0.01 s"):
        step(controller)


def test_a_chatty_controller_neither_blocks_nor_reaches_the_terminal(
    load: Load, capfd: pytest.CaptureFixture[str]
) -> None:
    controller = load("misbehaving.so", deed=DEEDS["chatter"], at_s=0.0)
    for tick in range(3):
        assert step(controller, 0.01 * tick).valve.tolist() == [0, 0, 0, 0]
    assert capfd.readouterr() == ("", "")


def test_a_closed_controller_says_so(load: Load) -> None:
    controller = load("example.so")
    controller.close()
    with pytest.raises(ControllerFailed, match="has been closed"):
        step(controller)


def test_nothing_is_left_of_what_the_controller_started(load: Load) -> None:
    controller = load("misbehaving.so", deed=DEEDS["fork at start"])
    pid = controller._process.pid
    assert len(running(pid)) == 2
    controller.close()
    left_by = time.monotonic() + 5.0  # killed they all are; who is no child of ours is reaped by the system in its time
    while running(pid) and time.monotonic() < left_by:
        time.sleep(0.02)
    assert running(pid) == []


def test_its_process_ends_with_the_object(built_controllers: Path) -> None:
    controller = foreign_controller(built_controllers / "example.so")(ForeignParameters())
    pid = controller._process.pid
    assert running(pid) == [pid]
    del controller
    assert running(pid) == []


PARENT = """
import sys, time, numpy
from pathlib import Path
from wsp.foreign.controller import foreign_controller
from wsp.foreign.parameters import ForeignParameters
controller = foreign_controller(Path(sys.argv[1]))(ForeignParameters(deed=int(sys.argv[2])))
controller.reset(0.0, 1)
print(controller._process.pid, flush=True)
while True:
    controller.step(0.0, numpy.zeros(4), numpy.ones(4, bool), 1.0, 1, numpy.nan)
    time.sleep(60.0)
"""


@pytest.mark.parametrize("deed", ["good", "hang"])
def test_a_controller_dies_with_a_parent_that_is_killed(built_controllers: Path, tmp_path: Path, deed: str) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", PARENT, str(built_controllers / "misbehaving2.fmu"), str(DEEDS[deed])],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    ) as parent:
        assert parent.stdout is not None
        pid = int(parent.stdout.readline())
        time.sleep(0.2)
        assert running(pid) == [pid]
        assert list(tmp_path.iterdir())
        parent.send_signal(signal.SIGKILL)
    give_up_s = time.monotonic() + 10.0
    while running(pid) or list(tmp_path.iterdir()):
        assert time.monotonic() < give_up_s, "the worker outlived its parent"
        time.sleep(0.02)


def refusal(file: Path, **parameters: Any) -> str:
    with pytest.raises(UnusableController) as caught:
        foreign_controller(file)(ForeignParameters(**parameters))
    return str(caught.value)


@pytest.mark.parametrize(
    ("deed", "message"),
    [
        ("refuse", "railslide_create refused: not today"),
        ("crash at start", "crashed: killed by SIGSEGV (Segmentation fault)"),
        ("hang at start", "did not answer within process.start_limit_s = 0.5 s"),
    ],
)
def test_a_c_library_that_does_not_start(built_controllers: Path, deed: str, message: str) -> None:
    file = built_controllers / "misbehaving.so"
    told = refusal(file, deed=DEEDS[deed], process={"start_limit_s": 0.5})
    assert told == f"controller = {str(file)!r}: {message}"


def test_libraries_that_cannot_serve(built_controllers: Path, tmp_path: Path) -> None:
    text = tmp_path / "text.so"
    text.write_text("not a library")
    assert "cannot be loaded as a shared library" in refusal(text)
    assert "is built for version 7 of railslide_controller.h, this is version 1" in refusal(
        built_controllers / "another_version.so"
    )
    stranger = Path(_ctypes.__file__)
    assert "does not export railslide_abi_version, railslide_create, railslide_reset" in refusal(stranger)
    example = built_controllers / "example.so"
    assert refusal(example, slip=0.1).endswith("railslide_create refused: there is no parameter slip")
    assert "vent_slip must be a number from 0 on" in refusal(example, vent_slip="much")
    assert refusal(example, variables={"demand": "u"}).startswith("parameters.variables: ")


@pytest.fixture
def changed_fmu(built_controllers: Path, tmp_path: Path) -> Callable[[str, str], Path]:
    """The example of FMI 2.0 with one text of its modelDescription.xml replaced."""

    def changed(old: str, new: str) -> Path:
        out = tmp_path / "changed.fmu"
        with zipfile.ZipFile(built_controllers / "example2.fmu") as source, zipfile.ZipFile(out, "w") as target:
            for name in source.namelist():
                content = source.read(name)
                if name == "modelDescription.xml":
                    assert old.encode() in content
                    content = content.replace(old.encode(), new.encode())
                target.writestr(name, content)
        return out

    return changed


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"valve[3]"', '"valves[3]"', "has no variable valve[3]: rename it, or say in parameters.variables"),
        ('"demand"', '"brake_demand"', "has inputs that nothing feeds (brake_demand)"),
        ('fmiVersion="2.0"', 'fmiVersion="4.0"', "cannot be read as an FMU"),
        ('modelIdentifier="example2"', 'modelIdentifier="other"', "cannot be instantiated on"),
        ('guid="', 'guid="other', "cannot be instantiated on"),
    ],
)
def test_fmus_that_cannot_serve(changed_fmu: Callable[[str, str], Path], old: str, new: str, message: str) -> None:
    assert message in refusal(changed_fmu(old, new))


def test_parameters_that_an_fmu_does_not_have(built_controllers: Path, tmp_path: Path) -> None:
    fmu = built_controllers / "example2.fmu"
    assert refusal(fmu, vent_slipp=0.1) == (
        "parameters.vent_slipp = 0.1: the FMU has no parameter of that name, best matches are vent_slip"
    )
    assert refusal(fmu, vent_slip="much").startswith("parameters.vent_slip = 'much': ")
    assert refusal(fmu, variables={"brake": "x"}).startswith("parameters.variables.brake: no such signal")
    assert "has no variable nowhere" in refusal(fmu, variables={"demand": "nowhere"})
    text = tmp_path / "text.fmu"
    text.write_text("not an archive")
    assert "cannot be read as an FMU" in refusal(text)


def test_variables_of_other_names_can_be_mapped(load: Load, changed_fmu: Callable[[str, str], Path]) -> None:
    """A mapped demand is heard: braked and sliding, the axle is vented; without demand it is not."""
    controller = load(changed_fmu('"demand"', '"u_brake"'), variables={"demand": "u_brake"})
    speeds = np.array([20.0, 20.0, 20.0, 10.0])
    for tick in range(5):
        free = controller.step(0.01 * tick, speeds, VALID, 0.0, 1, np.nan).valve.tolist()
    speeds[3] = 9.5
    braked = controller.step(0.05, speeds, VALID, 1.0, 1, np.nan).valve.tolist()
    assert (free, braked) == ([0, 0, 0, 0], [0, 0, 0, 2])


def test_valve_commands_as_real_numbers_must_be_whole(load: Load, changed_fmu: Callable[[str, str], Path]) -> None:
    """Reference 41 is the reference speed of the FMU, wired to a valve."""
    old = 'name="valve[2]" valueReference="22" causality="output" variability="discrete"><Integer/>'
    controller = load(changed_fmu(old, old.replace("22", "41").replace("Integer", "Real")))
    with pytest.raises(ControllerFailed, match=r"gave valve\[2\] = 20.5: must be a whole number"):
        controller.step(0.0, SPEEDS + 0.5, VALID, 1.0, 1, np.nan)


def test_without_fmpy_the_extra_is_named(
    built_controllers: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "fmpy.py").write_text("raise ImportError('no fmpy here')\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    assert "pip install 'railslide[fmu]'" in refusal(built_controllers / "example2.fmu")


def test_parameters_are_numbers_and_texts() -> None:
    own = ForeignParameters(a=1, b=2.5, c=True, d="text").own
    assert own == {"a": 1, "b": 2.5, "c": True, "d": "text"}
    for value in ([1.0], {"x": 1.0}, None, "null \0 character"):
        with pytest.raises(ValueError, match="a: must be"):
            ForeignParameters(a=value)


def test_the_package_stays_light() -> None:
    """Whoever runs no FMU does not pay for fmpy, and no replay, for pyarrow."""
    program = "import sys, wsp; print(sorted({'fmpy', 'lxml', 'pyarrow', 'wsp.foreign.process'} & set(sys.modules)))"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
