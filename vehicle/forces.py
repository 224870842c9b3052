"""All forces on the coach in one compiled routine, by class.

Classes (rows of `force`): gravity, suspension, normal contact (with flange), creep, brake, drive, resistance, magnetic
track brake, gyroscopic terms of the turning bodies and spinning wheelsets. Their sum is the right-hand side of
M q'' = f; each class times the velocities is its power, so that energy is audited class by class.
"""

import math

from vehicle.layout import BODY_FRAME, CLASSES, MOST_ROWS
from vehicle.parameters import GRAVITY_MPS2
from vehicle.rails import find_rails
from vehicle.rotations import BODY_LANES, body_frames, place_of
from vehicle.suspension import add_suspension
from wheel_rail.adhesion_state import RailTables
from wheel_rail.compiled import Array, Record, compiled, inlined
from wheel_rail.contact import (
    AXLE,
    CARRIER_RATE,
    GROWTH,
    GROWTH_SLOPE,
    PLACE,
    SPIN,
    VELOCITY,
    put_row,
    wheel_contacts,
)
from wheel_rail.lane_arrays import lanes_at, of_wheelsets, put_lanes, put_wheelsets
from wheel_rail.lanes import LANES, ZEROS, Lanes, doubled, lanes_of

GRAVITY, SUSPENSION, CONTACT_NORMAL, CREEP, BRAKE, DRIVE, RESISTANCE, TRACK_BRAKE, GYROSCOPIC = range(CLASSES)

_FIRST_WHEELSET = 3  # among the bodies
_STANDING_MPS = 0.05  # below this speed the force of a track brake fades, so that it holds and does not push


@inlined
def _of_rotations(rotation: Array, row: int, column: int) -> Lanes:
    """An entry of the wheelsets' rotation matrices."""
    return doubled(lanes_at(rotation, (3 * row + column) * BODY_LANES + _FIRST_WHEELSET))


@compiled
def wheels_on_rails(q: Array, v: Array, coach: Record) -> None:
    """Contact forces of all wheels on their wheelsets, into `coach.force`; needs rotations and `find_rails`."""
    wheels, rotation = coach.wheels, coach.rotation
    for j in range(3):
        put_row(wheels, PLACE + j, of_wheelsets(q, 18 + j, 6))
        put_row(wheels, AXLE + j, _of_rotations(rotation, j, 1))
        put_row(wheels, VELOCITY + j, of_wheelsets(v, 18 + j, 6))
        x, z = _of_rotations(rotation, j, 0), _of_rotations(rotation, j, 2)
        put_row(wheels, CARRIER_RATE + j, x * of_wheelsets(v, 21, 6) + z * of_wheelsets(v, 23, 6))
    put_row(wheels, SPIN, of_wheelsets(v, 42, 1))
    normal, creep = coach.wheel_normal, coach.wheel_creep
    wheel_contacts(wheels, coach.contact, coach.condition, normal, creep, coach.report)
    force = coach.force
    for number in range(2):
        rows = normal if number == 0 else creep
        at = (CONTACT_NORMAL if number == 0 else CREEP) * MOST_ROWS
        a, b, c = lanes_at(rows, 3 * LANES), lanes_at(rows, 4 * LANES), lanes_at(rows, 5 * LANES)
        for j in range(3):
            put_wheelsets(force, at + 18 + j, 6, lanes_at(rows, j * LANES))
            # moments in body axes
            x, y, z = _of_rotations(rotation, 0, j), _of_rotations(rotation, 1, j), _of_rotations(rotation, 2, j)
            put_wheelsets(force, at + 21 + j, 6, x * a + y * b + z * c)
        put_wheelsets(force, at + 42, 1, lanes_at(rows, 6 * LANES))


@compiled
def _brake_torque(i: int, angle: float, spin_radps: float, coach: Record) -> tuple[float, float]:
    """Friction torque on wheelset i: an elastic caliper that slides at its capacity; and whether it sticks."""
    torque = -(
        coach.caliper_stiffness * (coach.wind_up[i] + angle - coach.angle[i]) + coach.caliper_damping * spin_radps
    )
    limit = coach.capacity[i]
    if torque > limit:
        return limit, 0.0
    if torque < -limit:
        return -limit, 0.0
    return torque, 1.0


@compiled
def _add_track_brake(b: int, v: Array, coach: Record, force: Array) -> None:
    """Friction of the magnets of bogie body b (1, 2) on the rails: along the track, at the rails' height."""
    front, rear = coach.frame[:, 2 * b - 2], coach.frame[:, 2 * b - 1]
    at = 6 * b
    speed = 0.0
    for j in range(3):
        speed += 0.5 * v[at + j] * (front[3 + j] + rear[3 + j])
    drag = coach.track_brake[b - 1] * math.tanh(speed / _STANDING_MPS)
    rotation = coach.rotation[:, :, b]
    for j in range(3):
        force[at + j] = -0.5 * drag * (front[3 + j] + rear[3 + j])
        about = 0.0
        for k in range(3):
            about += 0.5 * rotation[k, j] * (front[6 + k] + rear[6 + k])
        force[at + 3 + j] = drag * coach.track_brake_arm * about


