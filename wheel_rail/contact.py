"""Forces between the wheelsets and the track: normal contact, creep and flange of all eight wheels, compiled.

A wheel is a surface of revolution about the axle; it touches the rail where its normal is perpendicular to the rail.
Where that is in the cross-section is read from a table over lateral displacement (`wheel_rail.contact_table`); yaw,
roll and the cant ramp are taken in here. The normal force is a unilateral spring and damper along that normal, the
creep force the law in force in the tangent plane.

The eight wheels are the lanes of `wheel_rail.lanes`: left and right wheel of the first wheelset, then of the second ...
"""

import math

import numpy as np

from wheel_rail.compiled import Array, Record, Vector, compiled, inlined
from wheel_rail.contact_table import (
    C11,
    C22,
    C23,
    COLUMNS,
    NODES,
    PLACE_ALONG,
    RAIL_Y,
    RAIL_Z,
    ROLLING_RADIUS,
    SEMI_AXIS_A,
    SEMI_AXIS_B,
    SLOPE,
    SPIN_FACTOR,
    STIFFNESS,
)
from wheel_rail.creep_laws import POLACH
from wheel_rail.lane_arrays import lanes_at, of_wheels, put_lanes
from wheel_rail.lane_functions import cube_root, over_root
from wheel_rail.lanes import LANES, Lanes, greater, lane, lanes_of, where
from wheel_rail.recovery import (
    CONDITION,
    DEGRADED,
    ENERGY,
    RECOVERED,
    TAU,
    adhesive_force,
    curves_of_wheels,
    polach_adhesion,
)

# What `wheel_contacts` is given of each wheel, rows of lanes: place of its wheelset's centre in the world, unit vector
# of the axle to the left, velocity of the centre, angular velocity of the wheelset without its part along the axle
# (3 each; m, m/s, rad/s), spin (rad/s), radius over the nominal one (m) and its change as the wheel turns (m/rad), the
# frame (14) of the track at the wheelset as the rail under this wheel has it; then room to work in.
PLACE, AXLE, VELOCITY, CARRIER_RATE, SPIN, GROWTH, GROWTH_SLOPE, FRAME, _READ = 0, 3, 6, 9, 12, 13, 14, 15, 29
_CHANGE, _WIDTH = COLUMNS, COLUMNS + LANES  # behind the columns, what the first ones change by from node to node
WHEEL = _READ + _WIDTH

# What `wheel_contacts` reports of each wheel, rows of lanes: forces (N), slopes of the creep force over the sliding
# velocity (Ns/m), power (W), sliding velocity along the rail (m/s), penetration (m); then, for the Jacobian: the
# directions along the rail and of the normal, the contact point from the wheelset's centre (3 each), the direction of
# the sliding velocity in the contact plane (2), the share of a change of load in the change of the creep force (2), the
# change of the rolling radius with lateral displacement, the normal stiffness (N/m), what the turning of the normal
# with lateral displacement adds to the lateral stiffness (N/m), and the sliding speed (m/s).
NORMAL, LONGITUDINAL, LATERAL, TANGENT, SECANT, SLIDE_POWER, SLIDE, PENETRATION = range(8)
ALONG, UPWARDS, POINT = 8, 11, 14
DIRECTION, LOAD_SHARE, RADIUS_SLOPE, NORMAL_STIFFNESS, NORMAL_TURN, SLIDE_SPEED = 17, 19, 21, 22, 23, 24
REPORT = 25


@inlined
def _row(rows: Array, number: int) -> Lanes:
    return lanes_at(rows, LANES * number)


@inlined
def _three(rows: Array, number: int) -> tuple[Lanes, Lanes, Lanes]:
    return _row(rows, number), _row(rows, number + 1), _row(rows, number + 2)


@inlined
def put_row(rows: Array, number: int, value: Lanes) -> None:
    """Write a row of lanes into an array (..., LANES)."""
    put_lanes(rows, LANES * number, value)


