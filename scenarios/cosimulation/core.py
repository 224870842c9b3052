"""What the co-simulation does at ticks and periods, compiled: one call each, by the address of its record."""

import math
from functools import cache
from typing import Any

import numpy as np
from numba import cfunc, types

from scenarios.cosimulation.traction import drive, traction_at
from sensors import pulse_edges
from sensors.tachometers import ROOM_OF_A_TICK
from vehicle.layout import ACTUATION, SPIN, coach_at
from vehicle.observation import OBSERVATION, observe
from wheel_rail.compiled import array_at, call_at, compiled, record_reader
from wheel_rail.sanding import work_sanders
from wsp.brake import BRAKE, advance_brake
from wsp.controllers.interface import INPUT, OUTPUT

BRAKE_ROW = np.dtype(
    [
        ("demand", "f8"),
        ("reference_speed_mps", "f8"),
        ("axle_speed_mps", "f8", (4,)),
        ("distributor_pressure_bar", "f8"),
        ("reservoir_pressure_bar", "f8"),
        ("cylinder_pressure_bar", "f8", (4,)),
        ("friction_torque_capacity_nm", "f8", (4,)),
        ("dynamic_brake_torque_nm", "f8", (4,)),
        ("track_brake_force_n", "f8", (2,)),
        ("disc_temperature_degc", "f8", (4,)),
        ("air_nl", "f8"),
        ("valve_command", "i1", (4,)),
        ("valve", "i1", (4,)),
        ("sand_command", "i1", (4,)),
        ("safety_timer_fired", "i1", (4,)),
        ("track_brake_command", "i1"),
    ],
    align=True,
)
"""One row of what is recorded of the brake."""

LOOP = np.dtype(
    [
        # where things stand: records of coach and brake, tachometers, rows to be written, actuation, sanders (0: none),
        # traction, what the controller answered last; a compiled controller's inputs, C function and record (0: none)
        ("coach_at", "i8"),
        ("brake_at", "i8"),
        ("tachometer_at", "i8"),
        ("tachometer_rows", "i8"),
        ("edges_at", "i8"),
        ("edges_room", "i8"),
        ("seen_at", "i8"),
        ("seen_room", "i8"),
        ("motion_at", "i8"),
        ("brake_rows_at", "i8"),
        ("rows_room", "i8"),
        ("actuation_at", "i8"),
        ("sanders_at", "i8"),
        ("traction_at", "i8"),
        ("answer_at", "i8"),
        ("inputs_at", "i8"),
        ("control_at", "i8", (2,)),
        # how far they are written
        ("periods_per_tick", "i8"),
        ("periods_per_record", "i8"),
        ("rows_per_tick", "i8"),
        ("ticks_per_control", "i8"),
        ("periods", "i8"),
        ("edge_count", "i8"),
        ("ticks", "i8"),
        ("row", "i8"),
        # commands in force: of the WSP, of the driver
        ("command", "i1", (4,)),
        ("sand", "u1", (4,)),
        ("track_brake", "u1"),
        ("heeds_wishes", "u1"),  # whether the coach, or somebody outside, has any use for sand and track brake
        ("driver_sands", "u1"),
        ("driver_brakes_track", "u1"),
        ("demand", "f8"),
        ("traction_n", "f8"),
        # the last tick: whether it was one of the controller's, and what was seen
        ("controlling", "u1"),
        ("valid", "u1", (4,)),
        ("speed_mps", "f8"),
        ("position_m", "f8"),
        ("moved", "i8"),
        ("still_ticks", "i8"),
    ]
)

loop_at = record_reader(LOOP)
_brake_at = record_reader(BRAKE)
_brake_row_at = record_reader(BRAKE_ROW)
_answer_at = record_reader(OUTPUT)
_inputs_at = record_reader(INPUT)

DONE, NO_ROOM, JUMPED, BAD_COMMAND, BAD_TRACTION = range(5)

