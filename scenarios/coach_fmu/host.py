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
from functools import cache
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
        references, kind = _places(name)
        values: list[Any] = getattr(self.calls, f"get{TYPES[self.fmi][kind]}")(references)
        return values

    def set(self, name: str, values: Sequence[Any]) -> None:
        """Set the variable of that name, or `name[1]`, `name[2]` ..."""
        references, kind = _places(name)
        getattr(self.calls, f"set{TYPES[self.fmi][kind]}")(references, values)


@cache
def _places(name: str) -> tuple[range, str]:
    places = slice_of(VARIABLES, name)
    return range(places.start, places.stop), VARIABLES[places.start].kind


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
    begin_s = time.perf_counter()
    for tick in range(ticks + 1):
        for name, row in rows.items():
            row.append(coach.get(name))
        if tick == ticks:
            break
        if tick % every == 0:
            coach.set("valve_command", output.valve.tolist())
            coach.set("sand", output.sand.tolist())
            coach.set("track_brake", [output.track_brake])
            speeds = np.array(coach.get("axle_speed_mps"))
            valid = np.array(coach.get("axle_speed_valid"), dtype=np.bool_)
            (demand,) = coach.get("demand_in_force")
            output = controller.step(rows["time"][-1][0], speeds, valid, demand, 1, math.nan)
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
