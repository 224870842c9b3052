"""What can be seen of the coach at one instant: motion, wheel-rail forces, powers and momentum, in one record.

Forces are worked out anew at the state that is recorded: those of the solver's own evaluation belong to its predictor.
That lay so near that the rails found under it are those of the state: no body was further off than 0.012 mm in a stop
on slippery rail and 0.11 mm over test path 3, in steps of 5 ms, and 0.002 mm on rough rails in steps of 0.5 ms.
"""

import math

import numpy as np

from vehicle.forces import (
    BRAKE,
    CONTACT_NORMAL,
    CREEP,
    DRIVE,
    GRAVITY,
    RESISTANCE,
    SUSPENSION,
    TRACK_BRAKE,
    forces_on_rails,
)
from vehicle.layout import BODY_FRAME, CLASSES, MOST_ROWS, coach_at
from vehicle.parameters import GRAVITY_MPS2
from vehicle.rails import from_frames, speeds_along
from vehicle.rotations import place_of
from wheel_rail.adhesion_memory import MEMORY
from wheel_rail.compiled import Array, Record, array_at, compiled, inlined, record_reader
from wheel_rail.contact import LATERAL, LONGITUDINAL, NORMAL, SLIDE_POWER
from wheel_rail.lane_arrays import lanes_at, put_four, put_lanes, put_wheelsets
from wheel_rail.lanes import LANES, ZEROS, lane, lanes_of, total
from wheel_rail.recovery import ENERGY, SAND

# order of the force classes in `power_w`
POWERS = ("gravity", "suspension", "contact_normal", "creep", "brake", "drive", "resistance", "track_brake")

OBSERVATION = np.dtype(
    [
        ("t_s", "f8"),
        ("position_m", "f8"),  # of the carbody's centre along the track
        ("speed_mps", "f8"),
        ("acceleration_mps2", "f8"),  # along the track
        ("roll_rad", "f8"),
        ("pitch_rad", "f8"),
        ("yaw_rad", "f8"),
        ("specific_force_mps2", "f8", (3,)),  # carbody axes, at its centre of mass
        ("angular_rate_radps", "f8", (3,)),
        ("angular_acceleration_radps2", "f8", (3,)),
        ("kinetic_energy_j", "f8"),
        ("power_w", "f8", (len(POWERS),)),
        ("momentum_ns", "f8", (3,)),  # world axes
        ("external_force_n", "f8", (3,)),
        ("wheelset_position_m", "f8", (4,)),
        ("wheelset_speed_mps", "f8", (4,)),
        ("rim_speed_mps", "f8", (4,)),
        ("wheel_angle_rad", "f8", (4,)),
        ("lateral_displacement_m", "f8", (4,)),
        ("brake_torque_nm", "f8", (4,)),
        ("drive_torque_nm", "f8", (4,)),
        ("friction_power_w", "f8", (4,)),
        ("normal_force_n", "f8", (8,)),  # 1L 1R 2L 2R ...
        ("longitudinal_force_n", "f8", (8,)),
        ("lateral_force_n", "f8", (8,)),
        ("rail_kept", "f8", (2, 8)),  # energy, sand: of the rails ahead of the wheels
        ("memory", "f8", (MEMORY, 8)),  # the wheels' friction memory
    ]
)


_row_at = record_reader(OBSERVATION)


