"""Forces of springs, dampers, bump stops, links and anti-roll bars, compiled, for the pairs of bodies side by side.

Every element joins an upper and a lower body at two points that coincide at rest. Deflection and its speed are taken
in the upper body's axes: d = R_u^T (p_l - p_u); the force acts on both bodies at the lower point, which conserves
momentum, angular momentum and energy. A lane is a pair of bodies (`vehicle.pairs`).
"""

from vehicle.pairs import (
    BODY_LOWER,
    BODY_UPPER,
    DAMPING,
    KNOT,
    LOWER,
    OVER_DEFLECTION,
    OVER_SPEED,
    PLACES,
    POINT,
    PRELOAD,
    REST,
    SLOT,
    STIFFNESS,
    UPPER,
)
from vehicle.rotations import BODY_LANES
from wheel_rail.compiled import Array, Record, compiled, inlined
from wheel_rail.lane_arrays import add_at_places, lanes_at, of_places
from wheel_rail.lanes import LANES, Lanes, greater, where

Three = tuple[Lanes, Lanes, Lanes]


@compiled
def add_suspension(q: Array, v: Array, coach: Record, f: Array) -> None:
    """Add all element forces to the generalised force `f` (coordinates,); needs `body_frames`."""
    for batch in range(coach.batches):
        _add_between(batch, q, v, coach, f)


@inlined
def _three(array: Array, places: Array, first: int, shift: int) -> Three:
    """Three floats one after the other at each place."""
    return (
        of_places(array, places, first, shift),
        of_places(array, places, first, shift + 1),
        of_places(array, places, first, shift + 2),
    )


@inlined
def _row(rotation: Array, places: Array, first: int, row: int) -> Three:
    """A row of the rotation matrix of each body."""
    at = 3 * BODY_LANES * row
    return (
        of_places(rotation, places, first, at),
        of_places(rotation, places, first, at + BODY_LANES),
        of_places(rotation, places, first, at + 2 * BODY_LANES),
    )


@inlined
def _rows(rows: Array, first: int) -> Three:
    """Three rows of lanes."""
    return lanes_at(rows, LANES * first), lanes_at(rows, LANES * (first + 1)), lanes_at(rows, LANES * (first + 2))


@inlined
def _dot(a: Three, b: Three) -> Lanes:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def _cross(a: Three, b: Three) -> Three:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def _on_curves(x: Lanes, first: int, end: int, coach: Record) -> Lanes:
    """Force of the characteristics with the knots `first` to `end` (none: zero)."""
    size, above = abs(x), x >= 0.0
    force = x * 0.0
    for k in range(first, end):
        at = KNOT * LANES * k
        begin = where(above, lanes_at(coach.knot, at), lanes_at(coach.knot, at + 2 * LANES))
        slope = where(above, lanes_at(coach.knot, at + LANES), lanes_at(coach.knot, at + 3 * LANES))
        force = force + slope * greater(size - begin, 0.0)
    return where(above, force, -force)


@inlined
def _along(axis: int, deflection: Lanes, speed: Lanes, slot: int, coach: Record) -> Lanes:
    """Force of a slot's elements along one axis."""
    row = LANES * (SLOT * slot + axis)
    force = (
        lanes_at(coach.slot, row + LANES * STIFFNESS) * deflection + lanes_at(coach.slot, row + LANES * DAMPING) * speed
    )
    knots = coach.slot_knots[slot, axis]
    if knots[OVER_DEFLECTION, 1] > knots[OVER_DEFLECTION, 0]:
        force = force + _on_curves(deflection, knots[OVER_DEFLECTION, 0], knots[OVER_DEFLECTION, 1], coach)
    if knots[OVER_SPEED, 1] > knots[OVER_SPEED, 0]:
        force = force + _on_curves(speed, knots[OVER_SPEED, 0], knots[OVER_SPEED, 1], coach)
    return force


