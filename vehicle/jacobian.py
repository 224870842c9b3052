"""The Jacobian that the implicit solver needs, analytic, at the state of the last evaluation of the forces.

It is -(df/dq factor_q + df/dv factor_v); turns are increments in body axes. Left out, because they are small against
mass over step squared: geometric stiffness, gyroscopic terms of the bodies, the turn of the contact's own axes, the
growing of wheels that are out of round, and the part of spin and of the difference between C11 and C22 in the direction
of the creep force.
"""

import math

from vehicle.layout import BODY_FRAME
from vehicle.suspension_jacobian import add_suspension_jacobian
from wheel_rail.compiled import Array, Record, compiled
from wheel_rail.contact import (
    ALONG,
    DIRECTION,
    FRAME,
    LOAD_SHARE,
    NORMAL,
    NORMAL_STIFFNESS,
    NORMAL_TURN,
    POINT,
    RADIUS_SLOPE,
    SECANT,
    TANGENT,
    UPWARDS,
    lateral_offset,
)


@compiled
def coach_jacobian(q: Array, v: Array, factor_q: float, factor_v: float, record: Record, jacobian: Array) -> None:
    """Fill `jacobian` (square); q, v (coordinates,) and the record are those of the last evaluation of the forces."""
    fill_jacobian(q, v, factor_q, factor_v, record[0], jacobian)


@compiled
def fill_jacobian(q: Array, v: Array, factor_q: float, factor_v: float, coach: Record, jacobian: Array) -> None:
    """As `coach_jacobian`, for compiled code."""
    jacobian[:, :] = 0.0
    add_suspension_jacobian(q, v, coach, factor_q, factor_v, jacobian)
    for i in range(4):
        for side in range(2):
            report = coach.report[:, 2 * i + side]
            coach.old_tangent[i, side] = report[TANGENT]
            coach.old_secant[i, side] = report[SECANT]
            coach.old_touch[i, side] = 1.0 if report[NORMAL] > 0.0 else 0.0
            if report[NORMAL] > 0.0:
                _add_contact(i, report, v[42 + i], factor_q, factor_v, coach, jacobian)
        _add_flange(i, q, factor_q, coach, jacobian)
        _add_spin(i, v, factor_q, factor_v, coach, jacobian)
    frame = coach.frame[:, BODY_FRAME]
    speed = abs(v[0] * frame[3] + v[1] * frame[4] + v[2] * frame[5])
    fall = 1.0 - math.tanh(speed / 0.1) ** 2
    slope = factor_v * (coach.resistance[0] * fall / 0.1 + coach.resistance[1] + 2.0 * speed * coach.resistance[2])
    for i in range(3):
        for j in range(3):
            jacobian[i, j] += slope * frame[3 + i] * frame[3 + j]


@compiled
def _row(row: Array, x: float, y: float, z: float, px: float, py: float, pz: float, rotation: Array) -> None:
    """How the point p of a wheelset moves along the unit vector (x, y, z) with its coordinates: row (7,).

    Three translations, three turns in body axes without their part about the axle, and the spin.
    """
    row[0], row[1], row[2] = x, y, z
    ax, ay, az = py * z - pz * y, pz * x - px * z, px * y - py * x
    row[3] = rotation[0, 0] * ax + rotation[1, 0] * ay + rotation[2, 0] * az
    row[4] = 0.0
    row[5] = rotation[0, 2] * ax + rotation[1, 2] * ay + rotation[2, 2] * az
    row[6] = rotation[0, 1] * ax + rotation[1, 1] * ay + rotation[2, 1] * az


