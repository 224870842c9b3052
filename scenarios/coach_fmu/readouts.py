"""What the coach's FMU shows: values of its outputs from the co-simulation's view, tick by tick."""

import numpy as np

from scenarios.coach_fmu.variables import GOT, slice_of
from scenarios.cosimulation.outside import View
from scenarios.schema import TICK_S, Scenario
from sensors import Imu, pulse_edges
from vehicle import OBSERVATION
from wheel_rail.compiled import Array, Record, compiled

_TIME = slice_of(GOT, "time").start
_COUNTS = slice_of(GOT, "pulse_count").start
_PULSES = slice_of(GOT, "last_pulse_s").start
_SPEEDS = slice_of(GOT, "axle_speed_mps").start
_VALID = slice_of(GOT, "axle_speed_valid").start
_DEMAND = slice_of(GOT, "demand_in_force").start
_DISTRIBUTOR = slice_of(GOT, "distributor_pressure_bar").start
_RESERVOIR = slice_of(GOT, "reservoir_pressure_bar").start
_CYLINDERS = slice_of(GOT, "cylinder_pressure_bar").start
_VALVES = slice_of(GOT, "valve_state").start
_AIR = slice_of(GOT, "air_nl").start
_IMU = slice_of(GOT, "imu_sampled_s").start
_IMU_VALUES = slice_of(GOT, "imu_temperature_degc").stop - _IMU
_POSITION = slice_of(GOT, "true_position_m").start
_SPEED = slice_of(GOT, "true_speed_mps").start
_ACCELERATION = slice_of(GOT, "true_acceleration_mps2").start
_RIMS = slice_of(GOT, "true_rim_speed_mps").start
_KINEMATICS = ("t_s", "specific_force_mps2", "angular_rate_radps", "angular_acceleration_radps2")


class Readouts:
    """Counts pulses and samples the IMU at every tick, and writes all values where the tool asks for them.

    The IMU gives the readings that a run of the scenario would give for this motion: it is the same mask with the same
    seed, fed from one reading to the next.
    """

    def __init__(self, scenario: Scenario, start_s: float) -> None:
        """`start_s`: what the tool calls the time of the first tick."""
        self._start_s = start_s
        self._imu = Imu(scenario.imu, TICK_S, scenario.onboard_seed)
        self._every = round(1.0 / (scenario.imu.rate_hz * TICK_S))
        self._rows = np.zeros(self._every, OBSERVATION)
        self._row = -1  # the one written last
        self._reading = np.zeros(_IMU_VALUES)
        self._ticks = 0
        self._pulses = np.zeros((2, 4))  # counts, times of the last ones
        self._pulses[1] = -scenario.tachometers.timeout_s
        self._pulses_seen = 0

    def follow(self, t_s: float, view: View) -> None:
        """Take note of a tick."""
        tachometers = view.tachometers
        note_pulses(tachometers.edges, self._pulses_seen - tachometers.before, tachometers.count, self._pulses)
        self._pulses_seen = tachometers.before + tachometers.count
        if self._ticks == 0:
            self._pulses[0] = 0.0  # the pulses put in for the time before the start
        # one row at the first tick, then as many as there are from one reading to the next
        self._row = (self._ticks - 1) % self._every if self._ticks else 0
        view.state.observe(t_s, self._rows, self._row)
        if self._ticks % self._every == 0:
            self._sample(self._rows[: self._row + 1])
        self._ticks += 1

    def _sample(self, rows: np.ndarray) -> None:
        t_s, force, rate, acceleration = (np.ascontiguousarray(rows[name]) for name in _KINEMATICS)
        self._reading[0] = self._start_s + t_s[-1]
        self._reading[1:] = self._imu.process_arrays(t_s, force, rate, acceleration)[-1]

    def write(self, t_s: float, view: View, values: np.ndarray) -> None:
        """Write what is there at the tick that was followed last into `values` (GOT,)."""
        write_values(
            (self._start_s, t_s, view.demand), self._pulses, view.tachometers.state, view.brake.record, self._reading,
            self._rows[self._row : self._row + 1], values,
        )  # fmt: skip


@compiled
def write_values(
    times_and_demand: tuple[float, float, float],
    pulses: Array,
    tachometers: Array,
    brake: Record,
    reading: Array,
    row: Record,
    values: Array,
) -> None:
    """Fill `values` (GOT,): one call in the place of some twenty assignments of slices."""
    start_s, t_s, demand = times_and_demand
    plant, motion = brake[0], row[0]
    values[_TIME] = start_s + t_s
    values[_DEMAND] = demand
    values[_DISTRIBUTOR] = plant.distributor_bar
    values[_RESERVOIR] = plant.reservoir_bar
    values[_AIR] = plant.drawn_nl
    values[_POSITION] = motion.position_m
    values[_SPEED] = motion.speed_mps
    values[_ACCELERATION] = motion.acceleration_mps2
    for axle in range(4):
        values[_COUNTS + axle] = pulses[0, axle]
        values[_PULSES + axle] = start_s + pulses[1, axle]
        values[_SPEEDS + axle] = tachometers[pulse_edges.SPEED, axle]
        values[_VALID + axle] = 1.0 if tachometers[pulse_edges.VALID, axle] > 0.0 else 0.0
        values[_CYLINDERS + axle] = plant.cylinder_bar[axle]
        values[_VALVES + axle] = plant.valve[axle]
        values[_RIMS + axle] = motion.rim_speed_mps[axle]
    for k in range(len(reading)):
        values[_IMU + k] = reading[k]


@compiled
def note_pulses(edges: Array, first: int, end: int, pulses: Array) -> None:
    """Count the edges (n, 2) from `first` up to `end` into the rows of `pulses` (2, 4): net counts, last times."""
    for k in range(first, end):
        axle = abs(int(edges[k, 1])) - 1
        pulses[0, axle] += 1.0 if edges[k, 1] > 0.0 else -1.0
        pulses[1, axle] = max(pulses[1, axle], edges[k, 0])
