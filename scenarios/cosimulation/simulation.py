"""The co-simulation: coach, brake, tachometers, wheel slide protection and driver in one loop.

The loop has a period of its own: 5 ms, or less where step or record period ask for it (`loop_period_s`). Order within a
period from t_k to t_k+1, at the state of t_k:
1. at whole ticks (10 ms): faults come and go; the tachometers look at the wheels' angles; what the controller answered
   one tick ago comes into force; the driver does the same at his own ticks (0.1 s): what he answered at the last one
   comes into force, and he answers anew; the controller reads the new tick and answers for the next one (every link
   latches: inputs of tick k act from tick k+1);
2. the recorder, at its own period, writes down what is true at t_k;
3. the brake plant advances to t_k+1 with the valve commands in force; the torques and forces that it then has act on
   the coach throughout the period.

All of it is compiled but the driver, faults, an estimator as reference speed, controllers in Python or from outside:
Python has its turn at the driver's ticks, and at every tick where one of the others is there (`Loop.turn_s`).
"""

from collections.abc import Callable

from scenarios.cosimulation.line import Line
from scenarios.cosimulation.loop import Loop
from scenarios.cosimulation.outside import Outside, View
from scenarios.errors import SolveFailed
from scenarios.names import find_class
from scenarios.schema import TICK_S, Scenario
from scenarios.truth import Truth
from scenarios.units import KMH_PER_MPS
from vehicle import Coach, SolverFailure
from wsp import ControllerOutput
from wsp.foreign.errors import ControllerFailed

OnProgress = Callable[[float, float, float], None]


def simulate(
    scenario: Scenario,
    on_progress: OnProgress,
    stop_requested: Callable[[], bool],
    outside: Outside | None = None,
) -> Truth:
    """Run the scenario until the coach stands or its time is over.

    `on_progress(t_s, position_m, speed_mps)` is called every 0.2 s of simulated time; `stop_requested` is polled as
    often. `outside` takes the place of the scenario's controller. Raises RunInterrupted when asked to stop, SolveFailed
    with the truth so far when the integration or a foreign controller breaks down.
    """
    line = Line(scenario)
    coach = Coach(scenario.coach, line.contact, line.track, line.rail)
    simulation = scenario.simulation
    loop = Loop(scenario, line, on_progress, stop_requested, outside)
    try:
        _compile(scenario)
        report = coach.run(
            simulation.step_s,
            simulation.longest_s,
            simulation.initial_position_m,
            simulation.initial_speed_kmh / KMH_PER_MPS,
            loop.on_tick,
            loop.turn_s,
            plant=loop.plant,
        )
    except (SolverFailure, ControllerFailed) as failure:
        raise SolveFailed(str(failure), loop.truth(None) if loop.has_rows else None) from failure
    finally:
        loop.close()
    if loop.off_the_line:
        raise SolveFailed(
            f"the coach left the track, which reaches from 0 to track.length_m = {scenario.track.length_m}, "
            f"after t = {report.simulated_s:.1f} s without stopping",
            loop.truth(report),
        )
    return loop.truth(report)


class _Idle:
    """Works no valve, in the place of a controller that would start a process."""

    def tick(self, t_s: float, view: View) -> ControllerOutput:
        """Fill."""
        return ControllerOutput()


def _compile(scenario: Scenario) -> None:
    """Two ticks into the air, so that compiling (or loading) the hot code does not count as solving."""
    line = Line(scenario)
    coach = Coach(scenario.coach, line.contact, line.track, line.rail)
    simulation = scenario.simulation
    speed_mps = simulation.initial_speed_kmh / KMH_PER_MPS
    starts_process = hasattr(find_class("controller", scenario.wsp.controller), "close")
    loop = Loop(scenario, line, lambda *_: None, lambda: False, _Idle() if starts_process else None)
    try:
        coach.run(
            simulation.step_s, 2 * TICK_S, simulation.initial_position_m, speed_mps, loop.on_tick, loop.turn_s,
            plant=loop.plant,
        )  # fmt: skip
    finally:
        loop.close()