@compiled
def _add_contact(
    i: int, report: Array, spin_radps: float, factor_q: float, factor_v: float, coach: Record, jacobian: Array
) -> None:
    """One wheel: with G the rows along the contact's axes, G^T times the change of its three forces."""
    rotation = coach.rotation[:, :, 3 + i]
    rows = coach.probe_rows
    along, across, normal = rows[0], rows[1], rows[2]
    cx, cy, cz = report[ALONG], report[ALONG + 1], report[ALONG + 2]
    mx, my, mz = report[UPWARDS], report[UPWARDS + 1], report[UPWARDS + 2]
    lx, ly, lz = my * cz - mz * cy, mz * cx - mx * cz, mx * cy - my * cx
    px, py, pz = report[POINT], report[POINT + 1], report[POINT + 2]
    _row(along, cx, cy, cz, px, py, pz, rotation)
    _row(across, lx, ly, lz, px, py, pz, rotation)
    _row(normal, mx, my, mz, px, py, pz, rotation)
    contact = coach.contact
    stiffness = factor_q * report[NORMAL_STIFFNESS] + factor_v * contact.damping_nspm
    # the rim's velocity changes with the rolling radius, and turns with the wheelset about the normal
    rim = spin_radps * (rotation[0, 1] * (py * cz - pz * cy) + rotation[1, 1] * (pz * cx - px * cz)
                        + rotation[2, 1] * (px * cy - py * cx))  # fmt: skip
    slide_c, slide_l = rows[3], rows[4]
    widening = factor_q * spin_radps * report[RADIUS_SLOPE]
    for k in range(7):
        slide_c[k] = factor_v * along[k]
        slide_l[k] = factor_v * across[k]
    slide_c[0] -= widening * lx
    slide_c[1] -= widening * ly
    slide_c[2] -= widening * lz
    for j in range(3):
        slide_l[3 + j] += factor_q * rim * (rotation[0, j] * mx + rotation[1, j] * my + rotation[2, j] * mz)
    # slope of the creep force: the tangent along the sliding velocity, the secant across it; and along it too while the
    # wheelset regains its grip, for a step with the secant ends before zero slip
    ec, el = report[DIRECTION], report[DIRECTION + 1]
    secant = report[SECANT]
    bend = 0.0 if coach.regaining[i] > 0.0 else report[TANGENT] - secant
    cc, cl, ll = secant + bend * ec * ec, bend * ec * el, secant + bend * el * el
    share_c, share_l = report[LOAD_SHARE], report[LOAD_SHARE + 1]
    turn = factor_q * report[NORMAL_TURN]
    for b in range(7):
        push = stiffness * normal[b]
        drag_c = cc * slide_c[b] + cl * slide_l[b] + share_c * push
        drag_l = cl * slide_c[b] + ll * slide_l[b] + share_l * push
        if b < 3:
            drag_l += turn * across[b]
        column = 18 + 6 * i + b if b < 6 else 42 + i
        for a in range(6):
            jacobian[18 + 6 * i + a, column] += along[a] * drag_c + across[a] * drag_l + normal[a] * push
        jacobian[42 + i, column] += along[6] * drag_c + across[6] * drag_l


@compiled
def _add_flange(i: int, q: Array, factor_q: float, coach: Record, jacobian: Array) -> None:
    """The flange's lateral stop of wheelset i, at rail level."""
    at = 18 + 6 * i
    frame = coach.wheels[FRAME : FRAME + 14, 2 * i]
    contact = coach.contact
    if lateral_offset(q[at : at + 3], frame) <= contact.flange_clearance_m:
        frame = coach.wheels[FRAME : FRAME + 14, 2 * i + 1]
        if lateral_offset(q[at : at + 3], frame) >= -contact.flange_clearance_m:
            return
    row = coach.probe_rows[0]
    radius = contact.radius_m
    _row(row, frame[6], frame[7], frame[8], -radius * frame[9], -radius * frame[10], -radius * frame[11],
         coach.rotation[:, :, 3 + i])  # fmt: skip
    stiffness = factor_q * contact.flange_stiffness_npm
    for a in range(6):
        for b in range(3):
            jacobian[at + a, at + b] += stiffness * row[a] * row[b]


@compiled
def _add_spin(i: int, v: Array, factor_q: float, factor_v: float, coach: Record, jacobian: Array) -> None:
    """Brake of wheelset i while it sticks, and the gyroscopic coupling of its spin."""
    at, spin_at = 18 + 6 * i, 42 + i
    coach.old_stuck[i] = coach.stuck[i]
    if coach.stuck[i] > 0.0:
        stiffness = factor_q * coach.caliper_stiffness + factor_v * coach.caliper_damping
        jacobian[spin_at, spin_at] += stiffness
        rotation = coach.rotation[:, :, 3 + i]
        frame_rotation = coach.rotation[:, :, coach.bogie_of[i]]
        for j in range(3):
            along = 0.0
            for m in range(3):
                along += frame_rotation[m, j] * rotation[m, 1]
            jacobian[6 * coach.bogie_of[i] + 3 + j, spin_at] -= stiffness * along
    momentum = coach.spin_inertia * v[spin_at]
    jacobian[at + 3, at + 5] -= factor_v * momentum
    jacobian[at + 5, at + 3] += factor_v * momentum
    jacobian[at + 3, spin_at] -= factor_v * coach.spin_inertia * v[at + 5]
    jacobian[at + 5, spin_at] += factor_v * coach.spin_inertia * v[at + 3]
