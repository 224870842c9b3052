"""Test programmes: which stops there are, as settings over one base scenario; read from TOML and validated."""

import fnmatch
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from scenarios.errors import BadInput, Fault
from scenarios.faults import validate_section
from scenarios.layers import Merged, read_toml
from scenarios.names import nearest
from scenarios.scenario_file import load_scenario, locate
from scenarios.schema import Scenario
from scenarios.units import KMH_PER_MPS
from scenarios.wsp_test.scorecard import ScoringParameters

PROGRAMME = Path(__file__).with_name("programme.toml")
NAME = r"^[A-Za-z0-9][A-Za-z0-9_.+-]*$"
DRY_CONTROLLER = "none"
"""What brakes in the dry reference: nothing, so that no controller can make its own stops look short."""


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class ProgrammeHead(_Section):
    """[programme]: what all stops share."""

    name: str = Field(pattern=NAME, max_length=60)
    title: str = ""
    scenario: str = Field(description="base of every stop: a built-in scenario, or a path relative to this file")
    run_in_s: float = Field(
        default=2.0, ge=0.2, le=600.0, description="rolling from the start to where the driver first brakes"
    )
    dry: tuple[str, ...] = Field(description="settings of the dry reference, in place of those of the stop")


class Group(_Section):
    """A group of stops, such as all on low adhesion."""

    title: str
    limits: tuple[str, ...] = Field(description="limit groups of its stops, unless a stop names its own")


class StopEntry(_Section):
    """One stop: speed, load of the coach (`coach.load`), and its settings over the base, each as in `--set`."""

    name: str = Field(pattern=NAME, max_length=60)
    group: str
    speed_kmh: float = Field(gt=0.0, le=400.0)
    load: str = Field(pattern=NAME, max_length=60)
    settings: tuple[str, ...] = ()
    run_in_s: float | None = Field(default=None, ge=0.2, le=600.0)
    limits: tuple[str, ...] | None = None
    compares_with_dry: bool = Field(default=True, description="whether its distance may be put beside the dry one")


