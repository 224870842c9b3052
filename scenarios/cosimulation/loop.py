"""Python's part of a co-simulation, and what that leaves behind; see `simulation` for the order."""

import math
from collections.abc import Callable
from typing import Literal, NoReturn

import numpy as np

from scenarios.cosimulation.core import BAD_TRACTION, DONE, JUMPED, LOOP, NO_ROOM, act_address, latch, look
from scenarios.cosimulation.driver import Driver
from scenarios.cosimulation.faults_at_work import FaultsAtWork
from scenarios.cosimulation.line import Line
from scenarios.cosimulation.outside import Outside, View
from scenarios.cosimulation.recorder import Recorder
from scenarios.cosimulation.reference import EstimatedReference
from scenarios.cosimulation.traction import Traction
from scenarios.errors import RunInterrupted
from scenarios.schema import TICK_S, Scenario, SimulationParameters
from scenarios.truth import SolveRecord, Truth, rail_stream
from sensors import AxleSpeedReadings, Tachometers, random_stream
from vehicle import Actuation, CoachState, Plant, SolveReport
from wheel_rail.compiled import address_of
from wheel_rail.sanding import Sanders
from wsp import Brake, Controller, ControllerOutput
from wsp.controllers.compiled_controller import CompiledController
from wsp.foreign.errors import ControllerFailed

# number of the random stream that hangs on the world seed
TACHOMETER_STREAM = 101

STANDSTILL_LASTS_S = 2.0
DRIVER_PERIOD_S = 0.1
_TICKS_PER_DRIVER = round(DRIVER_PERIOD_S / TICK_S)
_PROGRESS_TICKS = 20
_FIRST_TICKS = 4096

LONGEST_LOOP_PERIOD_S = 0.005


def loop_period_s(simulation: SimulationParameters) -> float:
    """Period of brake plant and recorder: the longest one up to 5 ms that is a whole multiple of the step and goes
    into the record period (which goes into the tick)."""
    step = simulation.step_s
    steps_per_record = round(simulation.record_period_s / step)
    fitting = [n for n in range(1, steps_per_record + 1) if steps_per_record % n == 0]
    return max(n * step for n in fitting if n == 1 or n * step <= LONGEST_LOOP_PERIOD_S + 1e-9)


