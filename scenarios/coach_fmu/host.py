"""The smallest tool for the coach's FMU: an instance of it by way of fmpy, and a loop in which a controller brakes it.

The loop is that of a co-simulation master: at each communication point it reads the coach's outputs, sets as inputs
what the controller answered at the point before, and lets both work for the next step.
"""

import math
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from scenarios.coach_fmu.export import export_fmu
from scenarios.coach_fmu.model_description import IDENTIFIER, TYPES
from scenarios.coach_fmu.variables import VARIABLES, interface_digest, slice_of
from scenarios.schema import TICK_S, Scenario
from wsp import Controller, ControllerOutput


class CoachFmu:
    """An instance of the coach FMU that is unpacked in `folder`; as a context it is freed in the end.

    `messages` is what it has logged. A call that fails raises fmpy's FMICallException.
    """

    def __init__(self, folder: Path) -> None:
        """Raises RuntimeError with the FMU's message if it cannot be instantiated."""
        from fmpy import fmi2, fmi3, platform_tuple

        self.messages: list[str] = []
        self.fmi = 3 if (folder / "binaries" / platform_tuple).is_dir() else 2
        given: dict[str, Any] = {
            "guid": interface_digest(),
            "modelIdentifier": IDENTIFIER,
            "unzipDirectory": str(folder.resolve()),
        }
        if self.fmi == 3:
            self.calls: Any = fmi3.FMU3Slave(**given)
            settings = {"logMessage": lambda *said: self.messages.append(said[-1].decode())}
        else:
            self.calls = fmi2.FMU2Slave(**given)
            callbacks = fmi2.fmi2CallbackFunctions()
            callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
                lambda *said: self.messages.append(said[-1].decode().replace("%%", "%"))
            )
            settings = {"callbacks": callbacks}
        try:
            self.calls.instantiate(**settings)
        except Exception:
            raise RuntimeError("; ".join(self.messages)) from None
        self._now_s = 0.0
        self._known: dict[tuple[str, ...], list[_Group]] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.calls.freeInstance()

    def start(self, start_s: float = 0.0) -> None:
        """Build the coach and go to its first communication point."""
        if self.fmi == 3:
            self.calls.enterInitializationMode(startTime=start_s)
        else:
            self.calls.setupExperiment(startTime=start_s)
            self.calls.enterInitializationMode()
        self.calls.exitInitializationMode()
        self._now_s = start_s

    def step(self, step_s: float = TICK_S) -> None:
        """Go on to the next communication point."""
        self.calls.doStep(self._now_s, step_s)
        self._now_s += step_s

    def get(self, name: str) -> list[Any]:
        """Value of the variable of that name, or values of `name[1]`, `name[2]` ..."""
        return self.read((name,))[name]

    def read(self, names: tuple[str, ...]) -> dict[str, list[Any]]:
        """What `get` gives of each name, with one call for each type."""
        found: dict[str, list[Any]] = {}
        for group in self._groups(names):
            group.get()
            for name, places in group.places.items():
                found[name] = group.values[places]
        return found

    def set(self, name: str, values: Sequence[Any]) -> None:
        """Set the variable of that name, or `name[1]`, `name[2]` ..."""
        self.write({name: values})

    def write(self, values: dict[str, Sequence[Any]]) -> None:
        """Set several, with one call for each type."""
        for group in self._groups(tuple(values)):
            for name, places in group.places.items():
                group.values[places] = values[name]
            group.set()

    def _groups(self, names: tuple[str, ...]) -> list["_Group"]:
        """The variables of that names by type; made once, as a tool does that asks for the same at every step."""
        if names not in self._known:
            by_kind: dict[str, dict[str, slice]] = {}
            for name in names:
                places = slice_of(VARIABLES, name)
                by_kind.setdefault(VARIABLES[places.start].kind, {})[name] = places
            self._known[names] = [_Group(self.calls, self.fmi, kind, places) for kind, places in by_kind.items()]
        return self._known[names]


