"""A controller from an FMU (FMI 2.0 or 3.0, co-simulation) through fmpy, in the process that was started for it.

At tick k the inputs are set, one fmi*DoStep over the period follows, then the outputs are read: they act from k+1 on,
as they should. Inputs and outputs are found by the names of `wsp.foreign.signals`: as scalars `valve[1]` .. `valve[4]`,
or, in FMI 3, as one array `valve` of four.
"""

import difflib
import importlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from wsp.foreign.errors import UnusableController
from wsp.foreign.frames import Input, Output
from wsp.foreign.signals import AXLES, INPUTS, OUTPUTS, Signal

_REAL = {"Real", "Float64", "Float32"}
_SIGNED = {"Integer", "Int8", "Int16", "Int32", "Int64"}
_WHOLE = {*_SIGNED, "UInt8", "UInt16", "UInt32", "UInt64", "Enumeration"}
# places of the outputs among their values
_VALVE, _SAND, _TRACK_BRAKE, _REFERENCE = slice(0, 4), slice(4, 8), 8, 9
_WARNING = 1
_FITTING = {"real": _REAL, "sign": _REAL | _SIGNED, "code": _REAL | _WHOLE, "flag": _REAL | _WHOLE | {"Boolean"}}


@dataclass
class _Group:
    """Variables of one type that are passed by one call; `slots` are the places of their values among the signals."""

    type: str
    slots: list[int] = field(default_factory=list)
    references: list[int] = field(default_factory=list)


class FmuController:
    """An instance of the FMU, which is unpacked into `folder`."""

    def __init__(
        self,
        file: str,
        folder: str,
        period_s: float,
        parameters: Mapping[str, float | str],
        names: Mapping[str, str],
    ) -> None:
        """`names`: signal -> what the FMU calls it. Raises UnusableController."""
        try:
            import fmpy
        except ImportError as error:
            raise UnusableController(
                f"needs the package fmpy ({error}): pip install 'railslide[fmu]' brings it"
            ) from None
        try:
            fmpy.extract(file, folder)
            description = fmpy.read_model_description(folder)
        except Exception as error:  # fmpy, zipfile and lxml raise of many kinds
            raise UnusableController(f"cannot be read as an FMU: {error}") from None
        if description.coSimulation is None:
            raise UnusableController("is no co-simulation FMU: export it as one")
        self._three = description.fmiVersion.startswith("3.")
        if not (self._three or description.fmiVersion == "2.0"):
            raise UnusableController(f"is of FMI version {description.fmiVersion}: must be 2.0 or 3.0")
        variables = {variable.name: variable for variable in description.modelVariables}
        self._period_s = period_s
        self._started = False
        known = {signal.name for signal in (*INPUTS, *OUTPUTS)}
        for name in names:
            if name.partition("[")[0] not in known:
                raise UnusableController(
                    f"parameters.variables.{name}: no such signal; there are: {', '.join(sorted(known))}"
                )
        inputs = _connect(INPUTS, names, variables, ("input",))
        outputs = _connect(OUTPUTS, names, variables, ("output", "local"))
        settable = {name: v for name, v in variables.items() if v.causality in ("parameter", "input")}
        fed = {reference for group in inputs for reference in group.references}
        idle = [n for n, v in settable.items() if v.causality == "input" and v.valueReference not in fed]
        unset = [name for name in idle if name not in parameters]
        if unset:
            raise UnusableController(
                f"has inputs that nothing feeds ({', '.join(unset)}): "
                "say in parameters.variables which signals they are, or give them values in parameters"
            )
        free = [name for name in settable if name in idle or settable[name].causality == "parameter"]
        for name, value in parameters.items():
            if name not in free:
                raise UnusableController(f"parameters.{name} = {value!r}: the FMU has {_neighbours(name, free)}")
        self._instance = self._instantiate(fmpy, description, folder)
        self._parameters = [(settable[name], name, value) for name, value in parameters.items()]
        self._set_parameters()
        self._write = [self._writer(group) for group in inputs]
        self._read = [self._reader(group) for group in outputs]

    def reset(self, t_s: float, direction: int) -> None:
        instance = self._instance
        if self._started:
            instance.reset()
            self._set_parameters()
        self._started = True
        if self._three:
            instance.enterInitializationMode(startTime=t_s)
        else:
            instance.setupExperiment(startTime=t_s)
            instance.enterInitializationMode()
        instance.exitInitializationMode()

    def step(self, given: Input, answer: Output) -> None:
        values = (
            *given.axle_speed_mps,
            *given.valid,
            given.demand,
            given.direction,
            given.outside_reference_mps,
        )
        for write in self._write:
            write(values)
        ended = self._instance.doStep(given.t_s, self._period_s)
        if ended is not None and (ended[1] or ended[2]):
            raise RuntimeError("fmi3DoStep returned early or asked to end the simulation")
        found: list[Any] = [0] * _REFERENCE
        found.append(answer.reference_speed_mps)
        for read in self._read:
            read(found)
        answer.valve[:] = found[_VALVE]
        answer.sand[:] = found[_SAND]
        answer.track_brake = found[_TRACK_BRAKE]
        answer.reference_speed_mps = found[_REFERENCE]

    def end(self) -> None:
        if self._started:
            self._instance.terminate()
        self._instance.freeInstance()

    def _instantiate(self, fmpy: Any, description: Any, folder: str) -> Any:
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        if "c-code" in (platforms := fmpy.supported_platforms(folder)) and len(platforms) == 1:
            raise UnusableController("holds C sources alone: compile it first, as with `python -m fmpy compile`")
        try:
            instance = (FMU3Slave if self._three else FMU2Slave)(
                guid=description.guid,
                modelIdentifier=description.coSimulation.modelIdentifier,
                unzipDirectory=folder,
                instanceName="controller",
            )
            instance.instantiate()
        except Exception as error:
            raise UnusableController(f"cannot be instantiated on {fmpy.platform_tuple}: {error}") from None
        return instance

    def _set_parameters(self) -> None:
        for variable, name, value in self._parameters:
            kind = variable.type
            wanted = str if kind == "String" else (bool, int, float)
            if not isinstance(value, wanted) or (kind in _WHOLE and value != int(value)):
                raise UnusableController(f"parameters.{name} = {value!r}: the FMU has a parameter of type {kind} there")
            converted = int(value) if kind in _WHOLE else value
            getattr(self._instance, f"set{self._access(kind)}")([variable.valueReference], [converted])

    def _access(self, kind: str) -> str:
        """The part of the function's name in fmi*Get..., fmi*Set... of a type."""
        if kind == "Enumeration":
            return "Int64" if self._three else "Integer"
        return kind

    def _prepared(self, verb: str, group: _Group) -> tuple[Callable[[], None], Any]:
        """A call of fmi*Get... or fmi*Set... for a group, and the C array with its values.

        The function is the one that fmpy has found in the library, without its wrapper: this is done at every tick.
        """
        prefix = "fmi3" if self._three else "fmi2"
        types = importlib.import_module(f"fmpy.{prefix}")
        name = f"{prefix}{verb}{self._access(group.type)}"
        function = getattr(self._instance.dll, name)
        references = (getattr(types, f"{prefix}ValueReference") * len(group.references))(*group.references)
        values = (getattr(types, f"{prefix}{self._access(group.type)}") * len(group.slots))()
        lengths = (len(references), values, len(values)) if self._three else (len(references), values)
        arguments = (self._instance.component, references, *lengths)

        def call() -> None:
            status = function(*arguments)
            if status > _WARNING:
                raise RuntimeError(f"{name} failed with status {status}")

        return call, values

    def _writer(self, group: _Group) -> Callable[[tuple[float, ...]], None]:
        call, values = self._prepared("Set", group)
        slots = tuple(group.slots)

        def write(given: tuple[float, ...]) -> None:
            values[:] = [given[slot] for slot in slots]
            call()

        return write

    def _reader(self, group: _Group) -> Callable[[list[Any]], None]:
        call, values = self._prepared("Get", group)
        slots = tuple(group.slots)
        codes = [slot for slot in slots if slot != _REFERENCE] if group.type in _REAL else []

        def read(found: list[Any]) -> None:
            call()
            for slot, value in zip(slots, values, strict=True):
                found[slot] = value
            for slot in codes:  # commands that the FMU has as real numbers
                found[slot] = _whole(slot, found[slot])

        return read


