"""The linearised step: the forces at the predictor become those with which the masses alone make the implicit step.

Generalised-alpha with one linearised solve takes from the predictor the accelerations d of (c M + J) d = f, where
J = -(beta h^2 df/dq + gamma h df/dv) and c = (1 - alpha_m)/(1 - alpha_f). The solver knows the masses only and solves
c M d = f', so it is handed f' = S f with the response S = c M (c M + J)^-1, which is kept until the Jacobian J has
aged. In between S turns with the track: where the tangent of the track at the carbody has turned by T, all forces and
their slopes have turned with it, and S is T S T^T (turns and spins count in body axes).
"""

import numpy as np

from vehicle.inverse import invert
from vehicle.jacobian import fill_jacobian
from vehicle.layout import BODY_FRAME
from vehicle.rotations import place_of
from wheel_rail.compiled import Array, Record, aligned, array_at, compiled, inlined
from wheel_rail.lane_arrays import lanes_at, put_lanes
from wheel_rail.lanes import LANES

SPECTRAL_RADIUS = 0.1
ALPHA_M = (2.0 * SPECTRAL_RADIUS - 1.0) / (SPECTRAL_RADIUS + 1.0)
ALPHA_F = SPECTRAL_RADIUS / (SPECTRAL_RADIUS + 1.0)
GAMMA = 0.5 + ALPHA_F - ALPHA_M
BETA = 0.25 * (GAMMA + 0.5) ** 2
_C = (1.0 - ALPHA_M) / (1.0 - ALPHA_F)

_OTHER_YAW = 0.002
_AT_ONCE = 6 * LANES  # rows; one group of them holds a coach, two one with axle boxes of their own


@inlined
def _rows(coordinates: int) -> int:
    return -(-coordinates // _AT_ONCE) * _AT_ONCE


def room_for_response(coordinates: int) -> np.ndarray:
    """Array for `coach.response_at`: column by column, rows filled up with zeros to whole groups."""
    return aligned(np.zeros((coordinates, _rows.py_func(coordinates))))


@compiled
def new_response(step_s: float, coach: Record) -> bool:
    """Work out S at the predictor, where the forces have just been evaluated; False if the step has no solution."""
    coach.jacobians += 1
    n = coach.coordinates
    rows = _rows(n)
    jacobian = np.empty((n, n))
    factor_q, factor_v = BETA * step_s * step_s, GAMMA * step_s
    fill_jacobian(coach.ahead_q, coach.ahead_v, factor_q, factor_v, coach, jacobian)
    # column by column, as the inverse is wanted
    columns = array_at(coach.response_at, (n * rows,))
    for j in range(n):
        jacobian[j, j] += _C * coach.masses[j]
        for i in range(n):
            columns[j * rows + i] = jacobian[i, j]
        for i in range(n, rows):
            columns[j * rows + i] = 0.0
    if not invert(columns, rows):
        return False
    for j in range(n):
        for i in range(n):
            columns[j * rows + i] *= _C * coach.masses[i]
    coach.old_axes[:] = coach.frame[3:12, BODY_FRAME]
    for i in range(4):
        coach.old_yaw[i] = _yaw(i, coach)
    return True


@compiled
def respond(f: Array, coach: Record) -> None:
    """Turn the forces f (coordinates,) at the predictor into those that the solver is handed."""
    n = coach.coordinates
    rows = _rows(n)
    columns = array_at(coach.response_at, (n * rows,))
    asked, answer = coach.probe_force[0], coach.probe_force[1]
    for j in range(n):
        asked[j] = f[j]
    now, old = coach.frame[3:12, BODY_FRAME], coach.old_axes
    _turn(asked, now, old, coach)
    for first in range(0, rows, _AT_ONCE):
        r0 = lanes_at(columns, first) * asked[0]
        r1 = lanes_at(columns, first + LANES) * asked[0]
        r2 = lanes_at(columns, first + 2 * LANES) * asked[0]
        r3 = lanes_at(columns, first + 3 * LANES) * asked[0]
        r4 = lanes_at(columns, first + 4 * LANES) * asked[0]
        r5 = lanes_at(columns, first + 5 * LANES) * asked[0]
        for j in range(1, n):
            at = j * rows + first
            r0 = r0 + lanes_at(columns, at) * asked[j]
            r1 = r1 + lanes_at(columns, at + LANES) * asked[j]
            r2 = r2 + lanes_at(columns, at + 2 * LANES) * asked[j]
            r3 = r3 + lanes_at(columns, at + 3 * LANES) * asked[j]
            r4 = r4 + lanes_at(columns, at + 4 * LANES) * asked[j]
            r5 = r5 + lanes_at(columns, at + 5 * LANES) * asked[j]
        put_lanes(answer, first, r0)
        put_lanes(answer, first + LANES, r1)
        put_lanes(answer, first + 2 * LANES, r2)
        put_lanes(answer, first + 3 * LANES, r3)
        put_lanes(answer, first + 4 * LANES, r4)
        put_lanes(answer, first + 5 * LANES, r5)
    _turn(answer, old, now, coach)
    for j in range(n):
        f[j] = answer[j]


@inlined
def _turn(f: Array, from_axes: Array, to_axes: Array, coach: Record) -> None:
    """Turn the forces on the bodies' centres as the first three axes have to turn to become the other three."""
    u, t = from_axes, to_axes
    xx, xy, xz = _turned_row(t[0], t[3], t[6], u)
    yx, yy, yz = _turned_row(t[1], t[4], t[7], u)
    zx, zy, zz = _turned_row(t[2], t[5], t[8], u)
    for i in range(coach.bodies):
        at = place_of(i)
        x, y, z = f[at], f[at + 1], f[at + 2]
        f[at] = xx * x + xy * y + xz * z
        f[at + 1] = yx * x + yy * y + yz * z
        f[at + 2] = zx * x + zy * y + zz * z


@inlined
def _turned_row(ahead: float, left: float, up: float, axes: Array) -> tuple[float, float, float]:
    """The sum of three axes, so much of each."""
    return (
        ahead * axes[0] + left * axes[3] + up * axes[6],
        ahead * axes[1] + left * axes[4] + up * axes[7],
        ahead * axes[2] + left * axes[5] + up * axes[8],
    )


@compiled
def yaw_has_changed(coach: Record) -> bool:
    """Whether a wheelset's yaw to the track at the carbody is not what it was: in curves, and on the way into them."""
    changed = False
    for i in range(4):
        if abs(_yaw(i, coach) - coach.old_yaw[i]) > _OTHER_YAW:
            changed = True
    return changed


@compiled
def _yaw(i: int, coach: Record) -> float:
    """Sine of the angle from the track at the carbody to the rolling direction of wheelset i."""
    frame, rotation = coach.frame[:, BODY_FRAME], coach.rotation[:, :, 3 + i]
    return frame[6] * rotation[0, 0] + frame[7] * rotation[1, 0] + frame[8] * rotation[2, 0]
