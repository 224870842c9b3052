"""Scenario files: found, read, laid over each other, validated, and written back with nothing left implicit."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, get_type_hints

import tomli_w
from pydantic import BaseModel

from scenarios.cosimulation.fault_entries import FAULT_KINDS, FaultEntry
from scenarios.errors import BadInput, Fault
from scenarios.faults import table_fault, unknown_key, validate_section
from scenarios.layers import Layer, Merged, Tree, parse_setting, read_toml
from scenarios.names import UnknownName, display_name, find_class, find_creep_law, find_file
from scenarios.relative_paths import anchor_paths, table_of
from scenarios.schema import TICK_S, Scenario
from sensors import Imu

COMPOSED = ("creep_law", "wsp", "faults", "estimators")
"""Sections whose models depend on names in them."""

PLAIN_MODELS: dict[str, type[BaseModel]] = {
    section: model
    for section, model in get_type_hints(Scenario).items()
    if section in Scenario.model_fields and section not in (*COMPOSED, "presets")
}
SECTIONS = (*PLAIN_MODELS, *COMPOSED)


def load_scenario(name_or_path: str | Path, settings: Sequence[str] = ()) -> Scenario:
    """The scenario of that name or file, with `section.key=value` settings laid over it.

    Raises BadInput with every fault that is found.
    """
    path = locate(str(name_or_path))
    merged = Merged()
    merged.origins[()] = str(path)
    for layer in _file_layers(path):
        merged.add(layer)
    merged.tree.setdefault("scenario", {})
    if isinstance(merged.tree["scenario"], dict):
        merged.tree["scenario"].setdefault("name", path.stem)
    faults: list[Fault] = []
    for setting in settings:
        try:
            tree = parse_setting(setting)
            if "extends" in table_of(tree, "scenario"):
                raise BadInput(Fault("--set", setting, "extends belongs in a file"))
            merged.add(_prepared(Layer(tree, "--set", Path())))
        except BadInput as error:
            faults.extend(error.faults)
    faults.extend(merged.expand_presets())
    scenario = _validated(merged, faults)
    if scenario is None or faults:
        raise BadInput(*faults)
    return scenario


def locate(name_or_path: str) -> Path:
    """The file of a built-in scenario's name or of a path to a .toml file."""
    looks_like_path = name_or_path.endswith(".toml") or "/" in name_or_path or "\\" in name_or_path
    if looks_like_path or Path(name_or_path).exists():
        return Path(name_or_path)
    try:
        return find_file("scenario", name_or_path)
    except UnknownName as error:
        raise BadInput(Fault("", "", f"{error}; a file of your own ends in .toml")) from None


def dump_scenario(scenario: Scenario) -> str:
    """The scenario as TOML with every parameter explicit; loading it gives the same scenario."""
    tree = scenario.model_dump(mode="json", exclude_none=True, exclude={"presets"})
    estimators = tree.pop("estimators")
    tree["estimators"] = {"names": estimators["names"], **estimators["parameters"]}
    return tomli_w.dumps(tree)


def _file_layers(path: Path) -> list[Layer]:
    """The file and what it extends, the farthest ancestor first."""
    layers: list[Layer] = []
    seen: list[Path] = []
    while True:
        if path.resolve() in seen:
            chain = " -> ".join(str(file) for file in [*seen, path.resolve()])
            raise BadInput(Fault(str(path), "scenario.extends", f"goes in a circle: {chain}"))
        seen.append(path.resolve())
        layer = _prepared(Layer(read_toml(path), str(path), path.parent))
        head = table_of(layer.tree, "scenario")
        _refuse_misplaced_extends(layer)
        parent = head.pop("extends", None)
        if layers:  # name and title belong to the file itself
            head.pop("name", None)
            head.pop("title", None)
        layers.insert(0, layer)
        if parent is None:
            return layers
        if not isinstance(parent, str):
            raise BadInput(Fault(str(path), f"scenario.extends = {parent!r}", "must be a scenario's name or a path"))
        try:
            path = layer.folder / parent if parent.endswith(".toml") else find_file("scenario", parent)
        except UnknownName as error:
            raise BadInput(Fault(str(path), "scenario.extends", str(error))) from None