@compiled
def _read_table(displacement: Lanes, constants: Record, wheels: Array) -> None:
    """The table's row at each wheel's displacement, and how it changes to the next node, behind `_READ`.

    Beyond the table its ends hold.
    """
    node = (displacement - constants.first_m) * constants.nodes_per_m
    table = constants.table
    for w in range(LANES):
        u = lane(node, w)
        u = min(u, NODES - 1.0) if u > 0.0 else 0.0
        k = min(int(u), NODES - 2)
        u -= k
        row, at = COLUMNS * (NODES * (w % 2) + k), LANES * _READ + _WIDTH * w
        low = lanes_at(table, row)
        change = lanes_at(table, row + COLUMNS) - low
        put_lanes(wheels, at, low + u * change)
        put_lanes(wheels, at + _CHANGE, change)
        # the last columns in a register that has some of the first ones too
        low = lanes_at(table, row + COLUMNS - LANES)
        change = lanes_at(table, row + 2 * COLUMNS - LANES) - low
        put_lanes(wheels, at + COLUMNS - LANES, low + u * change)


@inlined
def _column(wheels: Array, column: int) -> Lanes:
    return of_wheels(wheels, LANES * _READ + column, _WIDTH)


@compiled
def wheel_contacts(
    wheels: Array, constants: Record, condition: Array, normal: Array, creep: Array, report: Array
) -> None:
    """Forces of all wheels on their wheelsets.

    `wheels` (WHEEL, LANES): see the constants above; `constants`: record of dtype CONTACT; `condition` (CONDITION,
    LANES): the rail's, under each wheel. Fills `normal` (7, LANES), the flange's
    force in it, and `creep` (7, LANES): force (3) in the world, moment about the wheelset's centre (3) without its part
    along the axle, and torque about the axle (1); and `report` (REPORT, LANES).
    """
    side = lanes_of((1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0))
    tx, ty, tz = _three(wheels, FRAME + 3)
    nx, ny, nz = _three(wheels, FRAME + 6)
    bx, by, bz = _three(wheels, FRAME + 9)
    ramp, curvature = _row(wheels, FRAME + 12), _row(wheels, FRAME + 13)
    ex, ey, ez = _three(wheels, AXLE)
    dx, dy, dz = _three(wheels, PLACE)
    dx, dy, dz = dx - _row(wheels, FRAME), dy - _row(wheels, FRAME + 1), dz - _row(wheels, FRAME + 2)
    spin_rate = _row(wheels, SPIN)
    # where wheel and rail touch at this displacement
    displacement = dx * nx + dy * ny + dz * nz
    _read_table(displacement, constants, wheels)
    along = side * _column(wheels, PLACE_ALONG)
    radius = _column(wheels, ROLLING_RADIUS) + _row(wheels, GROWTH)
    inward = -side * _column(wheels, SLOPE)
    half = side * _column(wheels, RAIL_Y)
    top = _column(wheels, RAIL_Z)
    # rail's own tangent: the cant ramp lifts one rail and lowers the other
    shorter = half * curvature  # below 0.01, so that 1/(1 - x) is 1 + x + x^2 to a millionth
    lift = half * ramp * (1.0 + shorter * (1.0 + shorter))
    scale = over_root(lift * lift)
    cx, cy, cz = (tx + lift * bx) * scale, (ty + lift * by) * scale, (tz + lift * bz) * scale
    # perpendicular to rail and axle, upwards; rolling direction of the wheel
    zx, zy, zz = cy * ez - cz * ey, cz * ex - cx * ez, cx * ey - cy * ex
    askew = ex * cx + ey * cy + ez * cz
    scale = over_root(-askew * askew)
    zx, zy, zz = zx * scale, zy * scale, zz * scale
    rx, ry, rz = ey * zz - ez * zy, ez * zx - ex * zz, ex * zy - ey * zx
    # a yawed wheel touches ahead of or behind the axle: turn the radial direction until the normal is square to the
    # rail (r c = 1/scale)
    ahead = -inward * askew * scale
    scale = over_root(ahead * ahead)
    zx, zy, zz = (zx + ahead * rx) * scale, (zy + ahead * ry) * scale, (zz + ahead * rz) * scale
    px, py, pz = along * ex - radius * zx, along * ey - radius * zy, along * ez - radius * zz
    # normal of the wheel at the contact, from the rail into the wheel
    scale = 1.0 / math.sqrt(1.0 + inward * inward)
    mx, my, mz = (zx + inward * ex) * scale, (zy + inward * ey) * scale, (zz + inward * ez) * scale
    depth = -(
        (dx + px - half * nx - top * bx) * mx
        + (dy + py - half * ny - top * by) * my
        + (dz + pz - half * nz - top * bz) * mz
    )
    # velocity of the wheel's material at the contact
    ox, oy, oz = _three(wheels, CARRIER_RATE)
    ox, oy, oz = ox + spin_rate * ex, oy + spin_rate * ey, oz + spin_rate * ez
    centre_x, centre_y, centre_z = _three(wheels, VELOCITY)
    vx, vy, vz = centre_x + oy * pz - oz * py, centre_y + oz * px - ox * pz, centre_z + ox * py - oy * px
    stiffness = _column(wheels, STIFFNESS)
    swelling = scale * _row(wheels, GROWTH_SLOPE)
    parting = vx * mx + vy * my + vz * mz - spin_rate * swelling
    load = stiffness * depth - constants.damping_nspm * parting
    lifted = (depth <= 0.0) | (load <= 0.0)
    load = where(lifted, 0.0, load)

    # creepages in the tangent plane: c along the rail, l = m x c to the left
    lx, ly, lz = my * cz - mz * cy, mz * cx - mx * cz, mx * cy - my * cx
    slide_c = vx * cx + vy * cy + vz * cz
    slide_l = vx * lx + vy * ly + vz * lz
    slide = math.sqrt(slide_c * slide_c + slide_l * slide_l)
    forward = abs(centre_x * tx + centre_y * ty + centre_z * tz)
    fastest = greater(forward, abs(spin_rate) * radius)
    per_speed = 1.0 / math.sqrt(fastest * fastest + constants.creep_speed_mps * constants.creep_speed_mps)
    # a wheel in the air is reckoned with as if it bore something, and its creep force left out
    carried = where(lifted, constants.reference_load_n, load)
    # the ellipse grows with the cube root of the load at constant ratio
    growth = cube_root(carried / constants.reference_load_n)
    patch = (
        growth * _column(wheels, SEMI_AXIS_A),
        growth * _column(wheels, SEMI_AXIS_B),
        _column(wheels, C11),
        _column(wheels, C22),
        _column(wheels, C23),
        _column(wheels, SPIN_FACTOR),
    )
    creep_c, creep_l = slide_c * per_speed, slide_l * per_speed
    spin = (ox * mx + oy * my + oz * mz) * per_speed
    if constants.law == POLACH:
        along_rail, across, tangent, secant = polach_adhesion(
            creep_c, creep_l, spin, slide, forward, carried, patch, curves_of_wheels(condition, DEGRADED),
            curves_of_wheels(condition, RECOVERED), _row(condition, TAU), _row(condition, ENERGY),
            constants.shear_modulus_pa,
        )  # fmt: skip
    else:
        _other_law(constants, creep_c, creep_l, spin, slide, forward, carried, patch, condition, report)
        along_rail, across = _row(report, LONGITUDINAL), _row(report, LATERAL)
        tangent, secant = _row(report, TANGENT), _row(report, SECANT)
    along_rail, across = where(lifted, 0.0, along_rail), where(lifted, 0.0, across)
    tangent, secant = where(lifted, 0.0, tangent * per_speed), where(lifted, 0.0, secant * per_speed)

    fx, fy, fz = load * mx, load * my, load * mz
    # the flange's lateral stop, an elastic force across the track at rail level, one radius below the axle
    play = greater(side * displacement - constants.flange_clearance_m, 0.0)
    push = -side * (constants.flange_stiffness_npm * play)
    gx, gy, gz = push * nx, push * ny, push * nz
    arm = -constants.radius_m
    put_row(normal, 0, fx + gx)
    put_row(normal, 1, fy + gy)
    put_row(normal, 2, fz + gz)
    # the normal of a surface of revolution meets its axis: no torque about the axle, unless the wheel is out of round
    put_row(normal, 3, py * fz - pz * fy + arm * (by * gz - bz * gy))
    put_row(normal, 4, pz * fx - px * fz + arm * (bz * gx - bx * gz))
    put_row(normal, 5, px * fy - py * fx + arm * (bx * gy - by * gx))
    put_row(normal, 6, 0.0 - load * swelling)
    fx, fy, fz = along_rail * cx + across * lx, along_rail * cy + across * ly, along_rail * cz + across * lz
    qx, qy, qz = py * fz - pz * fy, pz * fx - px * fz, px * fy - py * fx
    torque = qx * ex + qy * ey + qz * ez
    put_row(creep, 0, fx)
    put_row(creep, 1, fy)
    put_row(creep, 2, fz)
    put_row(creep, 3, qx - torque * ex)
    put_row(creep, 4, qy - torque * ey)
    put_row(creep, 5, qz - torque * ez)
    put_row(creep, 6, torque)

    put_row(report, NORMAL, load)
    put_row(report, LONGITUDINAL, along_rail)
    put_row(report, LATERAL, across)
    put_row(report, TANGENT, tangent)
    put_row(report, SECANT, secant)
    put_row(report, SLIDE_POWER, 0.0 - (along_rail * slide_c + across * slide_l))
    put_row(report, SLIDE, where(lifted, 0.0, slide_c))
    put_row(report, PENETRATION, depth)
    for k, value in enumerate((cx, cy, cz, mx, my, mz, px, py, pz)):
        put_row(report, ALONG + k, value)
    per_slide = where(slide > 0.0, 1.0 / slide, 0.0)
    put_row(report, DIRECTION, slide_c * per_slide)
    put_row(report, DIRECTION + 1, slide_l * per_slide)
    # F = limit g(creep/limit): what does not grow with the creep grows with the load
    rising = greater(tangent, 0.0)
    put_row(report, LOAD_SHARE, (along_rail + rising * slide_c) / carried)
    put_row(report, LOAD_SHARE + 1, (across + rising * slide_l) / carried)
    put_row(report, RADIUS_SLOPE, constants.nodes_per_m * _column(wheels, _CHANGE + ROLLING_RADIUS))
    put_row(report, NORMAL_STIFFNESS, stiffness)
    put_row(report, NORMAL_TURN, side * load * (constants.nodes_per_m * _column(wheels, _CHANGE + SLOPE)))
    put_row(report, SLIDE_SPEED, slide)


