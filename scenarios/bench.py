"""Benchmarks: how fast the program is on this machine, as medians and as ratios within one run.

Machines differ and are shared, so each figure stands beside what it is made of: the compiled force routine alone and an
interpreter loop, both measured in turn with the solves.
"""

import json
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.table import Table

from scenarios.cosimulation import Line, loop_period_s, simulate
from scenarios.errors import BadInput, Fault
from scenarios.scenario_file import load_scenario
from vehicle import Actuation, Coach
from vehicle.forces import coach_force
from vehicle.start import start_state
from wheel_rail.adhesion_state import RailTables
from wheel_rail.compiled import Array, Record, compiled

SCENARIO = "low-adhesion-stop"
STEPS_S = (0.005, 0.001)
_LOOP = 1_000_000
_FORCE_CALLS = 5_000


@dataclass(frozen=True)
class Benchmark:
    """One row: name, unit, and the value of every round."""

    name: str
    unit: str
    values: tuple[float, ...]

    @property
    def median(self) -> float:
        return statistics.median(self.values)


def run_benchmarks(rounds: int, on_round: Callable[[int], None]) -> list[Benchmark]:
    """All benchmarks, `rounds` times in turn; `on_round(k)` is told before each round."""
    scenarios = {step: load_scenario(SCENARIO, [f"simulation.step_s={step}"]) for step in STEPS_S}
    line = Line(scenarios[STEPS_S[0]])
    coach = scenarios[STEPS_S[0]].coach
    record, q, v = start_state(coach, line.contact, line.track, line.rail, 100.0, 30.0)
    arguments = (q, v, np.empty_like(q), record, line.track.table, line.rail)
    _forces(1, *arguments)
    no_actuation = Actuation()
    values: dict[tuple[str, str], list[float]] = {}

    def note(name: str, unit: str, value: float) -> None:
        values.setdefault((name, unit), []).append(value)

    for k in range(rounds):
        on_round(k)
        loop_s = _timed(_interpreter_loop) / _LOOP
        force_s = _timed(lambda: _forces(_FORCE_CALLS, *arguments)) / _FORCE_CALLS
        note("interpreter loop", "ns per turn", 1e9 * loop_s)
        note("force routine, compiled, alone", "us per call", 1e6 * force_s)
        note("force routine over interpreter loop", "ratio", force_s / loop_s)
        for step, scenario in scenarios.items():
            idle = Coach(coach, line.contact, line.track, line.rail)
            report = idle.run(
                step, 10.0, 100.0, 30.0, lambda t_s, state: no_actuation, loop_period_s(scenario.simulation)
            )
            note(f"coach alone, rolling, {1000 * step:g} ms: step", "us", 1e6 * report.wall_s / report.steps)
            truth = simulate(scenario, lambda *_: None, lambda: False)
            per_step_s = truth.solve.wall_s / (truth.solve.simulated_s / step)
            label = f"{SCENARIO}, {1000 * step:g} ms"
            note(f"{label}: solve", "times real time", truth.solve.realtime_factor)
            note(f"{label}: step", "us", 1e6 * per_step_s)
            note(f"{label}: step over force routine", "ratio", per_step_s / force_s)
            note(f"{label}: step over interpreter loop", "ratio", per_step_s / loop_s)
    return [Benchmark(name, unit, tuple(rows)) for (name, unit), rows in values.items()]


def _timed(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


@compiled
def _forces(count: int, q: Array, v: Array, f: Array, record: Record, track: Array, rail: RailTables) -> None:
    for _ in range(count):
        coach_force(q, v, f, record, track, rail)


def _interpreter_loop() -> int:
    total = 0
    for i in range(_LOOP):
        total += i
    return total


def benchmark_table(benchmarks: list[Benchmark]) -> Table:
    """Medians, and the spread that tells how far the machine was its own."""
    table = Table("benchmark", "unit")
    for heading in ("median", "least", "most"):
        table.add_column(heading, justify="right")
    for b in benchmarks:
        table.add_row(b.name, b.unit, *(f"{value:.4g}" for value in (b.median, min(b.values), max(b.values))))
    return table


def write_benchmarks(path: Path, benchmarks: list[Benchmark]) -> None:
    """JSON: name -> unit, median, all values. Raises BadInput where the file cannot be written."""
    content = {b.name: {"unit": b.unit, "median": b.median, "values": b.values} for b in benchmarks}
    try:
        path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise BadInput(Fault(str(path), "", f"cannot be written: {error.strerror}")) from None
