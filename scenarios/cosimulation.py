"""The co-simulation: coach, brake, tachometers, wheel slide protection and driver in one loop.

The loop has a period of its own: 5 ms, or less where step or record period ask for it (`loop_period_s`). Order within a
period from t_k to t_k+1, at the state of t_k:
1. at whole ticks (10 ms): the tachometers look at the wheels' angles; what the controller answered one tick ago comes
   into force; it reads the new tick and answers for the next one (every link latches: inputs of tick k act from tick
   k+1); the driver does the same at its own ticks (0.1 s);
2. the recorder, at its own period, writes down what is true at t_k;
3. the brake plant advances to t_k+1 with the valve commands in force; the torque capacity that it then has acts on the
   coach throughout the period.

Somebody outside (`Outside`) may work the valves in the controller's place. He is asked after the driver and answers for
the tick at hand: the link's delay of one tick is then the business of whoever connects him with his controller.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Literal, Protocol

import numpy as np

from scenarios.driver import Driver
from scenarios.errors import RunInterrupted, SolveFailed
from scenarios.parquet import read_columns
from scenarios.recorder import Recorder
from scenarios.schema import TICK_S, Scenario, SimulationParameters
from scenarios.truth import SolveRecord, Truth, rail_stream
from scenarios.units import KMH_PER_MPS
from sensors import AxleSpeedReadings, Tachometers, random_stream
from vehicle import Actuation, Coach, CoachState, SolveReport, SolverFailure
from wheel_rail import Adhesion, Contact, RailState, Track
from wheel_rail.sanding import Sanders
from wsp import Brake, ControllerOutput

# numbers of the random streams that hang on the world seed
RAIL_STREAM = 100
TACHOMETER_STREAM = 101

STANDSTILL_MPS = 0.02
STANDSTILL_LASTS_S = 2.0
DRIVER_PERIOD_S = 0.1
_TICKS_PER_DRIVER = round(DRIVER_PERIOD_S / TICK_S)
_PROGRESS_TICKS = 20

LONGEST_LOOP_PERIOD_S = 0.005

OnProgress = Callable[[float, float, float], None]


def loop_period_s(simulation: SimulationParameters) -> float:
    """Period of brake plant and recorder: the longest one up to 5 ms that is a whole multiple of the step and goes
    into the record period (which goes into the tick)."""
    step = simulation.step_s
    steps_per_record = round(simulation.record_period_s / step)
    fitting = [n for n in range(1, steps_per_record + 1) if steps_per_record % n == 0]
    return max(n * step for n in fitting if n == 1 or n * step <= LONGEST_LOOP_PERIOD_S + 1e-9)


class View:
    """What somebody outside sees of a run at a tick, the driver's part included.

    `demand` (0..1) and `traction_n` (whole coach) are as the driver has them in force; writing them overrules him until
    he acts again.
    """

    def __init__(self, tachometers: Tachometers, brake: Brake) -> None:
        self.tachometers = tachometers
        self.brake = brake
        self.state: CoachState
        self.demand = 0.0
        self.traction_n = 0.0


class Outside(Protocol):
    """Whoever works the valves from outside of the program, tick by tick."""

    def tick(self, t_s: float, view: View) -> ControllerOutput | None:
        """What is in force from t_s to the next tick; None ends the run, which a standstill then does not."""


class Line:
    """The world of a scenario: track, rails as found, and the contact of this coach's wheels with them.

    `state` is what the rails keep of every train; a run changes it, all else is fixed. Raises ValueError with the key
    of what does not fit.
    """

    def __init__(self, scenario: Scenario) -> None:
        coach = scenario.coach
        # from the coach's centre to its outer wheelsets
        self.reach_m = 0.5 * (coach.bogie_distance_m + coach.wheelbase_m)
        radius_m = 0.5 * coach.wheelset.wheel_diameter_m
        self.contact = Contact(coach.contact, radius_m, coach.static_wheel_load_n, scenario.creep_law.in_force())
        self.track = Track(scenario.track)
        self.adhesion = Adhesion(
            scenario.adhesion,
            scenario.track.length_m,
            self.contact,
            random_stream(scenario.scenario.world_seed, RAIL_STREAM, 0),
            scenario.sanding.effect,
        )
        self.state = _rail_state(scenario)
        self.rail = self.adhesion.tables(self.state)

    @property
    def places_m(self) -> tuple[float, float]:
        """First and last place of the coach's centre at which all its wheelsets are on the line."""
        return self.reach_m, self.track.length_m - self.reach_m