class ProgrammeFile(_Section):
    """The whole file."""

    programme: ProgrammeHead
    scoring: ScoringParameters = ScoringParameters()
    groups: dict[str, Group] = Field(min_length=1)
    stops: tuple[StopEntry, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _names_fit(self) -> Self:
        seen: set[str] = set()
        for k, stop in enumerate(self.stops):
            if stop.name in seen:
                raise ValueError(f"stops.{k}.name = {stop.name!r}: is the name of an earlier stop as well")
            seen.add(stop.name)
            if stop.group not in self.groups:
                raise ValueError(f"stops.{k}.group = {stop.group!r}: no such group; there are {', '.join(self.groups)}")
            if stop.name in self.groups:
                raise ValueError(f"stops.{k}.name = {stop.name!r}: is the name of a group as well")
            if stop.name.startswith("dry-reference-"):
                raise ValueError(f"stops.{k}.name = {stop.name!r}: dry-reference- begins the names of dry references")
        return self


@dataclass(frozen=True)
class Stop:
    """A stop ready to run anywhere: everything that a scenario is loaded from, and what it is compared with."""

    name: str
    group: str
    source: str
    scenario: str
    settings: tuple[str, ...]
    run_in_s: float
    scoring: ScoringParameters
    limits: tuple[str, ...]
    dry: str | None
    compares_with_dry: bool

    def load(self) -> Scenario:
        """The scenario, with the coach placed `run_in_s` before the driver's first brake phase.

        Raises BadInput, which names programme and stop.
        """
        try:
            scenario = load_scenario(self.scenario, self.settings)
            return self._placed(scenario)
        except BadInput as error:
            where = f"{self.source}: {self.name}"
            raise BadInput(
                *(replace(fault, source=where) if fault.source == "--set" else fault for fault in error.faults)
            ) from None

    def _placed(self, scenario: Scenario) -> Scenario:
        phases = scenario.driver.phases
        brakes = [phase.from_m for phase in phases if phase.action == "brake" and phase.from_m is not None]
        if not brakes:
            raise BadInput(Fault("--set", "driver.phases", "nobody brakes in this stop"))
        start_m = brakes[0] - self.run_in_s * scenario.simulation.initial_speed_kmh / KMH_PER_MPS
        reach_m = 0.5 * (scenario.coach.bogie_distance_m + scenario.coach.wheelbase_m)
        if start_m < reach_m:
            message = (
                f"the coach would start at {start_m:.1f} m, where not all of it is on the track ({reach_m:.1f} m on); "
                f"the driver first brakes at {brakes[0]} m"
            )
            raise BadInput(Fault("--set", f"run_in_s = {self.run_in_s}", message))
        simulation = scenario.simulation.model_copy(update={"initial_position_m": start_m})
        return scenario.model_copy(update={"simulation": simulation})


@dataclass(frozen=True)
class Programme:
    """The stops of a programme for one controller, and the dry references that they need."""

    name: str
    title: str
    source: str
    groups: dict[str, str]
    stops: tuple[Stop, ...]
    dry_references: tuple[Stop, ...]

    def only(self, patterns: Sequence[str]) -> "Programme":
        """The stops whose name or group matches one of the `patterns` (shell wildcards), with their dry references.

        Raises BadInput for a pattern that matches nothing.
        """
        faults = []
        chosen: set[str] = set()
        names = [*self.groups, *(stop.name for stop in self.stops)]
        for pattern in patterns:
            found = {s.name for s in self.stops if any(fnmatch.fnmatchcase(n, pattern) for n in (s.name, s.group))}
            if not found:
                best = nearest(pattern, names)
                hint = f"; did you mean {' or '.join(best)}?" if best else f"; groups are {', '.join(self.groups)}"
                faults.append(Fault("--only", pattern, f"no group and no stop of this name{hint}"))
            chosen |= found
        if faults:
            raise BadInput(*faults)
        stops = tuple(stop for stop in self.stops if stop.name in chosen)
        needed = {stop.dry for stop in stops}
        return replace(self, stops=stops, dry_references=tuple(d for d in self.dry_references if d.name in needed))


def load_programme(path: Path, controller: str, settings: Sequence[str]) -> Programme:
    """The programme of a file for a `controller`, with the user's `settings` laid over every stop.

    Settings of the controller do not reach the dry references, in which nothing but the brake works.
    Raises BadInput with every fault of the file; the stops themselves are checked by `Stop.load`.
    """
    tree = read_toml(path)
    merged = Merged(tree, {(): str(path)})
    faults: list[Fault] = []
    built = validate_section(ProgrammeFile, tree, (), merged, faults)
    if built is None or faults:
        raise BadInput(*faults)
    head = built.programme
    base = str(path.parent / head.scenario) if head.scenario.endswith(".toml") else str(locate(head.scenario))
    stops, dry = [], {}
    for entry in built.stops:
        start = (f"simulation.initial_speed_kmh={entry.speed_kmh}", f"coach.load={entry.load}")
        reference = f"dry-reference-{entry.speed_kmh:g}-{entry.load}"
        common = Stop(
            name=entry.name,
            group=entry.group,
            source=str(path),
            scenario=base,
            settings=(
                *start,
                *entry.settings,
                f"scenario.name={entry.name}",
                f"wsp.controller={controller}",
                *settings,
            ),
            run_in_s=head.run_in_s if entry.run_in_s is None else entry.run_in_s,
            scoring=built.scoring,
            limits=built.groups[entry.group].limits if entry.limits is None else entry.limits,
            dry=reference,
            compares_with_dry=entry.compares_with_dry,
        )
        stops.append(common)
        elsewhere = [setting for setting in settings if not setting.lstrip().startswith("wsp.")]
        dry[reference] = replace(
            common,
            name=reference,
            group="dry-reference",
            settings=(*start, *elsewhere, *head.dry, f"scenario.name={reference}", f"wsp.controller={DRY_CONTROLLER}"),
            run_in_s=head.run_in_s,
            limits=(),
            dry=None,
        )
    titles = {name: group.title for name, group in built.groups.items()}
    return Programme(head.name, head.title, str(path), titles, tuple(stops), tuple(dry.values()))
