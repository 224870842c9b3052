"""Benchmarks: how fast the program is on this machine, as medians and as ratios within one run.

Machines differ and are shared, so each figure stands beside what it is made of: the parts of a solve alone and an
interpreter loop, all measured in turn with the solves.
"""

import json
import statistics
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from rich.table import Table

from scenarios.bench_parts import SPEED_MPS, BenchCoach
from scenarios.cosimulation.line import Line
from scenarios.cosimulation.loop import loop_period_s
from scenarios.cosimulation.simulation import simulate
from scenarios.errors import BadInput, Fault
from scenarios.scenario_file import load_scenario
from scenarios.schema import Scenario
from vehicle import Actuation, Coach

SCENARIO = "low-adhesion-stop"
STEPS_S = (0.005, 0.001)
DRY_M, RECOVERING_M = 150.0, 2000.0
"""Places on the scenario's line."""
POLACH = "eight contacts, table geometry and Polach"
RECOVERING = "eight contacts, table geometry and Polach, rail that recovers"
FASTSIM = "eight contacts, table geometry and FASTSIM 10 x 10"
COACH_FMU = "coach as an FMU, rule table in the tool: wall over simulated time"
LONG_PATH = "test path 3, 5 ms, recorded at 100 Hz: solve"
ROUGH_PATH = "test path 3, rough rails, 0.5 ms, recorded at 2 kHz: solve"
PATHS = {
    LONG_PATH: (),
    ROUGH_PATH: (
        "simulation.step_s=0.0005", "simulation.record_period_s=0.0005", "simulation.longest_s=20",
        'track.irregularities={spectrum="erri-b176-low"}',
    ),
}  # fmt: skip
"""Name of a benchmark -> settings of the path."""
AT_MOST = {POLACH: 3.0, RECOVERING: 3.0, FASTSIM: 40.0, COACH_FMU: 0.05}
"""Name of a benchmark -> what its median may reach at most, in its unit."""
AT_LEAST = {LONG_PATH: 300.0, ROUGH_PATH: 40.0, f"{SCENARIO}, 5 ms: solve": 200.0, f"{SCENARIO}, 1 ms: solve": 75.0}
"""Name of a benchmark -> what its median has to reach at least, in its unit."""
_LOOP = 1_000_000
_FMU_TICKS = 6000


@dataclass(frozen=True)
class Benchmark:
    """One row: name, unit, and the value of every round."""

    name: str
    unit: str
    values: tuple[float, ...]

    @property
    def median(self) -> float:
        return statistics.median(self.values)

    @property
    def at_most(self) -> float | None:
        """What the median may reach; None where nothing is asked."""
        return AT_MOST.get(self.name)

    @property
    def at_least(self) -> float | None:
        """What the median has to reach at least; None where nothing is asked."""
        return AT_LEAST.get(self.name)


def run_benchmarks(rounds: int, on_round: Callable[[int], None]) -> list[Benchmark]:
    """All benchmarks, `rounds` times in turn; `on_round(k)` is told before each round.

    The FMU's needs the packages of the extra `fmu` and is left out where they are missing.
    """
    with ExitStack() as stack:
        coach_fmu = None
        if find_spec("fmpy") and find_spec("ziglang"):
            from scenarios.coach_fmu.host import timed_brake

            coach_fmu = stack.enter_context(timed_brake(load_scenario(SCENARIO), _FMU_TICKS))
        return _run_benchmarks(rounds, on_round, coach_fmu)