class Loop:
    """The coach's callback and plant with all that they work: brake, tachometers, controller, driver, recorder."""

    def __init__(
        self,
        scenario: Scenario,
        line: Line,
        on_progress: Callable[[float, float, float], None],
        stop_requested: Callable[[], bool],
        outside: Outside | None = None,
    ) -> None:
        self._scenario = scenario
        self._line = line
        self._on_progress = on_progress
        self._stop_requested = stop_requested
        self._outside = outside
        simulation = scenario.simulation
        self.period_s = loop_period_s(simulation)
        radius_m = 0.5 * scenario.coach.wheelset.wheel_diameter_m
        self.tachometers = Tachometers(
            scenario.tachometers, random_stream(scenario.scenario.world_seed, TACHOMETER_STREAM, 0)
        )
        self._controller = None if outside else scenario.make_controller()
        self._ticks_per_control = 1
        if self._controller is not None:
            self._controller.reset(0.0, 1)
            self._ticks_per_control = round(self._controller.period_s / TICK_S)
        self._driver = Driver(scenario.driver, scenario.traction, DRIVER_PERIOD_S)
        self._traction = Traction(scenario.traction, radius_m, TICK_S)
        self.brake = Brake(scenario.brake_at_load, self.period_s)
        name = scenario.wsp.reference_estimator
        self._reference = None if name is None else EstimatedReference(scenario, name)
        self._estimated_rows = 0
        self._view = View(self.tachometers, self.brake)
        self._faults = FaultsAtWork(scenario.faults, self.brake, self.tachometers)
        self._recorder = Recorder()
        self._first_m, self._last_m = line.places_m
        self._sanders = Sanders(scenario.sanding, TICK_S)
        self._actuation = Actuation(self._sanders.rows)
        self._rail_before = line.state.table.copy()
        self._demand = 0.0
        self._dead = False
        self._seen = np.zeros((_FIRST_TICKS, 8))  # axle speeds and whether they are valid, one row per tick
        self.off_the_line = False
        self.stopped = False
        self.record = np.zeros(1, LOOP)
        self._numbers = numbers = self.record[0]
        numbers["brake_at"] = address_of(self.brake.record)
        numbers["tachometer_at"] = address_of(self.tachometers.state)
        numbers["tachometer_rows"] = len(self.tachometers.state)
        numbers["actuation_at"] = address_of(self._actuation.numbers)
        numbers["sanders_at"] = self._sanders.address if scenario.sanding.sanders else 0
        numbers["traction_at"] = self._traction.address
        numbers["periods_per_tick"] = round(TICK_S / self.period_s)
        numbers["periods_per_record"] = round(simulation.record_period_s / self.period_s)
        numbers["rows_per_tick"] = round(TICK_S / simulation.record_period_s)
        numbers["heeds_wishes"] = bool(
            scenario.sanding.sanders or scenario.brake.track_brake is not None or outside is not None
        )
        numbers["ticks_per_control"] = self._ticks_per_control
        self._ticks_per_turn = 1
        compiled = self._controller
        if isinstance(compiled, CompiledController) and compiled.needs_no_python and not (name or scenario.faults):
            numbers["inputs_at"], numbers["control_at"] = compiled.inputs_at, (compiled.tick_at, compiled.record_at)
            self._ticks_per_turn = _TICKS_PER_DRIVER
        self._address = address_of(self.record)
        self._hear(ControllerOutput())
        self._valid = numbers["valid"].view(np.bool_)
        self._axle_speed = self.tachometers.axle_speed_mps
        self._ticks = self.record["ticks"]  # so far
        # several numbers of a record at once take a third of the time
        self._seen_last = self.record[["position_m", "speed_mps", "moved", "still_ticks"]]
        self._driven = self.record[["demand", "traction_n"]]
        self._driver_wishes = self.record[["driver_sands", "driver_brakes_track"]]

    def close(self) -> None:
        """End what the controller holds outside of this process, if anything."""
        close = getattr(self._controller, "close", None)
        if close is not None:
            close()

    @property
    def has_rows(self) -> bool:
        """Whether anything has been recorded."""
        return int(self._numbers["periods"]) > 0

    def on_tick(self, t_s: float, state: CoachState) -> Actuation | None:
        """The coach's callback, every `turn_s`; see the head of `scenarios.cosimulation.simulation` for the order."""
        ticks = self._ticks.item()
        if ticks == 0:
            self._state = state
            self._numbers["coach_at"] = state.address
        return self._actuation if self._tick(t_s, ticks) else None

    @property
    def plant(self) -> Plant:
        """The coach's compiled work, every `period_s`."""
        return Plant(act_address(), self._address, self.period_s, self._refuse)

    @property
    def turn_s(self) -> float:
        """Period of `on_tick`: the driver's where all that happens at the ticks between is compiled, else a tick."""
        return self._ticks_per_turn * TICK_S

    def _refuse(self, t_s: float, acted: int) -> NoReturn:
        if acted == JUMPED:
            raise ValueError(f"t_s = {t_s}: the angle of a wheel has jumped by thousands of pulses")
        if acted == BAD_TRACTION:
            raise ValueError(f"at t = {t_s:.2f} s: traction_n = {self._view.traction_n}, it must be finite")
        command = self._numbers["command"].tolist()
        raise ControllerFailed(
            f"at t = {t_s:.2f} s: valve = {command}, each must be 0 (fill), 1 (hold) or 2 (vent); "
            f"demand = {self._demand}, it must be 0 to 1"
        )

    def _tick(self, t_s: float, ticks: int) -> bool:
        """Everything that happens at a tick of Python's; False ends the run."""
        if t_s >= self._faults.next_s:
            self._faults.step(t_s)
        ahead = self._ticks_per_turn
        looked = look(self._address, t_s, ahead)
        if looked == NO_ROOM:
            self._make_room(ticks, ahead)
            looked = look(self._address, t_s, ahead)
        if looked != DONE:
            self._refuse(t_s, looked)
        if ticks % _TICKS_PER_DRIVER == 0:
            self._look_around(t_s, ticks)
            if self.stopped or self.off_the_line:
                return False
        if self._controller is None:
            if not self._ask_outside(t_s):
                return False
        else:
            if self._reference is not None and ticks > 0 and self._reference.due(t_s - TICK_S):
                self._estimate(t_s - TICK_S, self._seen[ticks - 1], self._reference)
            if ticks % self._ticks_per_control == 0:
                self._control(t_s, self._controller)
        return True

    def _make_room(self, ticks: int, ahead: int) -> None:
        """Let every array have room for what the next ticks bring, `ahead` in number."""
        numbers, tachometers = self._numbers, self.tachometers
        tachometers.count = int(numbers["edge_count"])
        tachometers.make_room(ahead)
        numbers["edge_count"] = tachometers.count
        numbers["edges_at"], numbers["edges_room"] = address_of(tachometers.edges), len(tachometers.edges)
        if ticks + ahead > len(self._seen):
            self._seen = np.concatenate([self._seen, np.zeros_like(self._seen)])
        numbers["seen_at"], numbers["seen_room"] = address_of(self._seen), len(self._seen)
        numbers["row"] = self._recorder.make_room(int(numbers["row"]), ahead * int(numbers["rows_per_tick"]))
        numbers["motion_at"], numbers["brake_rows_at"] = map(address_of, self._recorder.block)
        numbers["rows_room"] = len(self._recorder.block[0])

    def _look_around(self, t_s: float, ticks: int) -> None:
        """A tick of the driver: what he answered at the last one comes into force, then he answers anew."""
        driver = self._driver
        position_m, speed_mps, moved, still_ticks = self._seen_last.item()
        if ticks % _PROGRESS_TICKS == 0:
            if self._stop_requested():
                raise RunInterrupted
            self._on_progress(t_s, position_m, speed_mps)
        # the track goes on beyond its ends for farther than a coach gets between two looks
        if not self._first_m <= position_m <= self._last_m:
            self.off_the_line = True
        self._drive(driver.traction_n, driver.demand)
        self._driver_wishes[0] = driver.sand, driver.track_brake
        driver.step(position_m, speed_mps)
        # at rest under brakes, having moved, for long enough to end the run
        if still_ticks * TICK_S >= STANDSTILL_LASTS_S and moved:
            stays = driver.demand > 0.0 and not driver.goes_on
            self.stopped = self._demand > 0.0 and stays and self._outside is None

    def _drive(self, traction_n: float, demand: float) -> None:
        self._demand = demand
        self._view.demand, self._view.traction_n = self._driven[0] = demand, traction_n

    def _control(self, t_s: float, controller: Controller) -> None:
        """What the controller answered at its last tick is in force by now; it answers anew."""
        if self._faults.controller_dead:
            self._dead = True
            return
        if self._dead:
            self._dead = False
            controller.reset(t_s, 1)
        reference_mps = math.nan if self._reference is None else self._reference.at(t_s)
        try:
            output = controller.step(t_s, self._axle_speed, self._valid, self._demand, 1, reference_mps)
            if output is not self._answer:
                self._hear(output)
        except (ControllerFailed, RunInterrupted):
            raise
        except Exception as error:
            raise ControllerFailed(f"controller at t = {t_s:.2f} s: {type(error).__name__}: {error}") from error

    def _hear(self, answer: ControllerOutput) -> None:
        """Keep alive what the compiled loop reads by its address."""
        self._answer = answer
        self._numbers["answer_at"] = answer.address

    def _estimate(self, tick_s: float, seen: np.ndarray, reference: EstimatedReference) -> None:
        """The estimator of the reference takes what was recorded up to the last tick."""
        # recorded are whole ticks: what came after the instant of that tick belongs to the next one
        last = self._recorder.before + int(self._numbers["row"]) - (int(self._numbers["rows_per_tick"]) - 1)
        rows = self._recorder.motion_rows(self._estimated_rows, last)
        reference.step(tick_s, rows, seen[:4], seen[4:] > 0.0)
        self._estimated_rows = last

    def _ask_outside(self, t_s: float) -> bool:
        """Let somebody outside answer this tick, to act at once; False if he ends the run."""
        view = self._view
        self.tachometers.count = int(self._numbers["edge_count"])
        view.state = self._state
        output = self._outside.tick(t_s, view) if self._outside else None
        if output is None:
            return False
        self._hear(output)
        latch(self._address)
        self._drive(view.traction_n, view.demand)
        return True

    def truth(self, report: SolveReport | None) -> Truth:
        """The streams recorded; `report` None when the solve broke down."""
        line, recorder = self._line, self._recorder
        ended: Literal["standstill", "time"] = "standstill" if self.stopped else "time"
        simulated_s = report.simulated_s if report else int(self._numbers["periods"]) * self.period_s
        self.tachometers.count = int(self._numbers["edge_count"])
        recorder.rows = int(self._numbers["row"])
        seen = self._seen[: self._ticks.item()]
        motion, wheelsets = recorder.motion_and_wheelsets(line.track, line.contact, line.rail)
        return Truth(
            motion=motion,
            wheelsets=wheelsets,
            rail=rail_stream(line.state.table),
            rail_before=rail_stream(self._rail_before),
            brake=recorder.brake(motion.t_s),
            tachometer=self.tachometers.readings(),
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
