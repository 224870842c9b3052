"""modelDescription.xml of the coach's FMU, for FMI 2.0 and 3.0."""

from importlib.metadata import version
from typing import Literal
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from scenarios.coach_fmu.variables import VARIABLES, Variable, interface_digest
from scenarios.schema import TICK_S, Scenario

FmiVersion = Literal[2, 3]

IDENTIFIER = "railslide_coach"
"""Name of the shared library."""

UNITS: dict[str, dict[str, str]] = {
    "1": {},
    "s": {"s": "1"},
    "m": {"m": "1"},
    "m/s": {"m": "1", "s": "-1"},
    "m/s2": {"m": "1", "s": "-2"},
    "rad/s": {"rad": "1", "s": "-1"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "bar": {"kg": "1", "m": "-1", "s": "-2", "factor": "1e5"},
    "degC": {"K": "1", "offset": "273.15"},
}
"""Unit -> its SI base units."""

TYPES = {2: {"real": "Real", "integer": "Integer", "boolean": "Boolean"},
         3: {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}}  # fmt: skip


def model_description(scenario: Scenario, fmi: FmiVersion) -> bytes:
    """The XML document. No output depends on inputs of the same instant: what is set acts from there on."""
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{fmi}.0",
            "modelName": f"railslide coach, {scenario.name}",
            "guid" if fmi == 2 else "instantiationToken": interface_digest(),
            "description": f"Coach on the line of the scenario {scenario.name}; needs a Python with railslide",
            "generationTool": f"railslide {version('railslide')}",
            "variableNamingConvention": "structured",
        },
    )
    kind_of_fmu = {
        "modelIdentifier": IDENTIFIER,
        "needsExecutionTool": "true",
        "canHandleVariableCommunicationStepSize": "true",
    }
    if fmi == 2:
        kind_of_fmu["canNotUseMemoryManagementFunctions"] = "true"
    else:
        kind_of_fmu["fixedInternalStepSize"] = f"{TICK_S:g}"
    SubElement(root, "CoSimulation", kind_of_fmu)
    units = SubElement(root, "UnitDefinitions")
    for name, base in UNITS.items():
        SubElement(SubElement(units, "Unit", {"name": name}), "BaseUnit", base)
    SubElement(SubElement(root, "LogCategories"), "Category", {"name": "logStatusError"})
    experiment = {"startTime": "0", "stopTime": f"{scenario.simulation.longest_s:g}", "stepSize": f"{TICK_S:g}"}
    SubElement(root, "DefaultExperiment", experiment)
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(VARIABLES):
        (_scalar_2 if fmi == 2 else _scalar_3)(variables, variable, reference)
    _structure(SubElement(root, "ModelStructure"), fmi)
    ElementTree.indent(root)
    document: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return document


def _common(variable: Variable, reference: int) -> dict[str, str]:
    common = {"name": variable.name, "valueReference": str(reference), "causality": variable.causality}
    if variable.causality == "parameter":
        common["variability"] = "fixed"
    elif variable.causality != "independent":
        common["variability"] = "discrete"  # everything is sampled at the ticks
    return {**common, "description": variable.description}


def _value(variable: Variable) -> dict[str, str]:
    """Unit, range and start, whose text depends on the type."""
    value = {"unit": variable.unit} if variable.unit else {}
    if variable.range is not None:
        value["min"], value["max"] = (_text(variable, limit) for limit in variable.range)
    if variable.start is not None:
        value["start"] = _text(variable, variable.start)
    return value


def _text(variable: Variable, number: float) -> str:
    if variable.kind == "boolean":
        return "true" if number else "false"
    return f"{number:g}"


def _scalar_2(variables: Element, variable: Variable, reference: int) -> None:
    scalar = SubElement(variables, "ScalarVariable", _common(variable, reference))
    SubElement(scalar, TYPES[2][variable.kind], _value(variable))


def _scalar_3(variables: Element, variable: Variable, reference: int) -> None:
    SubElement(variables, TYPES[3][variable.kind], {**_common(variable, reference), **_value(variable)})


def _structure(structure: Element, fmi: FmiVersion) -> None:
    outputs = [k for k, variable in enumerate(VARIABLES) if variable.causality == "output"]
    if fmi == 2:  # counts the variables from 1
        for section in ("Outputs", "InitialUnknowns"):
            unknowns = SubElement(structure, section)
            for k in outputs:
                SubElement(unknowns, "Unknown", {"index": str(k + 1), "dependencies": ""})
        return
    for section in ("Output", "InitialUnknown"):
        for k in outputs:
            SubElement(structure, section, {"valueReference": str(k), "dependencies": ""})
