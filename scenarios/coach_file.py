"""A coach by itself, without a scenario: a preset or a file of the same form, with settings laid over it."""

from collections.abc import Sequence
from pathlib import Path

from scenarios.errors import BadInput, Fault
from scenarios.faults import table_fault, validate_section
from scenarios.layers import Layer, Merged, parse_setting
from vehicle import CoachParameters
from vehicle.linear import polach_contact

SECTION = "coach"


def load_coach(name_or_path: str, settings: Sequence[str] = ()) -> CoachParameters:
    """The coach of that preset or file; `settings` are keys of the coach, with or without `coach.` before them.

    Raises BadInput with every fault that is found.
    """
    merged = Merged()
    merged.add(Layer({SECTION: {"preset": name_or_path}}, "", Path()))
    faults: list[Fault] = []
    for setting in settings:
        try:
            tree = parse_setting(setting if setting.startswith(f"{SECTION}.") else f"{SECTION}.{setting}")
            if "preset" in tree[SECTION]:
                raise BadInput(Fault("--set", setting, "the preset is the argument of the command"))
            merged.add(Layer(tree, "--set", Path()))
        except BadInput as error:
            faults.extend(error.faults)
    faults.extend(merged.expand_presets())
    if faults:
        raise BadInput(*faults)
    coach = validate_section(CoachParameters, merged.tree[SECTION], (SECTION,), merged, faults)
    if coach is None or faults:
        raise BadInput(*faults)
    try:
        polach_contact(coach).constants  # noqa: B018 - whether the profiles can be read and fit each other
    except ValueError as error:
        raise BadInput(table_fault(merged, (SECTION,), str(error))) from None
    return coach