class _Group:
    """Variables of one type: their references, their values, the two calls of the FMU, and where each name stands."""

    def __init__(self, calls: Any, fmi: int, kind: str, variables: dict[str, slice]) -> None:
        from fmpy import fmi2, fmi3

        module = fmi2 if fmi == 2 else fmi3
        self.places: dict[str, slice] = {}
        references: list[int] = []
        for name, places in variables.items():
            self.places[name] = slice(len(references), len(references) + places.stop - places.start)
            references += range(places.start, places.stop)
        count = len(references)
        self.values = (getattr(module, f"fmi{fmi}{TYPES[fmi][kind]}") * count)()
        self._given = [
            calls.component,
            (getattr(module, f"fmi{fmi}ValueReference") * count)(*references),
            count,
            self.values,
            *([count] if fmi == 3 else []),
        ]
        self._get = getattr(calls, f"fmi{fmi}Get{TYPES[fmi][kind]}")
        self._set = getattr(calls, f"fmi{fmi}Set{TYPES[fmi][kind]}")

    def get(self) -> None:
        self._get(*self._given)

    def set(self) -> None:
        self._set(*self._given)


@dataclass(frozen=True)
class Braked:
    """What a controller made of the coach, at every communication point (n,), and how long the loop took.

    `outputs`: the recorded ones by name, (n,) or (n, axes).
    """

    t_s: np.ndarray
    outputs: dict[str, np.ndarray]
    wall_s: float

    @property
    def realtime_factor(self) -> float:
        """Simulated over wall time."""
        return float(self.t_s[-1] - self.t_s[0]) / self.wall_s


def brake(coach: CoachFmu, controller: Controller, ticks: int, record: Sequence[str] = ("true_speed_mps",)) -> Braked:
    """Let `controller` brake the coach, which has started, for so many ticks; record the outputs named."""
    controller.reset(0.0, 1)
    output = ControllerOutput()
    every = round(controller.period_s / TICK_S)
    rows: dict[str, list[list[Any]]] = {name: [] for name in ("time", *record)}
    wanted = tuple(dict.fromkeys((*rows, "axle_speed_mps", "axle_speed_valid", "demand_in_force")))
    begin_s = time.perf_counter()
    for tick in range(ticks + 1):
        seen = coach.read(wanted)
        for name, row in rows.items():
            row.append(seen[name])
        if tick == ticks:
            break
        if tick % every == 0:
            flags = {"sand": output.sand.tolist(), "track_brake": [output.track_brake]}
            coach.write({"valve_command": output.valve.tolist(), **flags})
            speeds = np.array(seen["axle_speed_mps"])
            valid = np.array(seen["axle_speed_valid"], dtype=np.bool_)
            output = controller.step(seen["time"][0], speeds, valid, seen["demand_in_force"][0], 1, math.nan)
        coach.step()
    wall_s = time.perf_counter() - begin_s
    columns = {name: np.array(row).squeeze(axis=1) if len(row[0]) == 1 else np.array(row) for name, row in rows.items()}
    return Braked(t_s=columns.pop("time"), outputs=columns, wall_s=wall_s)


@contextmanager
def timed_brake(scenario: Scenario, ticks: int) -> Iterator[Callable[[], float]]:
    """For benchmarks: a function that lets the scenario's controller brake its coach, as an FMU, for so many ticks from
    the start, and returns wall over simulated time.
    """
    from fmpy import extract

    with tempfile.TemporaryDirectory(prefix="railslide-fmu-") as name:
        file, folder = Path(name) / "coach.fmu", Path(name) / "coach"
        export_fmu(scenario, file, 2)
        extract(str(file), str(folder))
        with CoachFmu(folder) as coach:

            def once() -> float:
                coach.calls.reset()
                coach.start()
                return 1.0 / brake(coach, scenario.make_controller(), ticks).realtime_factor

            yield once