def _whole(slot: int, value: float) -> int:
    if not (abs(value) < 1e6 and value == int(value)):
        signal = "valve" if slot < _SAND.start else "sand" if slot < _TRACK_BRAKE else "track_brake"
        raise RuntimeError(
            f"gave {signal}{f'[{slot % AXLES + 1}]' if slot < _TRACK_BRAKE else ''} = {value}: must be a whole number"
        )
    return int(value)


def _connect(
    signals: Iterable[Signal], names: Mapping[str, str], variables: Mapping[str, Any], causalities: tuple[str, ...]
) -> list[_Group]:
    """The variables of the FMU that carry the signals, grouped by type; UnusableController if one is not there."""
    groups: dict[str, _Group] = {}
    slot = 0
    for signal in signals:
        for variable, slots in _carriers(signal, slot, names, variables):
            if variable.causality not in causalities:
                raise UnusableController(
                    f"has {variable.name} as {variable.causality}: must be of causality {' or '.join(causalities)}"
                )
            if variable.type not in _FITTING[signal.kind]:
                fitting = ", ".join(sorted(_FITTING[signal.kind]))
                raise UnusableController(f"has {variable.name} of type {variable.type}: must be one of {fitting}")
            group = groups.setdefault(variable.type, _Group(variable.type))
            group.references.append(variable.valueReference)
            group.slots.extend(slots)
        slot += signal.size
    return list(groups.values())


def _carriers(
    signal: Signal, slot: int, names: Mapping[str, str], variables: Mapping[str, Any]
) -> list[tuple[Any, list[int]]]:
    """The variables of one signal, each with the places of its values."""
    base = names.get(signal.name, signal.name)
    slots = list(range(slot, slot + signal.size))
    whole = variables.get(base)
    if signal.size > 1 and whole is not None and whole.dimensions:
        if [str(dimension.start) for dimension in whole.dimensions] != [str(signal.size)]:
            raise UnusableController(f"has {base} as an array of another shape: must have {signal.size} elements")
        return [(whole, slots)]
    wanted = [base]
    if signal.size > 1:
        wanted = [names.get(f"{signal.name}[{i}]", f"{base}[{i}]") for i in range(1, signal.size + 1)]
    there = [name for name in wanted if name in variables]
    mapped = any(name.partition("[")[0] == signal.name for name in names)
    if len(there) == len(wanted):
        return [(variables[name], [at]) for name, at in zip(wanted, slots, strict=True)]
    if there or mapped or signal.needed:
        missing = ", ".join(name for name in wanted if name not in variables)
        raise UnusableController(
            f"has no variable {missing}: rename it, or say in parameters.variables what the FMU calls {signal.name}"
        )
    return []


def _neighbours(name: str, names: list[str]) -> str:
    near = difflib.get_close_matches(name, names, n=3)
    if near:
        return f"no parameter of that name, best matches are {', '.join(near)}"
    return f"no parameter of that name (there are: {', '.join(names) or 'none'})"
