"""Builds the example controller as a C library and as FMUs of FMI 2.0 and 3.0.

    python docs/controllers/build.py FOLDER      # needs: pip install 'railslide[fmu]', nothing else

Copy it for a controller of your own: `library` compiles one, `fmu` packs one, with your parameters in PARAMETERS.
The compiler is the ziglang package's; any other that makes shared libraries does as well.
"""

import subprocess
import sys
import uuid
import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy

import wsp.foreign

HERE = Path(__file__).parent
HEADER = Path(wsp.foreign.__file__).parent  # where railslide_controller.h lies
FMI_HEADERS = Path(fmpy.__file__).parent / "c-code"

PARAMETERS = {
    "vent_slip": 0.10,
    "hold_slip": 0.03,
    "slip_offset_mps": 0.4,
    "vent_below_mps2": -3.0,
    "fall_limit_mps2": 1.8,
    "filter_ticks": 4.0,
    "pulse_ticks": 3.0,
    "cycle_ticks": 9.0,
    "cut_off_mps": 1.0,
    "watchdog_ticks": 600.0,
}
"""What example_controller.c can be told, with its defaults: the parameters of the FMUs."""

UNITS = {"_mps": "m/s", "_mps2": "m/s2"}


def library(sources: list[Path], out: Path, *options: str) -> Path:
    """Compile C sources to a shared library. No fused multiply-add: Python has none, and results shall agree."""
    command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-fPIC", "-O2", "-std=c11", "-ffp-contract=off",
               f"-I{HEADER}", *options, *map(str, sources), "-o", str(out)]  # fmt: skip
    subprocess.run(command, check=True)
    return out


def fmu(version: int, source: Path, name: str, folder: Path, parameters: dict[str, float] = PARAMETERS) -> Path:
    """Compile the controller in `source` into an FMU of FMI 2 or 3, `folder`/`name`.fmu."""
    token = str(uuid.uuid5(uuid.NAMESPACE_URL, f"railslide/{name}/{version}"))
    names = ",".join(f'"{parameter}"' for parameter in parameters)
    starts = ",".join(map(repr, parameters.values()))
    wrapper = [HERE / f"fmi{version}.c", HERE / f"fmi{version}_unused.c"]
    suffix = fmpy.sharedLibraryExtension
    options = [f"-I{FMI_HEADERS}", f'-DTOKEN="{token}"', f"-DPARAMETER_NAMES={names}", f"-DPARAMETER_STARTS={starts}"]
    binary = library([source, *wrapper], folder / f"{name}{suffix}", *options)
    description = _description2 if version == 2 else _description3
    place = fmpy.platform if version == 2 else fmpy.platform_tuple
    out = folder / f"{name}.fmu"
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description(name, token, parameters))
        archive.write(binary, f"binaries/{place}/{name}{suffix}")
    binary.unlink()
    return out


# name, type, causality, value reference, start of an input; four of each of the first three kinds
FOURFOLD = (
    ("axle_speed_mps", "real", "input", 1, "0"),
    ("valid", "flag", "input", 11, "false"),
    ("valve", "whole", "output", 21, None),
    ("sand", "flag", "output", 31, None),
)
SINGLE = (
    ("demand", "real", "input", 5, "0"),
    ("outside_reference_mps", "real", "input", 6, "-1"),
    ("direction", "whole", "input", 15, "1"),
    ("track_brake", "flag", "output", 35, None),
    ("reference_speed_mps", "real", "output", 41, None),
)
FIRST_PARAMETER = 101

UNIT_DEFINITIONS = """  <UnitDefinitions>
    <Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit>
    <Unit name="m/s2"><BaseUnit m="1" s="-2"/></Unit>
  </UnitDefinitions>"""


def _unit(name: str) -> str:
    found = [unit for suffix, unit in UNITS.items() if name.endswith(suffix)]
    return f' unit="{found[0]}"' if found else ""


