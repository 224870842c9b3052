"""What the terminal shows of a run: progress while it goes, then tables of its figures."""

import time
from collections.abc import Mapping
from contextlib import AbstractContextManager
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from scenarios.interruption import Interruption
from scenarios.run import RunResult, Watcher
from scenarios.schema import Scenario
from scenarios.units import KMH_PER_MPS

REFRESH_S = 0.05
USUAL_DECELERATION_MPS2 = 0.6
"""For the progress bar alone, which guesses when the run will end."""


class TerminalWatcher(Watcher):
    """Progress bar on stderr with simulated time and speed; nothing is drawn where no terminal is."""

    def __init__(self, scenario: Scenario, interruption: Interruption, compiles: bool) -> None:
        """`compiles`: nothing has been compiled for this state of the sources, so the solve will begin late."""
        self._interruption = interruption
        self._compiles = compiles
        self._longest_s = scenario.simulation.longest_s
        self._brake_from_m = max(
            (phase.from_m for phase in scenario.driver.phases if phase.from_m is not None and phase.demand is not None),
            default=None,
        )
        console = Console(stderr=True)
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[state]}"),
            TimeElapsedColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._progress.add_task(scenario.name, total=1.0, state="")
        self._shown_at = 0.0

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._progress.stop()

    def stage(self, name: str) -> None:
        waits = name == "solve" and self._compiles
        self._progress.update(self._task, description=name, state="compiling, this once" if waits else "")

    def solving(self, t_s: float, position_m: float, speed_mps: float) -> None:
        now = time.monotonic()
        if now - self._shown_at >= REFRESH_S:
            self._shown_at = now
            share = t_s / max(t_s + self._remaining_s(t_s, position_m, speed_mps), 1e-9)
            state = f"{t_s:6.1f} s  {position_m:7.0f} m  {KMH_PER_MPS * speed_mps:6.1f} km/h"
            self._progress.update(self._task, completed=share, state=state)

    def stop_requested(self) -> bool:
        return self._interruption.requested()

    def guard(self) -> AbstractContextManager[None]:
        return self._interruption.deferred()

    def _remaining_s(self, t_s: float, position_m: float, speed_mps: float) -> float:
        """A guess: at this speed to the last brake application, then an ordinary stop, within the longest time."""
        left_s = self._longest_s - t_s
        if self._brake_from_m is None or speed_mps <= 0.0:
            return left_s
        to_brake_s = max(0.0, self._brake_from_m - position_m) / speed_mps
        return min(left_s, to_brake_s + speed_mps / USUAL_DECELERATION_MPS2)


def show_result(console: Console, scenario: Scenario, result: RunResult) -> None:
    """The tables that close a run, and where its files lie."""
    metrics = result.metrics
    console.print(scenario.scenario.title or scenario.name, style="bold", markup=False, highlight=False)
    console.print(_stop_table(metrics["stop"]))
    console.print(_wheelset_table(metrics["wheelsets"]))
    if metrics["estimators"]:
        console.print(_estimator_table(metrics["estimators"]))
    solve = metrics["solve"]
    console.print(
        f"simulated {solve['simulated_s']:.1f} s in {solve['wall_s']:.2f} s, "
        f"{solve['realtime_factor']:.0f} times real time, at a step of {1000 * solve['step_s']:g} ms",
        highlight=False,
    )
    console.print(f"run folder  {result.folder}", highlight=False, soft_wrap=True)
    for figure in result.figures:
        console.print(f"picture     {figure}", highlight=False, soft_wrap=True)


def _stop_table(stop: Mapping[str, Any]) -> Table:
    table = Table(show_header=False)
    table.add_column()
    table.add_column(justify="right")
    table.add_row("stopping distance", _number(stop["distance_m"], "{:.1f} m"))
    table.add_row("shortest possible", _number(stop["shortest_distance_m"], "{:.1f} m"))
    table.add_row("adhesion utilisation", _number(stop["adhesion_utilisation"], "{:.3f}"))
    table.add_row("air used", _number(stop["air_nl"], "{:.0f} normal litres"))
    return table


def _wheelset_table(wheelsets: list[Mapping[str, Any]]) -> Table:
    table = Table()
    table.add_column("wheelset")
    for number in range(1, len(wheelsets) + 1):
        table.add_column(str(number), justify="right")
    for label, key, form, scale in (
        ("largest slip  %", "largest_slip", "{:.1f}", 100.0),
        ("locked  s", "locked_s", "{:.2f}", 1.0),
        ("friction energy  kJ", "friction_energy_kj", "{:.0f}", 1.0),
    ):
        table.add_row(label, *(_number(wheelset[key], form, scale) for wheelset in wheelsets))
    return table


def _estimator_table(estimators: Mapping[str, Mapping[str, Any]]) -> Table:
    table = Table()
    table.add_column("estimator")
    for name in estimators:
        table.add_column(name, justify="right")
    for label, key, form, scale in (
        ("speed error, rms  km/h", "speed_rms_kmh", "{:.2f}", 1.0),
        ("speed error, largest  km/h", "speed_max_kmh", "{:.2f}", 1.0),
        ("distance error at the end  m", "distance_error_m", "{:.1f}", 1.0),
        ("time outside ETCS speed limit  %", "outside_etcs_share", "{:.1f}", 100.0),
        ("time outside ETCS distance limit  %", "outside_etcs_distance_share", "{:.1f}", 100.0),
        ("gradient error, rms  per mille", "gradient_rms_permille", "{:.2f}", 1.0),
    ):
        table.add_row(label, *(_number(figures[key], form, scale) for figures in estimators.values()))
    return table


def _number(value: float | None, form: str, scale: float = 1.0) -> str:
    return "-" if value is None else form.format(scale * value)