def _refuse_misplaced_extends(layer: Layer) -> None:
    """A file whose `extends` stands elsewhere extends nothing: every key that it counts on would be told as missing."""
    if "extends" in table_of(layer.tree, "scenario"):
        return
    for section in ("", *layer.tree):
        table = table_of(layer.tree, section) if section else layer.tree
        if "extends" in table:
            key = f"{section}.extends" if section else "extends"
            raise BadInput(Fault(layer.source, f"{key} = {table['extends']!r}", "belongs in the table [scenario]"))


def _prepared(layer: Layer) -> Layer:
    """`seed` stands for both seeds; relative paths of a user's files count from the layer's folder."""
    head = table_of(layer.tree, "scenario")
    if "seed" in head:
        seed = head.pop("seed")
        head.setdefault("world_seed", seed)
        head.setdefault("sensor_seed", seed)
    anchor_paths(layer.tree, layer.folder)
    return layer


def _validated(merged: Merged, faults: list[Fault]) -> Scenario | None:
    faults.extend(unknown_key(merged, (section,), SECTIONS) for section in merged.tree if section not in SECTIONS)
    built: dict[str, Any] = {}
    for section, model in PLAIN_MODELS.items():
        if section not in merged.without_preset:  # without its preset a section would only lack keys
            built[section] = validate_section(model, merged.tree.get(section, {}), (section,), merged, faults)
    built["creep_law"] = _creep_law(merged, faults)
    built["wsp"] = _wsp(merged, faults)
    built["estimators"] = _estimators(merged, faults)
    built["faults"] = _fault_entries(merged, faults)
    if faults:
        return None
    scenario = Scenario(**built, presets=merged.presets)
    faults.extend(_contradictions(scenario, merged))
    return scenario


def _contradictions(scenario: Scenario, merged: Merged) -> Iterator[Fault]:
    """What is right by itself but not together."""
    from scenarios.cosimulation.line import Line  # brings compiled code along, which only a valid scenario needs

    simulation = scenario.simulation
    try:
        line = Line(scenario)
    except ValueError as error:
        # wheel_rail knows contact and irregularities, but not the sections in which they stand
        sections = {"contact.": "coach.", "irregularities.": "track."}
        within = next((section for key, section in sections.items() if str(error).startswith(key)), "")
        yield table_fault(merged, (), f"{within}{error}")
    else:
        first_m, last_m = line.places_m
        if not first_m <= simulation.initial_position_m <= last_m:
            source = merged.origin(("simulation", "initial_position_m"))
            key = f"simulation.initial_position_m = {simulation.initial_position_m}"
            yield Fault(source, key, f"the whole coach must stand on the track: {first_m} to {last_m} m")
    try:
        _ = scenario.brake_at_load
    except ValueError as error:
        yield table_fault(merged, ("brake",), str(error))
    yield from _controller_faults(scenario, merged)
    reference = scenario.wsp.reference_estimator
    if reference is not None and reference not in scenario.estimators.names:
        key = f"wsp.reference_estimator = {reference!r}"
        must = f"must be one of estimators.names ({', '.join(scenario.estimators.names) or 'none'})"
        yield Fault(merged.origin(("wsp", "reference_estimator")), key, must)
    shown = [display_name(name) for name in scenario.estimators.names]
    if len(set(shown)) < len(shown):
        key = f"estimators.names = {list(scenario.estimators.names)!r}"
        yield Fault(merged.origin(("estimators", "names")), key, "two classes of one name: tables and files need two")
    try:
        Imu(scenario.imu, simulation.record_period_s, scenario.scenario.sensor_seed)
    except ValueError as error:
        yield table_fault(merged, (), f"{error} (simulation.record_period_s = {simulation.record_period_s})")


def _controller_faults(scenario: Scenario, merged: Merged) -> Iterator[Fault]:
    """What shows when the controller is made: a foreign one is loaded, and a recorded one read."""
    try:
        period_s = getattr(scenario.make_controller(), "period_s", None)
    except ValueError as error:
        yield table_fault(merged, ("wsp",), str(error))
        return
    ticks = period_s / TICK_S if isinstance(period_s, int | float) else 0.0
    if round(ticks) < 1 or abs(ticks - round(ticks)) > 1e-9:
        key = f"wsp.controller = {scenario.wsp.controller!r}"
        must = f"its period_s = {period_s} must be a whole multiple of {TICK_S}"
        yield Fault(merged.origin(("wsp", "controller")), key, must)