def _description2(name: str, token: str, parameters: dict[str, float]) -> str:
    """modelDescription.xml of FMI 2.0: scalars, outputs and initial unknowns by index."""
    types = {"real": "Real", "flag": "Boolean", "whole": "Integer"}
    scalars = [(f"{n}[{i + 1}]", t, c, r + i, s) for n, t, c, r, s in FOURFOLD for i in range(4)]
    scalars += SINGLE
    lines = []
    for variable, kind, causality, reference, start in scalars:
        unit = _unit(variable.partition("[")[0]) if kind == "real" else ""
        value = f' start="{start}"' if start is not None else ""
        lines.append(
            f'    <ScalarVariable name={quoteattr(variable)} valueReference="{reference}" causality="{causality}" '
            f'variability="discrete"><{types[kind]}{unit}{value}/></ScalarVariable>'
        )
    for number, (variable, value) in enumerate(parameters.items()):
        lines.append(
            f'    <ScalarVariable name={quoteattr(variable)} valueReference="{FIRST_PARAMETER + number}" '
            f'causality="parameter" variability="fixed"><Real{_unit(variable)} start="{value!r}"/></ScalarVariable>'
        )
    outputs = [index for index, scalar in enumerate(scalars, start=1) if scalar[2] == "output"]
    unknowns = "".join(f'<Unknown index="{index}"/>' for index in outputs)
    return "\n".join(
        [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<fmiModelDescription fmiVersion="2.0" modelName={quoteattr(name)} guid="{token}" '
            'variableNamingConvention="structured">',
            f'  <CoSimulation modelIdentifier={quoteattr(name)} canHandleVariableCommunicationStepSize="false"/>',
            UNIT_DEFINITIONS,
            '  <DefaultExperiment startTime="0" stepSize="0.01"/>',
            "  <ModelVariables>",
            *lines,
            "  </ModelVariables>",
            f"  <ModelStructure><Outputs>{unknowns}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns>"
            "</ModelStructure>",
            "</fmiModelDescription>\n",
        ]
    )


def _description3(name: str, token: str, parameters: dict[str, float]) -> str:
    """modelDescription.xml of FMI 3.0: arrays of four, outputs and initial unknowns by value reference."""
    types = {"real": "Float64", "flag": "Boolean", "whole": "Int32"}
    lines = ['    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>']
    for group, dimension in ((FOURFOLD, '<Dimension start="4"/>'), (SINGLE, "")):
        for variable, kind, causality, reference, start in group:
            unit = _unit(variable) if kind == "real" else ""
            value = "" if start is None else f' start="{" ".join([start] * (4 if dimension else 1))}"'
            lines.append(
                f'    <{types[kind]} name={quoteattr(variable)} valueReference="{reference}" '
                f'causality="{causality}" variability="discrete"{unit}{value}>{dimension}</{types[kind]}>'
            )
    for number, (variable, start_value) in enumerate(parameters.items()):
        lines.append(
            f'    <Float64 name={quoteattr(variable)} valueReference="{FIRST_PARAMETER + number}" '
            f'causality="parameter" variability="fixed"{_unit(variable)} start="{start_value!r}"/>'
        )
    outputs = [reference for _, _, causality, reference, _ in (*FOURFOLD, *SINGLE) if causality == "output"]
    return "\n".join(
        [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<fmiModelDescription fmiVersion="3.0" modelName={quoteattr(name)} instantiationToken="{token}" '
            'variableNamingConvention="structured">',
            f'  <CoSimulation modelIdentifier={quoteattr(name)} fixedInternalStepSize="0.01"/>',
            UNIT_DEFINITIONS,
            '  <DefaultExperiment startTime="0" stepSize="0.01"/>',
            "  <ModelVariables>",
            *lines,
            "  </ModelVariables>",
            "  <ModelStructure>",
            *(f'    <Output valueReference="{reference}"/>' for reference in outputs),
            *(f'    <InitialUnknown valueReference="{reference}"/>' for reference in outputs),
            "  </ModelStructure>",
            "</fmiModelDescription>\n",
        ]
    )


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit("usage: python build.py FOLDER")
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    source = HERE / "example_controller.c"
    print(library([source], folder / f"example_controller{fmpy.sharedLibraryExtension}"))
    for version in (2, 3):
        print(fmu(version, source, f"example_controller_fmi{version}", folder))


if __name__ == "__main__":
    main()
