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
    way_ahead,
)
from vehicle.layout import CLASSES, coach_at
from vehicle.parameters import GRAVITY_MPS2
from vehicle.rotations import place_of
from wheel_rail.compiled import Array, array_at, compiled, inlined, record_reader
from wheel_rail.contact import LATERAL, LONGITUDINAL, NORMAL, SLIDE_POWER
from wheel_rail.recovery import CONDITION

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
        ("rail_condition", "f8", (2, 4, CONDITION)),
    ]
)


_row_at = record_reader(OBSERVATION)


@inlined
def _total(force: Array, coordinate: int) -> float:
    total = 0.0
    for k in range(CLASSES):
        total += force[k, coordinate]
    return total


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
    force = coach.force
    out.t_s = t_s
    frame = coach.frame[4]
    out.position_m = coach.frame_s[4] + way_ahead(q, 0, frame)
    speed = v[0] * frame[3] + v[1] * frame[4] + v[2] * frame[5]
    out.speed_mps = speed
    r = coach.rotation[0]
    out.roll_rad = math.atan2(r[2, 1], r[2, 2])
    out.pitch_rad = -math.asin(min(max(r[2, 0], -1.0), 1.0))
    out.yaw_rad = math.atan2(r[1, 0], r[0, 0])

    # of the carbody, world axes; no array of three, which would be allocated each time
    ax, ay, az = _total(force, 0) / coach.mass[0], _total(force, 1) / coach.mass[0], _total(force, 2) / coach.mass[0]
    out.acceleration_mps2 = ax * frame[3] + ay * frame[4] + az * frame[5]
    az += GRAVITY_MPS2
    for j in range(3):
        out.specific_force_mps2[j] = r[0, j] * ax + r[1, j] * ay + r[2, j] * az
        out.angular_rate_radps[j] = v[3 + j]
        out.angular_acceleration_radps2[j] = _total(force, 3 + j) / coach.inertia[0, j]

    energy = 0.0
    for j in range(3):
        out.momentum_ns[j] = 0.0
        out.external_force_n[j] = 0.0
    for i in range(coach.bodies):
        at = place_of(i)
        for j in range(3):
            out.momentum_ns[j] += coach.mass[i] * v[at + j]
            out.external_force_n[j] += (
                force[GRAVITY, at + j]
                + force[CONTACT_NORMAL, at + j]
                + force[CREEP, at + j]
                + force[RESISTANCE, at + j]
                + force[TRACK_BRAKE, at + j]
            )
            energy += 0.5 * (coach.mass[i] * v[at + j] ** 2 + coach.inertia[i, j] * v[at + 3 + j] ** 2)
    for i in range(4):
        energy += 0.5 * coach.spin_inertia * v[42 + i] ** 2
    out.kinetic_energy_j = energy
    # side by side: one after the other, each sum would wait for its own last term
    gravity = suspension = normal = creep = brake = drive = resistance = track_brake = 0.0
    for j in range(coach.coordinates):
        gravity += force[GRAVITY, j] * v[j]
        suspension += force[SUSPENSION, j] * v[j]
        normal += force[CONTACT_NORMAL, j] * v[j]
        creep += force[CREEP, j] * v[j]
        brake += force[BRAKE, j] * v[j]
        drive += force[DRIVE, j] * v[j]
        resistance += force[RESISTANCE, j] * v[j]
        track_brake += force[TRACK_BRAKE, j] * v[j]
    powers = (gravity, suspension, normal, creep, brake, drive, resistance, track_brake)
    for k in range(len(powers)):
        out.power_w[k] = powers[k]

    for i in range(4):
        at = 18 + 6 * i
        frame = coach.frame[i]
        out.wheelset_position_m[i] = coach.frame_s[i] + way_ahead(q, at, frame)
        out.wheelset_speed_mps[i] = v[at] * frame[3] + v[at + 1] * frame[4] + v[at + 2] * frame[5]
        out.rim_speed_mps[i] = v[42 + i] * (
            coach.contact.radius_m + 0.5 * (coach.oversize[i, 0] + coach.oversize[i, 1])
        )
        out.wheel_angle_rad[i] = q[42 + i]
        out.lateral_displacement_m[i] = (
            (q[at] - frame[0]) * frame[6] + (q[at + 1] - frame[1]) * frame[7] + (q[at + 2] - frame[2]) * frame[8]
        )
        out.brake_torque_nm[i] = coach.brake_torque[i]
        out.drive_torque_nm[i] = coach.drive[i]
        out.friction_power_w[i] = 0.0
        for side in range(2):
            report = coach.report[:, 2 * i + side]
            out.normal_force_n[2 * i + side] = report[NORMAL]
            out.longitudinal_force_n[2 * i + side] = report[LONGITUDINAL]
            out.lateral_force_n[2 * i + side] = report[LATERAL]
            out.friction_power_w[i] += report[SLIDE_POWER]
            for k in range(CONDITION):
                out.rail_condition[side, i, k] = coach.condition[i, side, k]
