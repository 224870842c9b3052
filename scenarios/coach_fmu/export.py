"""Writing the .fmu file: model description, shared library, and the scenario with all files that it names."""

import os
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import tomli_w

from scenarios.coach_fmu.model_description import IDENTIFIER, FmiVersion, model_description
from scenarios.coach_fmu.native import shared_library
from scenarios.errors import BadInput, Fault
from scenarios.relative_paths import change_paths
from scenarios.scenario_file import dump_scenario
from scenarios.schema import TICK_S, Scenario

PLATFORM = {2: "linux64", 3: "x86_64-linux"}
LONGEST_S = 36_000.0
"""The tool says when the run ends, at the latest it is over here."""


def export_fmu(scenario: Scenario, out: Path, fmi: FmiVersion) -> None:
    """Write the coach of `scenario` to the file `out`; an older one is replaced.

    Its controller and estimators stay behind. Raises BadInput where the file cannot be written, a package that the
    export needs is missing, or the scenario does not fit.
    """
    period_s = scenario.simulation.record_period_s
    if period_s != TICK_S:
        message = f"must be {TICK_S} for an FMU, whose IMU samples the ticks"
        raise BadInput(Fault(scenario.name, f"simulation.record_period_s = {period_s}", message))
    if out.is_dir() or not out.name:
        raise BadInput(Fault("--out", str(out), "is a folder, the name of a file is wanted"))
    partial = out.with_name(f".{out.name}.{os.getpid()}.partial")
    try:
        partial.touch()  # whether it can be written shows before the work
        try:
            partial.write_bytes(_archive(scenario, fmi))
            partial.replace(out)
        finally:
            partial.unlink(missing_ok=True)
    except OSError as error:
        raise BadInput(Fault("--out", str(out), f"cannot be written: {error.strerror}")) from None


def _archive(scenario: Scenario, fmi: FmiVersion) -> bytes:
    """The zip archive; the same scenario and railslide give the same bytes."""
    held = BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in _files(scenario, fmi):
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return held.getvalue()


def _files(scenario: Scenario, fmi: FmiVersion) -> Iterator[tuple[str, bytes]]:
    yield "modelDescription.xml", model_description(scenario, fmi)
    yield f"binaries/{PLATFORM[fmi]}/{IDENTIFIER}.so", shared_library()
    yield "resources/python.txt", f"{sys.executable}\n".encode()
    tree = tomllib.loads(dump_scenario(scenario))
    tree["wsp"] = {"controller": "none"}
    tree["estimators"] = {"names": []}
    tree["simulation"]["longest_s"] = LONGEST_S
    carried: dict[str, Path] = {}

    def carry(value: str) -> str:
        """A file that the scenario names goes along; `value` may end in the name of something in a Python file."""
        path, python, name = value.partition(".py:")
        file = Path(path + python.removesuffix(":"))
        inside = f"files/{len(carried)}-{file.name}"
        carried[inside] = file
        return f"{inside}:{name}" if python else inside

    change_paths(tree, carry)
    yield "resources/scenario.toml", tomli_w.dumps(tree).encode()
    for inside, file in carried.items():
        yield f"resources/{inside}", _content(file)


def _content(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise BadInput(Fault(str(file), "", f"cannot be read: {error.strerror}")) from None