@compiled
def _other_law(
    constants: Record, creep_x: Lanes, creep_y: Lanes, spin_1pm: Lanes, slip_speed_mps: Lanes, speed_mps: Lanes,
    normal_force_n: Lanes, patch: Vector, condition: Array, report: Array,
) -> None:  # fmt: skip
    """Creep forces, tangents and secants over creep of any law, wheel by wheel, into their rows of `report`."""
    of_wheel = np.empty(CONDITION)
    for w in range(LANES):
        of_wheel[:] = condition[:, w]
        a, b, c11, c22, c23, spin_factor = patch
        ellipse = lane(a, w), lane(b, w), lane(c11, w), lane(c22, w), lane(c23, w), lane(spin_factor, w)
        report[LONGITUDINAL, w], report[LATERAL, w], report[TANGENT, w], report[SECANT, w] = adhesive_force(
            constants.law, constants.law_address, constants.law_extra,
            lane(creep_x, w), lane(creep_y, w), lane(spin_1pm, w), lane(slip_speed_mps, w), lane(speed_mps, w),
            lane(normal_force_n, w), ellipse, of_wheel, constants.shear_modulus_pa,
        )  # fmt: skip


@inlined
def lateral_offset(position: Array, frame: Array) -> float:
    """How far `position` lies to the left of the track frame's origin."""
    return (
        (position[0] - frame[0]) * frame[6] + (position[1] - frame[1]) * frame[7] + (position[2] - frame[2]) * frame[8]
    )