STANDSTILL_MPS = 0.02
_MOTION_BYTES, _BRAKE_BYTES = OBSERVATION.itemsize, BRAKE_ROW.itemsize
_SEEN_BYTES = 64
_DYNAMIC_FADES_RADPS = 0.2  # a retarder's torque goes through zero with the wheel's rotation


@compiled
def look(address: int, t_s: float, ahead: int) -> int:
    """A tick: the tachometers look at the wheels; if it is one of the controller's, its last answer comes into force.

    DONE; or NO_ROOM, and nothing done, if an array cannot take what this tick and those after it, `ahead` in all, may
    bring; or JUMPED if a wheel's angle has jumped by thousands of pulses.
    """
    loop = loop_at(address)
    if (
        loop.edge_count + ahead * ROOM_OF_A_TICK > loop.edges_room
        or loop.ticks + ahead > loop.seen_room
        or loop.row + ahead * loop.rows_per_tick > loop.rows_room
    ):
        return NO_ROOM
    coach = coach_at(loop.coach_at)
    q, v = array_at(coach.solver_at[0], (46,)), array_at(coach.solver_at[1], (46,))
    state = array_at(loop.tachometer_at, (loop.tachometer_rows, 4))
    edges = array_at(loop.edges_at, (loop.edges_room, 2))
    count = pulse_edges.advance(t_s, q[SPIN:], v[SPIN:], state, edges, loop.edge_count)
    if count < 0:
        return JUMPED
    loop.edge_count = count
    seen = array_at(loop.seen_at + _SEEN_BYTES * loop.ticks, (8,))
    for i in range(4):
        seen[i] = state[pulse_edges.SPEED, i]
        seen[4 + i] = state[pulse_edges.VALID, i]
        loop.valid[i] = 1 if seen[4 + i] > 0.0 else 0
    loop.controlling = 1 if loop.ticks % loop.ticks_per_control == 0 else 0
    if loop.controlling != 0:
        latch(address)
    loop.ticks += 1
    loop.position_m = coach.s[4]
    loop.speed_mps = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    if loop.speed_mps > STANDSTILL_MPS:
        loop.moved = 1
        loop.still_ticks = 0
    else:
        loop.still_ticks += 1
    return DONE


@compiled
def latch(address: int) -> None:
    """What the controller answered last comes into force."""
    loop = loop_at(address)
    answer = _answer_at(loop.answer_at)
    loop.command[:] = answer.valve
    if loop.sanders_at != 0:
        loop.sand[:] = answer.sand
    loop.track_brake = answer.track_brake


@compiled
def _control(address: int, t_s: float) -> None:
    """The compiled controller reads the tick and answers for its next one."""
    loop = loop_at(address)
    inputs = _inputs_at(loop.inputs_at)
    state = array_at(loop.tachometer_at, (loop.tachometer_rows, 4))
    for i in range(4):
        inputs.axle_speed_mps[i] = state[pulse_edges.SPEED, i]
        inputs.valid[i] = loop.valid[i]
    inputs.demand = loop.demand
    inputs.direction = 1
    inputs.outside_reference_mps = math.nan
    call_at(loop.control_at[0], loop.control_at[1], t_s)  # type: ignore[call-arg]


@compiled
def _obey(address: int) -> bool:
    """A tick, after all have spoken: the driver's wishes join the controller's, and sanders, track brake and traction
    do as they are told; False if the driver's force is not finite."""
    loop = loop_at(address)
    if loop.controlling != 0 and loop.heeds_wishes != 0:
        if loop.sanders_at != 0 and loop.driver_sands != 0:
            loop.sand[:] = 1
        _brake_at(loop.brake_at).track_brake_on = loop.track_brake != 0 or loop.driver_brakes_track != 0
    if loop.sanders_at != 0:
        work_sanders(loop.sanders_at, loop.sand)
    state = array_at(loop.tachometer_at, (loop.tachometer_rows, 4))
    return drive(loop.traction_at, loop.traction_n, state[pulse_edges.SPEED], loop.valid)


