"""Forces between one wheelset and the track: normal contact, creep and flange of both wheels, compiled.

A wheel is a surface of revolution about the axle; it touches the rail where its normal is perpendicular to the rail.
Where that is in the cross-section is read from a table over lateral displacement (`wheel_rail.contact_table`); yaw,
roll and the cant ramp are taken in here. The normal force is a unilateral spring and damper along that normal, the
creep force the law in force in the tangent plane.
"""

import math

import numpy as np

from wheel_rail.compiled import Array, Record, Vector, compiled, inlined
from wheel_rail.contact_table import (
    C11,
    C22,
    C23,
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
from wheel_rail.recovery import adhesive_force

# What `wheel_contact` reports for each wheel: forces (N), slopes of the creep force over the sliding velocity (Ns/m),
# power (W), sliding velocity along the rail (m/s), penetration (m); then, for the Jacobian: the directions along the
# rail and of the normal, the contact point from the wheelset's centre (3 each), the direction of the sliding velocity
# in the contact plane (2), the share of a change of load in the change of the creep force (2), the change of the
# rolling radius with lateral displacement, the normal stiffness (N/m), what the turning of the normal with lateral
# displacement adds to the lateral stiffness (N/m), and the sliding speed (m/s).
NORMAL, LONGITUDINAL, LATERAL, TANGENT, SECANT, SLIDE_POWER, SLIDE, PENETRATION = range(8)
ALONG, UPWARDS, POINT = 8, 11, 14
DIRECTION, LOAD_SHARE, RADIUS_SLOPE, NORMAL_STIFFNESS, NORMAL_TURN, SLIDE_SPEED = 17, 19, 21, 22, 23, 24
REPORT = 25


@inlined
def _over_root(x: float) -> float:
    """1/sqrt(1 + x^2) to rounding for the slopes of cant ramps and yawed cones, |x| < 0.01."""
    x2 = x * x
    return 1.0 - 0.5 * x2 * (1.0 - 0.75 * x2 * (1.0 - 5.0 / 6.0 * x2))


@inlined
def _under_root(x: float) -> float:
    """1/sqrt(1 - x^2) to 1e-9 for the sine of a yaw angle, |x| < 0.05."""
    x2 = x * x
    return 1.0 + 0.5 * x2 * (1.0 + 0.75 * x2 * (1.0 + 5.0 / 6.0 * x2))


@inlined
def table_place(displacement_m: float, constants: Record) -> tuple[int, float]:
    """Node of the table below the displacement, and how far on to the next; beyond the table its end."""
    u = (displacement_m - constants.first_m) * constants.nodes_per_m
    u = min(max(u, 0.0), NODES - 1.0)
    k = min(int(u), NODES - 2)
    return k, u - k


@compiled
def wheel_contact(
    side: int, position: Array, axle: Vector, velocity: Array, carrier_rate: Vector, spin_radps: float, frame: Array,
    constants: Record, condition: Array, growth_m: float, growth_mprad: float, normal: Array, creep: Array,
    report: Array,
) -> None:  # fmt: skip
    """Forces of one wheel (`side` +1 left, -1 right) on its wheelset.

    `position`, `velocity` (3,): wheelset centre in the world; `axle` (3,): unit vector of the axle to the left;
    `carrier_rate` (3,): angular velocity of the wheelset without its part along the axle, rad/s; `frame` (14,): the
    track at the wheelset; `constants`: record of dtype CONTACT; `condition` (CONDITION,): the rail's, under this wheel;
    `growth_m`: radius over the nominal one; `growth_mprad`: its change as the wheel turns.
    Adds to `normal` (7,) and `creep` (7,): force (3) in the world, moment about the centre (3) without its part along
    the axle, and torque about the axle (1). `report` (REPORT,): see the constants above.
    """
    tx, ty, tz = frame[3], frame[4], frame[5]
    nx, ny, nz = frame[6], frame[7], frame[8]
    bx, by, bz = frame[9], frame[10], frame[11]
    ex, ey, ez = axle[0], axle[1], axle[2]
    dx, dy, dz = position[0] - frame[0], position[1] - frame[1], position[2] - frame[2]
    # where wheel and rail touch at this displacement
    k, u = table_place(dx * nx + dy * ny + dz * nz, constants)
    low, high = constants.table[0 if side > 0 else 1, k], constants.table[0 if side > 0 else 1, k + 1]
    along = side * (low[PLACE_ALONG] + u * (high[PLACE_ALONG] - low[PLACE_ALONG]))
    radius = low[ROLLING_RADIUS] + u * (high[ROLLING_RADIUS] - low[ROLLING_RADIUS]) + growth_m
    inward = -side * (low[SLOPE] + u * (high[SLOPE] - low[SLOPE]))
    half = side * (low[RAIL_Y] + u * (high[RAIL_Y] - low[RAIL_Y]))
    top = low[RAIL_Z] + u * (high[RAIL_Z] - low[RAIL_Z])
    # rail's own tangent: the cant ramp lifts one rail and lowers the other
    shorter = half * frame[13]  # below 0.01, so that 1/(1 - x) is 1 + x + x^2 to a millionth
    lift = half * frame[12] * (1.0 + shorter * (1.0 + shorter))
    scale = _over_root(lift)
    cx, cy, cz = (tx + lift * bx) * scale, (ty + lift * by) * scale, (tz + lift * bz) * scale
    # perpendicular to rail and axle, upwards; rolling direction of the wheel
    zx, zy, zz = cy * ez - cz * ey, cz * ex - cx * ez, cx * ey - cy * ex
    askew = ex * cx + ey * cy + ez * cz
    scale = _under_root(askew)
    zx *= scale
    zy *= scale
    zz *= scale
    rx, ry, rz = ey * zz - ez * zy, ez * zx - ex * zz, ex * zy - ey * zx
    # a yawed wheel touches ahead of or behind the axle: turn the radial direction until the normal is square to the
    # rail (r c = 1/scale)
    ahead = -inward * askew * scale
    scale = _over_root(ahead)
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
    report[PENETRATION] = depth
    for j in range(PENETRATION):
        report[j] = 0.0
    if depth <= 0.0:
        return
    # velocity of the wheel's material at the contact
    ox, oy, oz = carrier_rate[0] + spin_radps * ex, carrier_rate[1] + spin_radps * ey, carrier_rate[2] + spin_radps * ez
    vx = velocity[0] + oy * pz - oz * py
    vy = velocity[1] + oz * px - ox * pz
    vz = velocity[2] + ox * py - oy * px
    stiffness = low[STIFFNESS] + u * (high[STIFFNESS] - low[STIFFNESS])
    swelling = scale * growth_mprad
    parting = vx * mx + vy * my + vz * mz - spin_radps * swelling
    load = stiffness * depth - constants.damping_nspm * parting
    if load <= 0.0:
        return
    fx, fy, fz = load * mx, load * my, load * mz
    normal[0] += fx
    normal[1] += fy
    normal[2] += fz
    # the normal of a surface of revolution meets its axis: no torque about the axle, unless the wheel is out of round
    normal[3] += py * fz - pz * fy
    normal[4] += pz * fx - px * fz
    normal[5] += px * fy - py * fx
    normal[6] -= load * swelling

    # creepages in the tangent plane: c along the rail, l = m x c to the left
    lx, ly, lz = my * cz - mz * cy, mz * cx - mx * cz, mx * cy - my * cx
    slide_c = vx * cx + vy * cy + vz * cz
    slide_l = vx * lx + vy * ly + vz * lz
    forward = abs(velocity[0] * tx + velocity[1] * ty + velocity[2] * tz)
    rim = abs(spin_radps) * radius
    fastest = forward if forward > rim else rim
    per_speed = 1.0 / math.sqrt(fastest * fastest + constants.creep_speed_mps * constants.creep_speed_mps)
    # the ellipse grows with the cube root of the load at constant ratio
    growth = np.cbrt(load / constants.reference_load_n)
    patch = (
        growth * (low[SEMI_AXIS_A] + u * (high[SEMI_AXIS_A] - low[SEMI_AXIS_A])),
        growth * (low[SEMI_AXIS_B] + u * (high[SEMI_AXIS_B] - low[SEMI_AXIS_B])),
        low[C11] + u * (high[C11] - low[C11]),
        low[C22] + u * (high[C22] - low[C22]),
        low[C23] + u * (high[C23] - low[C23]),
        low[SPIN_FACTOR] + u * (high[SPIN_FACTOR] - low[SPIN_FACTOR]),
    )
    spin = (ox * mx + oy * my + oz * mz) * per_speed
    slide = math.sqrt(slide_c * slide_c + slide_l * slide_l)
    along_rail, across, tangent, secant = adhesive_force(
        constants.law, constants.law_address, constants.law_extra,
        slide_c * per_speed, slide_l * per_speed, spin, slide, forward, load, patch, condition,
        constants.shear_modulus_pa,
    )  # fmt: skip
    fx, fy, fz = along_rail * cx + across * lx, along_rail * cy + across * ly, along_rail * cz + across * lz
    qx, qy, qz = py * fz - pz * fy, pz * fx - px * fz, px * fy - py * fx
    torque = qx * ex + qy * ey + qz * ez
    creep[0] += fx
    creep[1] += fy
    creep[2] += fz
    creep[3] += qx - torque * ex
    creep[4] += qy - torque * ey
    creep[5] += qz - torque * ez
    creep[6] += torque
    report[ALONG], report[ALONG + 1], report[ALONG + 2] = cx, cy, cz
    report[UPWARDS], report[UPWARDS + 1], report[UPWARDS + 2] = mx, my, mz
    report[POINT], report[POINT + 1], report[POINT + 2] = px, py, pz
    if slide > 0.0:
        share = 1.0 / slide
        report[DIRECTION], report[DIRECTION + 1] = slide_c * share, slide_l * share
    # F = limit g(creep/limit): what does not grow with the creep grows with the load
    tangent *= per_speed
    rising = tangent if tangent > 0.0 else 0.0
    per_load = 1.0 / load
    report[LOAD_SHARE] = (along_rail + rising * slide_c) * per_load
    report[LOAD_SHARE + 1] = (across + rising * slide_l) * per_load
    report[RADIUS_SLOPE] = (high[ROLLING_RADIUS] - low[ROLLING_RADIUS]) * constants.nodes_per_m
    report[NORMAL_STIFFNESS] = stiffness
    report[NORMAL_TURN] = side * load * (high[SLOPE] - low[SLOPE]) * constants.nodes_per_m
    report[SLIDE_SPEED] = slide
    report[NORMAL] = load
    report[LONGITUDINAL] = along_rail
    report[LATERAL] = across
    report[TANGENT] = tangent
    report[SECANT] = secant * per_speed
    report[SLIDE] = slide_c
    report[SLIDE_POWER] = -(along_rail * slide_c + across * slide_l)


@inlined
def lateral_offset(position: Array, frame: Array) -> float:
    """How far `position` lies to the left of the track frame's origin."""
    return (
        (position[0] - frame[0]) * frame[6] + (position[1] - frame[1]) * frame[7] + (position[2] - frame[2]) * frame[8]
    )


@compiled
def flange_force(position: Array, left: Array, right: Array, constants: Record, normal: Array) -> None:
    """Add the flanges' lateral stops to `normal` (7,): an elastic force along the track's lateral axis.

    `left`, `right` (14,): the track as the rail has it towards which the wheelset is displaced.
    """
    frame = left
    offset = lateral_offset(position, left)
    if offset < constants.flange_clearance_m:
        frame = right
        offset = min(lateral_offset(position, right), 0.0)
    play = abs(offset) - constants.flange_clearance_m
    if play > 0.0:
        force = -math.copysign(constants.flange_stiffness_npm * play, offset)
        normal[0] += force * frame[6]
        normal[1] += force * frame[7]
        normal[2] += force * frame[8]
        # it acts at rail level, one radius below the axle
        arm_x, arm_y, arm_z = (
            -constants.radius_m * frame[9],
            -constants.radius_m * frame[10],
            -constants.radius_m * frame[11],
        )
        fx, fy, fz = force * frame[6], force * frame[7], force * frame[8]
        normal[3] += arm_y * fz - arm_z * fy
        normal[4] += arm_z * fx - arm_x * fz
        normal[5] += arm_x * fy - arm_y * fx