def _run_benchmarks(
    rounds: int, on_round: Callable[[int], None], coach_fmu: Callable[[], float] | None
) -> list[Benchmark]:
    scenarios = {step: load_scenario(SCENARIO, [f"simulation.step_s={step}"]) for step in STEPS_S}
    first = scenarios[STEPS_S[0]]
    boxes = load_scenario(SCENARIO, ["coach.axle_boxes=explicit", f"simulation.step_s={STEPS_S[0]}"])
    paths = {name: load_scenario("path-03", list(settings)) for name, settings in PATHS.items()}
    line = Line(first)
    dry = BenchCoach(first, line, DRY_M)
    contacts = {
        POLACH: dry,
        RECOVERING: BenchCoach(first, line, RECOVERING_M),
        FASTSIM: BenchCoach(first, line, DRY_M, "fastsim"),
    }
    for scenario in (first, boxes):
        _idle_step_s(scenario, line, STEPS_S[0], 0.1)  # compiles
    values: dict[tuple[str, str], list[float]] = {}

    def note(name: str, unit: str, value: float) -> None:
        values.setdefault((name, unit), []).append(value)

    for k in range(rounds):
        on_round(k)
        loop_s = _timed(_interpreter_loop) / _LOOP
        note("interpreter loop", "ns per turn", 1e9 * loop_s)
        for name, sliding in contacts.items():
            contacts_s = sliding.contacts_s()
            note(name, "us", 1e6 * contacts_s)
            note(f"{name}, over interpreter loop", "ratio", contacts_s / loop_s)
        force_s = dry.force_s()
        note("force routine, compiled, alone", "us per call", 1e6 * force_s)
        note("force routine over interpreter loop", "ratio", force_s / loop_s)
        for step, scenario in scenarios.items():
            label = f"{1000 * step:g} ms"
            solver_s = dry.solver_s(step)
            note(f"Exudyn alone, {label}: step", "us", 1e6 * solver_s)
            note(f"coach alone, rolling, {label}: step", "us", 1e6 * _idle_step_s(scenario, line, step, 10.0))
            truth = simulate(scenario, lambda *_: None, lambda: False)
            per_step_s = truth.solve.wall_s / (truth.solve.simulated_s / step)
            label = f"{SCENARIO}, {label}"
            note(f"{label}: solve", "times real time", truth.solve.realtime_factor)
            note(f"{label}: step", "us", 1e6 * per_step_s)
            note(f"{label}: share of Exudyn in a step", "ratio", solver_s / per_step_s)
            note(f"{label}: step over force routine", "ratio", per_step_s / force_s)
            note(f"{label}: step over interpreter loop", "ratio", per_step_s / loop_s)
        for name, path in paths.items():
            note(name, "times real time", simulate(path, lambda *_: None, lambda: False).solve.realtime_factor)
        note(
            "coach alone, rolling, 5 ms, explicit axle boxes: step", "us", 1e6 * _idle_step_s(boxes, line, 0.005, 10.0)
        )
        if coach_fmu is not None:
            note(COACH_FMU, "ratio", coach_fmu())
    return [Benchmark(name, unit, tuple(rows)) for (name, unit), rows in values.items()]


def _idle_step_s(scenario: Scenario, line: Line, step_s: float, duration_s: float) -> float:
    """Time of a step of a coach that rolls on with nothing but its own forces."""
    no_actuation = Actuation()
    coach = Coach(scenario.coach, line.contact, line.track, line.rail)
    report = coach.run(
        step_s, duration_s, 100.0, SPEED_MPS, lambda t_s, state: no_actuation, loop_period_s(scenario.simulation)
    )
    return report.wall_s / report.steps


def _timed(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def _interpreter_loop() -> int:
    total = 0
    for i in range(_LOOP):
        total += i
    return total


def benchmark_table(benchmarks: list[Benchmark]) -> Table:
    """Medians beside what is required, and the spread that tells how far the machine was its own."""
    table = Table("benchmark", "unit")
    for heading in ("median", "required", "least", "most"):
        table.add_column(heading, justify="right")
    for b in benchmarks:
        required = "" if b.at_most is None else f"<= {b.at_most:g}"
        if b.at_least is not None:
            required = f">= {b.at_least:g}"
        least, most = f"{min(b.values):.4g}", f"{max(b.values):.4g}"
        table.add_row(b.name, b.unit, f"{b.median:.4g}", required, least, most)
    return table


def write_benchmarks(path: Path, benchmarks: list[Benchmark]) -> None:
    """JSON: name -> unit, median, what it may reach at most or must at least (null where nothing is asked), all values.

    Raises BadInput if it cannot be written.
    """
    content = {
        b.name: {
            "unit": b.unit,
            "median": b.median,
            "at_most": b.at_most,
            "at_least": b.at_least,
            "values": b.values,
        }
        for b in benchmarks
    }
    try:
        path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise BadInput(Fault(str(path), "", f"cannot be written: {error.strerror}")) from None