@compiled
def _grow_wheels(q: Array, coach: Record) -> None:
    """How far out of round each wheel is where it touches the rail."""
    for i in range(4):
        for side in range(2):
            growth, slope = coach.oversize[i, side], 0.0
            for k in range(coach.harmonics[i, side]):
                harmonic = coach.harmonic[i, side, k]
                angle = harmonic[0] * q[42 + i] + harmonic[2]
                growth += harmonic[1] * math.cos(angle)
                slope -= harmonic[1] * harmonic[0] * math.sin(angle)
            coach.wheels[GROWTH, 2 * i + side], coach.wheels[GROWTH_SLOPE, 2 * i + side] = growth, slope


@compiled
def forces_by_class(q: Array, v: Array, coach: Record, track: Array, rail: RailTables) -> None:
    """Fill `coach.force` (CLASSES, coordinates); needs nothing but the state and the step memory of the brake."""
    find_rails(q, v, coach, track, rail)
    forces_on_rails(q, v, coach)


@compiled
def forces_on_rails(q: Array, v: Array, coach: Record) -> None:
    """`forces_by_class` on rails that have been found."""
    body_frames(q, coach)
    force = coach.force
    # the others write to the same places every time
    none = lanes_of(ZEROS)
    for k in (SUSPENSION, BRAKE, DRIVE, TRACK_BRAKE):
        for at in range(0, coach.coordinates, LANES):
            put_lanes(force, k * MOST_ROWS + at, none)
    if coach.uneven:
        _grow_wheels(q, coach)
    for i in range(coach.bodies):
        at = place_of(i)
        force[GRAVITY, at + 2] = -coach.mass[i] * GRAVITY_MPS2
        inertia = coach.inertia[i]
        x, y, z = v[at + 3], v[at + 4], v[at + 5]
        force[GYROSCOPIC, at + 3] = (inertia[1] - inertia[2]) * y * z
        force[GYROSCOPIC, at + 4] = (inertia[2] - inertia[0]) * z * x
        force[GYROSCOPIC, at + 5] = (inertia[0] - inertia[1]) * x * y
    add_suspension(q, v, coach, force[SUSPENSION])
    # running resistance at the carbody's centre, against its motion along the track
    frame = coach.frame[:, BODY_FRAME]
    speed = v[0] * frame[3] + v[1] * frame[4] + v[2] * frame[5]
    size = abs(speed)
    drag = coach.resistance[0] * math.tanh(size / 0.1) + size * (coach.resistance[1] + size * coach.resistance[2])
    drag = math.copysign(drag, speed)
    for j in range(3):
        force[RESISTANCE, j] = -drag * frame[3 + j]
    for b in range(1, 3):
        if coach.track_brake[b - 1] > 0.0:
            _add_track_brake(b, v, coach, force[TRACK_BRAKE])
    for i in range(4):
        at, spin_at, bogie = 18 + 6 * i, 42 + i, 6 * coach.bogie_of[i]
        rotation = coach.rotation[:, :, 3 + i]
        spin = v[spin_at]
        # torques on the spinning wheelset react on the bogie that carries caliper and gearbox
        torque, coach.stuck[i] = _brake_torque(i, q[spin_at], spin, coach)
        coach.brake_torque[i] = torque
        force[BRAKE, spin_at] = torque
        force[DRIVE, spin_at] = coach.drive[i]
        frame_rotation = coach.rotation[:, :, coach.bogie_of[i]]
        for j in range(3):
            along = (
                frame_rotation[0, j] * rotation[0, 1]
                + frame_rotation[1, j] * rotation[1, 1]
                + frame_rotation[2, j] * rotation[2, 1]
            )
            force[BRAKE, bogie + 3 + j] -= torque * along
            force[DRIVE, bogie + 3 + j] -= coach.drive[i] * along
        momentum = coach.spin_inertia * spin
        force[GYROSCOPIC, at + 3] += momentum * v[at + 5]
        force[GYROSCOPIC, at + 5] -= momentum * v[at + 3]
    wheels_on_rails(q, v, coach)


@compiled
def add_classes(coach: Record, f: Array) -> None:
    """Sum of the force classes into f (coordinates,)."""
    for j in range(coach.coordinates):
        total = 0.0
        for k in range(CLASSES):
            total += coach.force[k, j]
        f[j] = total


@compiled
def coach_force(q: Array, v: Array, f: Array, record: Record, track: Array, rail: RailTables) -> None:
    """Total generalised force f at state q, v, all (coordinates,)."""
    coach = record[0]
    forces_by_class(q, v, coach, track, rail)
    add_classes(coach, f)