def _rail_state(scenario: Scenario) -> RailState:
    """Rails without a trace of trains, or as an earlier run has left them."""
    length_m = scenario.track.length_m
    path = scenario.adhesion.rail_state_file
    if path is None:
        return RailState(length_m)
    try:
        return RailState.from_arrays(length_m, read_columns(Path(path)))
    except ValueError as error:
        raise ValueError(f"adhesion.rail_state_file = {path}: {error}") from None


def simulate(
    scenario: Scenario,
    on_progress: OnProgress,
    stop_requested: Callable[[], bool],
    outside: Outside | None = None,
) -> Truth:
    """Run the scenario until the coach stands or its time is over; `outside` takes the place of its controller.

    `on_progress(t_s, position_m, speed_mps)` is called every 0.2 s of simulated time; `stop_requested` is polled as
    often. Raises RunInterrupted when it says so, SolveFailed with the truth so far when the integration breaks down.
    """
    line = Line(scenario)
    coach = Coach(scenario.coach, line.contact, line.track, line.rail)
    simulation = scenario.simulation
    loop = _Loop(scenario, line, on_progress, stop_requested, outside)
    try:
        _compile(scenario)
        report = coach.run(
            simulation.step_s,
            simulation.longest_s,
            simulation.initial_position_m,
            simulation.initial_speed_kmh / KMH_PER_MPS,
            loop.on_step,
            loop.period_s,
        )
    except SolverFailure as failure:
        raise SolveFailed(str(failure), loop.truth(None) if loop.has_rows else None) from failure
    if loop.off_the_line:
        raise SolveFailed(
            f"the coach left the track, which reaches from 0 to track.length_m = {scenario.track.length_m}, "
            f"after t = {report.simulated_s:.1f} s without stopping",
            loop.truth(report),
        )
    return loop.truth(report)


def _compile(scenario: Scenario) -> None:
    """Two ticks into the air, so that compiling (or loading) the hot code does not count as solving."""
    line = Line(scenario)
    coach = Coach(scenario.coach, line.contact, line.track, line.rail)
    loop = _Loop(scenario, line, lambda *_: None, lambda: False)
    simulation = scenario.simulation
    speed_mps = simulation.initial_speed_kmh / KMH_PER_MPS
    coach.run(simulation.step_s, 2 * TICK_S, simulation.initial_position_m, speed_mps, loop.on_step, loop.period_s)