@compiled
def observe(t_s: float, address: int, row_address: int) -> None:
    """Write the observation at time t and the solver's state into the row (dtype OBSERVATION) at `row_address`.

    `address` is that of the coach's record. What is overwritten there the next step works out anew: watching does not
    touch the run.
    """
    coach = coach_at(address)
    out = _row_at(row_address)
    shape = (coach.coordinates,)
    q, v = array_at(coach.solver_at[0], shape), array_at(coach.solver_at[1], shape)
    forces_on_rails(q, v, coach)
    coach.speeds[: coach.coordinates] = v
    out.t_s = t_s
    _observe_body(v, coach, out)
    _sum_up(coach, out)
    report, (ahead, aside), speeds = coach.report, from_frames(q, coach), speeds_along(v, coach)
    places = lanes_at(coach.frame_s, 0) + ahead
    put_four(out.wheelset_position_m, 0, places)
    put_four(out.lateral_displacement_m, 0, aside)
    put_four(out.wheelset_speed_mps, 0, speeds)
    out.position_m, out.speed_mps = lane(places, BODY_FRAME), lane(speeds, BODY_FRAME)
    put_lanes(out.normal_force_n, 0, lanes_at(report, NORMAL * LANES))
    put_lanes(out.longitudinal_force_n, 0, lanes_at(report, LONGITUDINAL * LANES))
    put_lanes(out.lateral_force_n, 0, lanes_at(report, LATERAL * LANES))
    put_wheelsets(out.friction_power_w, 0, 1, lanes_at(report, SLIDE_POWER * LANES))
    put_lanes(out.rail_kept, 0, lanes_at(coach.condition, ENERGY * LANES))
    put_lanes(out.rail_kept, LANES, lanes_at(coach.condition, SAND * LANES))
    for k in range(MEMORY):
        put_lanes(out.memory, k * LANES, lanes_at(coach.memory, k * LANES))
    for i in range(4):
        radius_m = coach.contact.radius_m + 0.5 * (coach.oversize[i, 0] + coach.oversize[i, 1])
        out.rim_speed_mps[i] = v[42 + i] * radius_m
        out.wheel_angle_rad[i] = q[42 + i]
        out.brake_torque_nm[i] = coach.brake_torque[i]
        out.drive_torque_nm[i] = coach.drive[i]


@inlined
def _observe_body(v: Array, coach: Record, out: Record) -> None:
    """Motion of the carbody."""
    frame, r = coach.frame[:, BODY_FRAME], coach.rotation[:, :, 0]
    out.roll_rad = math.atan2(r[2, 1], r[2, 2])
    out.pitch_rad = -math.asin(min(max(r[2, 0], -1.0), 1.0))
    out.yaw_rad = math.atan2(r[1, 0], r[0, 0])
    force = lanes_at(coach.force, 0)
    for k in range(1, CLASSES):
        force = force + lanes_at(coach.force, k * MOST_ROWS)
    # in world axes; no array of three, which would be allocated each time
    per_mass = 1.0 / coach.mass[0]
    ax, ay, az = lane(force, 0) * per_mass, lane(force, 1) * per_mass, lane(force, 2) * per_mass
    out.acceleration_mps2 = ax * frame[3] + ay * frame[4] + az * frame[5]
    az += GRAVITY_MPS2
    for j in range(3):
        out.specific_force_mps2[j] = r[0, j] * ax + r[1, j] * ay + r[2, j] * az
        out.angular_rate_radps[j] = v[3 + j]
        out.angular_acceleration_radps2[j] = lane(force, 3 + j) / coach.inertia[0, j]


@inlined
def _sum_up(coach: Record, out: Record) -> None:
    """Energy, powers, momentum and external force of the whole coach; needs `coach.speeds`."""
    force, speeds, masses = coach.force, coach.speeds, coach.masses
    none = lanes_of(ZEROS)
    energy = none
    gravity = suspension = normal = creep = brake = drive = resistance = track_brake = none
    for at in range(0, coach.coordinates, LANES):
        v = lanes_at(speeds, at)
        energy = energy + lanes_at(masses, at) * v * v
        gravity = gravity + lanes_at(force, GRAVITY * MOST_ROWS + at) * v
        suspension = suspension + lanes_at(force, SUSPENSION * MOST_ROWS + at) * v
        normal = normal + lanes_at(force, CONTACT_NORMAL * MOST_ROWS + at) * v
        creep = creep + lanes_at(force, CREEP * MOST_ROWS + at) * v
        brake = brake + lanes_at(force, BRAKE * MOST_ROWS + at) * v
        drive = drive + lanes_at(force, DRIVE * MOST_ROWS + at) * v
        resistance = resistance + lanes_at(force, RESISTANCE * MOST_ROWS + at) * v
        track_brake = track_brake + lanes_at(force, TRACK_BRAKE * MOST_ROWS + at) * v
    out.kinetic_energy_j = 0.5 * total(energy)
    for k, power in enumerate((gravity, suspension, normal, creep, brake, drive, resistance, track_brake)):
        out.power_w[k] = total(power)
    momentum = external = none
    for i in range(coach.bodies):
        at = place_of(i)
        momentum = momentum + lanes_at(masses, at) * lanes_at(speeds, at)
        for k in (GRAVITY, CONTACT_NORMAL, CREEP, RESISTANCE, TRACK_BRAKE):
            external = external + lanes_at(force, k * MOST_ROWS + at)
    for j in range(3):
        out.momentum_ns[j] = lane(momentum, j)
        out.external_force_n[j] = lane(external, j)