@compiled
def _add_between(batch: int, q: Array, v: Array, coach: Record, f: Array) -> None:
    """Add the forces of a batch of pairs; everything is summed in the upper bodies' axes."""
    places = coach.pair_place
    first = LANES * PLACES * batch
    at_u, at_w = first + LANES * UPPER, first + LANES * LOWER
    rotation = coach.rotation
    upper, lower = first + LANES * BODY_UPPER, first + LANES * BODY_LOWER
    # rows of the rotations: what the world's axes are in the bodies'
    ux, uy, uz = (
        _row(rotation, places, upper, 0), _row(rotation, places, upper, 1), _row(rotation, places, upper, 2)
    )  # fmt: skip
    wx, wy, wz = (
        _row(rotation, places, lower, 0), _row(rotation, places, lower, 1), _row(rotation, places, lower, 2)
    )  # fmt: skip
    # the lower body in the upper one's axes: its axes, its centre, that one's speed, the rate of turn between them
    ahead, left, up = (
        _in_axes(ux, uy, uz, (wx[0], wy[0], wz[0])), _in_axes(ux, uy, uz, (wx[1], wy[1], wz[1])),
        _in_axes(ux, uy, uz, (wx[2], wy[2], wz[2])),
    )  # fmt: skip
    m0, m1, m2 = (ahead[0], left[0], up[0]), (ahead[1], left[1], up[1]), (ahead[2], left[2], up[2])
    centre = _in_axes(ux, uy, uz, _between(q, places, at_u, at_w))
    upper_turns = _three(v, places, at_u, 3)
    swept = _cross(upper_turns, centre)
    speed = _in_axes(ux, uy, uz, _between(v, places, at_u, at_w))
    speed = speed[0] - swept[0], speed[1] - swept[1], speed[2] - swept[2]
    lower_turns = _three(v, places, at_w, 3)
    turns = (
        _dot(m0, lower_turns) - upper_turns[0],
        _dot(m1, lower_turns) - upper_turns[1],
        _dot(m2, lower_turns) - upper_turns[2],
    )
    # small relative rotation of the lower body, and its rate
    resists = LANES * 6 * batch
    turning = coach.pair_turning
    tx = lanes_at(turning, resists) * (0.5 * (m2[1] - m1[2])) + lanes_at(turning, resists + 3 * LANES) * turns[0]
    ty = (
        lanes_at(turning, resists + LANES) * (0.5 * (m0[2] - m2[0])) + lanes_at(turning, resists + 4 * LANES) * turns[1]
    )
    tz = (
        lanes_at(turning, resists + 2 * LANES) * (0.5 * (m1[0] - m0[1]))
        + lanes_at(turning, resists + 5 * LANES) * turns[2]
    )
    force_x, force_y, force_z = tx * 0.0, tx * 0.0, tx * 0.0
    upper_x, upper_y, upper_z, lower_x, lower_y, lower_z = tx, ty, tz, tx, ty, tz  # moments about the two centres
    for slot in range(coach.pair_slots[batch, 0], coach.pair_slots[batch, 1]):
        row = SLOT * slot
        point, rest = _rows(coach.slot, row + POINT), _rows(coach.slot, row + REST)
        ax, ay, az = _dot(m0, point), _dot(m1, point), _dot(m2, point)
        bx, by, bz = centre[0] + ax, centre[1] + ay, centre[2] + az
        fx = _along(0, bx - rest[0], speed[0] + turns[1] * az - turns[2] * ay, slot, coach)
        fy = _along(1, by - rest[1], speed[1] + turns[2] * ax - turns[0] * az, slot, coach)
        fz = _along(2, bz - rest[2], speed[2] + turns[0] * ay - turns[1] * ax, slot, coach)
        fz = fz + lanes_at(coach.slot, LANES * (row + PRELOAD))
        force_x, force_y, force_z = force_x + fx, force_y + fy, force_z + fz
        about_upper, about_lower = _cross((bx, by, bz), (fx, fy, fz)), _cross((ax, ay, az), (fx, fy, fz))
        upper_x, upper_y, upper_z = upper_x + about_upper[0], upper_y + about_upper[1], upper_z + about_upper[2]
        lower_x, lower_y, lower_z = lower_x + about_lower[0], lower_y + about_lower[1], lower_z + about_lower[2]
    force = force_x, force_y, force_z
    x, y, z = _dot(ux, force), _dot(uy, force), _dot(uz, force)
    add_at_places(f, places, at_u, 0, x)
    add_at_places(f, places, at_u, 1, y)
    add_at_places(f, places, at_u, 2, z)
    add_at_places(f, places, at_u, 3, upper_x)
    add_at_places(f, places, at_u, 4, upper_y)
    add_at_places(f, places, at_u, 5, upper_z)
    add_at_places(f, places, at_w, 0, -x)
    add_at_places(f, places, at_w, 1, -y)
    add_at_places(f, places, at_w, 2, -z)
    moment = lower_x, lower_y, lower_z
    add_at_places(f, places, at_w, 3, -_dot(ahead, moment))
    add_at_places(f, places, at_w, 4, -_dot(left, moment))
    add_at_places(f, places, at_w, 5, -_dot(up, moment))


@inlined
def _between(array: Array, places: Array, at_u: int, at_w: int) -> Three:
    """The first three coordinates of the lower bodies less those of the upper ones."""
    u, w = _three(array, places, at_u, 0), _three(array, places, at_w, 0)
    return w[0] - u[0], w[1] - u[1], w[2] - u[2]


@inlined
def _in_axes(x: Three, y: Three, z: Three, vector: Three) -> Three:
    """A vector of the world in the axes of the bodies with these rows of rotation."""
    return (
        x[0] * vector[0] + y[0] * vector[1] + z[0] * vector[2],
        x[1] * vector[0] + y[1] * vector[1] + z[1] * vector[2],
        x[2] * vector[0] + y[2] * vector[1] + z[2] * vector[2],
    )