class _Loop:
    """What happens at each base step, and what it leaves behind."""

    def __init__(
        self,
        scenario: Scenario,
        line: Line,
        on_progress: OnProgress,
        stop_requested: Callable[[], bool],
        outside: Outside | None = None,
    ) -> None:
        self._scenario = scenario
        self._line = line
        self._on_progress = on_progress
        self._stop_requested = stop_requested
        simulation = scenario.simulation
        self.period_s = loop_period_s(simulation)
        self._periods_per_tick = round(TICK_S / self.period_s)
        self._periods_per_record = round(simulation.record_period_s / self.period_s)
        self._radius_m = 0.5 * scenario.coach.wheelset.wheel_diameter_m
        self._tachometers = Tachometers(
            scenario.tachometers, random_stream(scenario.scenario.world_seed, TACHOMETER_STREAM, 0)
        )
        self._controller = scenario.make_controller()
        self._controller.reset(0.0, 1)
        self._ticks_per_control = round(self._controller.period_s / TICK_S)
        self._driver = Driver(scenario.driver, DRIVER_PERIOD_S)
        self._brake = Brake(scenario.brake, self.period_s)
        self._outside = outside
        self._view = View(self._tachometers, self._brake)
        self._recorder = Recorder()
        self._first_m, self._last_m = line.places_m
        self._sanders = Sanders(scenario.sanding, TICK_S)
        self._actuation = Actuation(sanders=self._sanders.rows)
        self._sand = np.zeros(4, np.bool_)
        self._rail_before = line.state.table.copy()
        self._valve = np.zeros(4, np.int8)
        self._answer = np.zeros(4, np.int8)
        self._output = ControllerOutput()
        self._demand = 0.0
        self._periods = 0
        self._ticks = 0
        self._moved = False
        self._still_ticks = 0
        self._seen = np.zeros((4096, 8))  # axle speeds and whether they are valid, one row per tick
        self.off_the_line = False
        self.stopped = False

    @property
    def has_rows(self) -> bool:
        """Whether anything has been recorded."""
        return self._periods > 0

    def on_step(self, t_s: float, state: CoachState) -> Actuation | None:
        """The coach's callback; see the module's description for the order."""
        periods = self._periods
        if periods % self._periods_per_tick == 0 and not self._tick(t_s, state):
            return None
        if periods % self._periods_per_record == 0:
            self._recorder.record(t_s, state, self._demand, self._brake, self._tachometers.axle_speed_mps, self._output)
        self._periods = periods + 1
        actuation = self._actuation
        actuation.brake_torque_nm = self._brake.step(self._demand, self._valve)
        return actuation

    def _tick(self, t_s: float, state: CoachState) -> bool:
        """Everything that happens each 10 ms; False ends the run."""
        ticks, speed_mps = self._ticks, state.speed_mps
        if ticks % _PROGRESS_TICKS == 0:
            if self._stop_requested():
                raise RunInterrupted
            self._on_progress(t_s, state.position_m, speed_mps)
        tachometers = self._tachometers
        tachometers.advance(t_s, state.wheel_angle_rad, state.wheel_rate_radps)
        if ticks == len(self._seen):
            self._seen = np.concatenate([self._seen, np.zeros_like(self._seen)])
        self._seen[ticks] = tachometers.front_end
        # what each answered at its last tick comes into force, then it answers anew
        if ticks % _TICKS_PER_DRIVER == 0:
            position_m = state.position_m
            # the track goes on beyond its ends for farther than a coach gets between two looks
            if not self._first_m <= position_m <= self._last_m:
                self.off_the_line = True
            driver = self._driver
            self._drive(driver.traction_n, driver.demand)
            driver.step(position_m, speed_mps)
        if self._outside is not None:
            going_on = self._ask_outside(self._outside, t_s, state)
            self._ticks = ticks + 1
            return going_on and not self.off_the_line
        if ticks % self._ticks_per_control == 0:
            self._valve, self._answer = self._answer, self._valve
            self._sand[:] = self._output.sand
            self._output = self._controller.step(
                t_s, tachometers.axle_speed_mps, tachometers.valid, self._demand, 1, math.nan
            )
            self._answer[:] = self._output.valve
        if len(self._sanders.rows):
            self._sanders.step(self._sand)
        self._ticks = ticks + 1
        self.stopped = self._stands(speed_mps)
        return not (self.stopped or self.off_the_line)

    def _drive(self, traction_n: float, demand: float) -> None:
        self._actuation.drive_torque_nm[:] = 0.25 * traction_n * self._radius_m
        self._demand = demand
        self._view.traction_n, self._view.demand = traction_n, demand

    def _ask_outside(self, outside: Outside, t_s: float, state: CoachState) -> bool:
        """Let somebody outside answer this tick; False if he ends the run."""
        view = self._view
        view.state = state
        output = outside.tick(t_s, view)
        if output is None:
            return False
        self._output = output
        self._valve[:] = output.valve
        self._drive(view.traction_n, view.demand)
        if len(self._sanders.rows):
            self._sanders.step(output.sand)
        return True

    def _stands(self, speed_mps: float) -> bool:
        """Whether the coach, having moved, has been at rest under brakes for long enough to end the run."""
        if speed_mps > STANDSTILL_MPS:
            self._moved = True
            self._still_ticks = 0
        else:
            self._still_ticks += 1
        return self._moved and self._demand > 0.0 and self._still_ticks * TICK_S >= STANDSTILL_LASTS_S

    def truth(self, report: SolveReport | None) -> Truth:
        """The streams recorded; `report` None when the solve broke down."""
        line = self._line
        ended: Literal["standstill", "time"] = "standstill" if self.stopped else "time"
        simulated_s = report.simulated_s if report else self._periods * self.period_s
        seen = self._seen[: self._ticks]
        return Truth(
            motion=self._recorder.motion_stream(line.track),
            wheelsets=self._recorder.wheelset_stream(line.contact),
            rail=rail_stream(line.state.table),
            rail_before=rail_stream(self._rail_before),
            brake=self._recorder.brake_stream(),
            tachometer=self._tachometers.readings(),
            axle_speeds=AxleSpeedReadings(
                t_s=TICK_S * np.arange(len(seen), dtype=np.float64),
                axle_speed_mps=seen[:, :4],
                valid=seen[:, 4:] > 0.0,
            ),
            solve=SolveRecord(
                simulated_s=simulated_s,
                wall_s=report.wall_s if report else math.nan,
                realtime_factor=simulated_s / report.wall_s if report else math.nan,
                step_s=self._scenario.simulation.step_s,
                exudyn_build=report.exudyn_build if report else "",
                ended=ended,
            ),
        )