def act(address: int, t_s: float) -> int:
    """A period: at a tick that Python has not seen to, the tachometers look and the controller answers; at every tick
    commands go out; at its own times the recorder writes down what is true at `t_s`; then the brake plant advances and
    the actuation is set.

    DONE; or JUMPED if a wheel's angle has jumped by thousands of pulses, BAD_COMMAND if the plant refuses demand or
    valve codes, BAD_TRACTION if the driver's force is not finite.
    """
    loop = loop_at(address)
    if loop.periods % loop.periods_per_tick == 0:
        if loop.ticks * loop.periods_per_tick == loop.periods:
            # Python makes room for all ticks until its next one: only a jump can have taken it
            if look(address, t_s, 1) != DONE:
                return JUMPED
            if loop.controlling != 0:
                _control(address, t_s)
        if not _obey(address):
            return BAD_TRACTION
    coach = coach_at(loop.coach_at)
    brake = _brake_at(loop.brake_at)
    v = array_at(coach.solver_at[1], (46,))
    if loop.periods % loop.periods_per_record == 0:
        observe(t_s, loop.coach_at, loop.motion_at + loop.row * _MOTION_BYTES)
        _write_brake_row(address)
        loop.row += 1
    speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    if not advance_brake(brake, loop.demand, loop.command, v[SPIN:], speed):
        return BAD_COMMAND
    actuation = array_at(loop.actuation_at, (ACTUATION,))
    traction = traction_at(loop.traction_at)
    for i in range(4):
        actuation[i] = brake.torque_nm[i]
        turning = math.tanh(v[SPIN + i] / _DYNAMIC_FADES_RADPS) if brake.dynamic_torque_nm[i] > 0.0 else 0.0
        actuation[4 + i] = traction.torque_nm[i] - brake.dynamic_torque_nm[i] * turning
    actuation[8], actuation[9] = brake.track_brake_force_n[0], brake.track_brake_force_n[1]
    loop.periods += 1
    return DONE


def act_address() -> int:
    """Address of `act` as a C function."""
    return int(_compiled_act().address)


@cache  # which keeps it alive
def _compiled_act() -> Any:
    return cfunc(types.int64(types.int64, types.float64), cache=True, error_model="numpy")(act)


@compiled
def _write_brake_row(address: int) -> None:
    loop = loop_at(address)
    brake = _brake_at(loop.brake_at)
    row = _brake_row_at(loop.brake_rows_at + loop.row * _BRAKE_BYTES)
    state = array_at(loop.tachometer_at, (loop.tachometer_rows, 4))
    row.demand = loop.demand
    row.reference_speed_mps = _answer_at(loop.answer_at).reference_speed_mps
    row.distributor_pressure_bar = brake.distributor_bar
    row.reservoir_pressure_bar = brake.reservoir_bar
    row.air_nl = brake.drawn_nl
    row.track_brake_command = 1 if brake.track_brake_on else 0
    for i in range(4):
        row.axle_speed_mps[i] = state[pulse_edges.SPEED, i]
        row.valve_command[i] = loop.command[i]
        row.sand_command[i] = loop.sand[i]
        row.valve[i] = brake.valve[i]
        row.cylinder_pressure_bar[i] = brake.cylinder_bar[i]
        row.friction_torque_capacity_nm[i] = brake.torque_nm[i]
        row.dynamic_brake_torque_nm[i] = brake.dynamic_torque_nm[i]
        row.disc_temperature_degc[i] = brake.disc_temperature_degc[i]
        row.safety_timer_fired[i] = brake.timer_fired[i]
    row.track_brake_force_n[0] = brake.track_brake_force_n[0]
    row.track_brake_force_n[1] = brake.track_brake_force_n[1]