def _creep_law(merged: Merged, faults: list[Fault]) -> dict[str, Any] | None:
    return _named(merged, faults, "creep_law", "name", "creep law", find_creep_law)


def _wsp(merged: Merged, faults: list[Fault]) -> dict[str, Any] | None:
    find = partial(find_class, "controller")
    estimator = table_of(merged.tree, "wsp").get("reference_estimator")
    if not isinstance(estimator, str | None):
        key = f"wsp.reference_estimator = {estimator!r}"
        faults.append(Fault(merged.origin(("wsp", "reference_estimator")), key, "must be the name of an estimator"))
    return _named(merged, faults, "wsp", "controller", "controller", find, ("reference_estimator",))


def _named(
    merged: Merged,
    faults: list[Fault],
    section: str,
    key: str,
    kind: str,
    find: Callable[[str], Any],
    besides: tuple[str, ...] = (),
) -> dict[str, Any] | None:
    """A section that names something and holds the parameters of what it names, and other keys `besides`."""
    table = _section_table(merged, section, faults)
    if table is None:
        return None
    known = (key, "parameters", *besides)
    faults.extend(unknown_key(merged, (section, other), known) for other in table if other not in known)
    name = table.get(key)
    if name is None:
        faults.append(Fault(merged.origin((section,)), f"{section}.{key}", f"is missing (the name of a {kind})"))
        return None
    found = _found(kind, name, (section, key), merged, faults, find)
    if found is None:
        return None
    where = (section, "parameters")
    parameters = validate_section(found.Parameters, table.get("parameters", {}), where, merged, faults)
    return {key: name, "parameters": parameters, **{other: table[other] for other in besides if other in table}}


def _estimators(merged: Merged, faults: list[Fault]) -> dict[str, Any] | None:
    """Parameters may stand there for estimators that this run does not name; they are checked and left out."""
    table = _section_table(merged, "estimators", faults)
    if table is None:
        return None
    names = table.get("names", [])
    key = ("estimators", "names")
    if not (isinstance(names, list) and all(isinstance(name, str) for name in names)) or len(set(names)) < len(names):
        faults.append(Fault(merged.origin(key), f"estimators.names = {names!r}", "must be an array of different names"))
        return None
    parameters: dict[str, Any] = {}
    for name in dict.fromkeys([*names, *(key for key in table if key != "names")]):
        where = key if name in names else ("estimators", name)
        found = _found("estimator", name, where, merged, faults, partial(find_class, "estimator"))
        if found is not None:
            built = validate_section(found.Parameters, table.get(name, {}), ("estimators", name), merged, faults)
            if name in names:
                parameters[name] = built
    return {"names": tuple(names), "parameters": parameters}


def _fault_entries(merged: Merged, faults: list[Fault]) -> tuple[FaultEntry, ...]:
    entries = merged.tree.get("faults", [])
    if not isinstance(entries, list):
        faults.append(Fault(merged.origin(("faults",)), "faults", "must be an array of tables: [[faults]]"))
        return ()
    built = []
    for k, entry in enumerate(entries):
        kind = entry.get("kind") if isinstance(entry, dict) else None
        if kind not in FAULT_KINDS:
            key, must = f"faults.{k}.kind = {kind!r}", f"must be one of {', '.join(FAULT_KINDS)}"
            faults.append(Fault(merged.origin(("faults",)), key, must))
            continue
        built.append(validate_section(FAULT_KINDS[kind], entry, ("faults", str(k)), merged, faults))
    return tuple(entry for entry in built if entry is not None)


def _section_table(merged: Merged, section: str, faults: list[Fault]) -> Tree | None:
    table = merged.tree.get(section, {})
    if isinstance(table, dict):
        return table
    faults.append(Fault(merged.origin((section,)), section, f"must be a table: [{section}]"))
    return None


def _found(
    kind: str, name: Any, key: tuple[str, ...], merged: Merged, faults: list[Fault], find: Callable[[str], Any]
) -> Any:
    try:
        if not isinstance(name, str):
            raise UnknownName(f"must be the name of {'an' if kind[0] in 'aeiou' else 'a'} {kind}, not {name!r}")
        return find(name)
    except UnknownName as error:
        faults.append(Fault(merged.origin(key), ".".join(key), str(error)))
        return None
