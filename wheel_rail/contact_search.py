"""Where a rigid wheelset stands on two rigid rails, compiled.

A wheel is a surface of revolution, a rail a prism along x. They can touch only where the wheel's normal is square to x.
On each circle of the wheel there is one such point below the axle; together these points are the locus. Seen along x the
locus is a plane curve, and contact with the rail is a plane problem: exact for any yaw.

Both sides are solved in outward coordinates: y from the track centre towards the side, so that the right wheel is a left
wheel with displacement, yaw and roll of opposite sign.
"""

import math

import numpy as np

from wheel_rail.compiled import Array, compiled

# what is known of a side's contact, one column each (README of the columns: `contact_geometry.COLUMNS`)
(
    WHEEL_Y, RAIL_Y, ALONG, RADIUS, AHEAD, TRACK_Y, TRACK_Z, ANGLE,
    WHEEL_ROLLING, WHEEL_LATERAL, RAIL_LATERAL, TURN, CONICITY,
) = range(13)  # fmt: skip
COLUMNS = 13
# columns of the nodes of a wheel: along the axle from the wheelset's centre, radius, d(radius)/d(along), curvature
# columns of the nodes of a rail: y outwards from the track centre, height above the top, d(height)/dy, curvature


@compiled
def _locus(along: float, radius: float, slope: float, yaw_rad: float, roll_rad: float) -> tuple[float, float, float]:
    """Point of the locus from the wheelset's centre (x, y, z) on the circle at `along` with `radius` and its slope."""
    ex = -math.sin(yaw_rad) * math.cos(roll_rad)
    ey = math.cos(yaw_rad) * math.cos(roll_rad)
    ez = math.sin(roll_rad)
    q = math.sqrt(1.0 - ex * ex)
    # the surface's normal is radial direction - slope * axle; its part along x must vanish
    sine = slope * ex / q
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    x = along * ex + radius * sine * q
    y = along * ey + radius * (cosine * ez - sine * ex * ey) / q
    z = along * ez - radius * (cosine * ey + sine * ex * ez) / q
    return x, y, z


@compiled
def _rail_height(y: float, k: int, rail: Array) -> float:
    """Height of the rail at y within nodes k and k + 1 (cubic Hermite)."""
    width = rail[k + 1, 0] - rail[k, 0]
    t = (y - rail[k, 0]) / width
    rise = rail[k + 1, 1] - rail[k, 1]
    return rail[k, 1] + t * t * (3.0 - 2.0 * t) * rise + t * (1.0 - t) * width * (
        (1.0 - t) * rail[k, 2] - t * rail[k + 1, 2]
    )


@compiled
def required_height(
    y_m: float, yaw_rad: float, roll_rad: float, wheel: Array, rail: Array, overlap: Array
) -> tuple[float, int]:
    """Height of the wheelset's centre above the rail tops that this side needs, and the node of the wheel that touches.

    `overlap` (n,) receives the height that each node of the wheel asks for, -inf where there is no rail below it.
    """
    highest = -np.inf
    best = -1
    k = 0
    last = rail.shape[0] - 2
    for j in range(wheel.shape[0]):
        _, y, z = _locus(wheel[j, 0], wheel[j, 1], wheel[j, 2], yaw_rad, roll_rad)
        y += y_m
        if y < rail[0, 0] or y > rail[last + 1, 0]:
            overlap[j] = -np.inf
            continue
        while k > 0 and y < rail[k, 0]:
            k -= 1
        while k < last and y > rail[k + 1, 0]:
            k += 1
        overlap[j] = _rail_height(y, k, rail) - z
        if overlap[j] > highest:
            highest = overlap[j]
            best = j
    return highest, best


@compiled
def _at(
    node: int, share: float, y_m: float, yaw_rad: float, roll_rad: float, wheel: Array, rail: Array, row: Array
) -> None:
    """Columns of a contact at `share` of the way from wheel node to the next."""
    a, b = wheel[node], wheel[node + 1]
    width = b[0] - a[0]
    along = a[0] + share * width
    radius = a[1] + share * share * (3.0 - 2.0 * share) * (b[1] - a[1]) + share * (1.0 - share) * width * (
        (1.0 - share) * a[2] - share * b[2]
    )
    slope = a[2] + share * (b[2] - a[2])
    x, y, z = _locus(along, radius, slope, yaw_rad, roll_rad)
    y += y_m
    k = min(max(int(np.searchsorted(rail[:, 0], y)) - 1, 0), rail.shape[0] - 2)
    t = (y - rail[k, 0]) / (rail[k + 1, 0] - rail[k, 0])
    tilt = rail[k, 2] + t * (rail[k + 1, 2] - rail[k, 2])
    cosine = 1.0 / math.sqrt(1.0 + slope * slope)
    row[WHEEL_Y] = along
    row[RAIL_Y] = y
    row[ALONG] = along
    row[RADIUS] = radius
    row[AHEAD] = x
    row[TRACK_Y] = y
    row[TRACK_Z] = z
    row[ANGLE] = tilt
    row[WHEEL_ROLLING] = cosine / radius
    row[WHEEL_LATERAL] = a[3] + share * (b[3] - a[3])
    row[RAIL_LATERAL] = rail[k, 3] + t * (rail[k + 1, 3] - rail[k, 3])
    row[TURN] = -math.sin(yaw_rad) * math.cos(roll_rad) / cosine
    row[CONICITY] = -slope


@compiled
def contact_of_side(
    y_m: float, yaw_rad: float, roll_rad: float, wheel: Array, rail: Array, softness_m: float, overlap: Array, row: Array
) -> float:  # fmt: skip
    """Height that this side needs; its contact into `row` (COLUMNS,). nan if it touches at the end of a profile.

    With `softness_m` = 0 the contact is the point that touches. Otherwise every node weighs exp(overlap/softness) and
    the height is softness * log(mean of these weights over a length of 1 mm) above: the contact is the weighted mean,
    which moves smoothly from one point to another, and the angle remains the derivative of the height.
    """
    height, best = required_height(y_m, yaw_rad, roll_rad, wheel, rail, overlap)
    if best <= 0 or best >= wheel.shape[0] - 1 or overlap[best - 1] == -np.inf or overlap[best + 1] == -np.inf:
        return np.nan
    if softness_m == 0.0:
        before, after = overlap[best] - overlap[best - 1], overlap[best + 1] - overlap[best]
        # vertex of the parabola through three nodes
        share = 0.5 * (before + after) / (before - after) if before > after else 0.0
        height += 0.25 * share * (before + after)
        if share < 0.0:
            _at(best - 1, 1.0 + share, y_m, yaw_rad, roll_rad, wheel, rail, row)
        else:
            _at(best, share, y_m, yaw_rad, roll_rad, wheel, rail, row)
    else:
        mean = np.zeros(COLUMNS)
        total = 0.0
        for j in range(wheel.shape[0] - 1):
            if overlap[j] > height - 30.0 * softness_m:
                weight = math.exp((overlap[j] - height) / softness_m) * (wheel[j + 1, 0] - wheel[j, 0])
                _at(j, 0.0, y_m, yaw_rad, roll_rad, wheel, rail, row)
                total += weight
                for c in range(COLUMNS):
                    mean[c] += weight * row[c]
        for c in range(COLUMNS):
            row[c] = mean[c] / total
        height += softness_m * math.log(total / 1e-3)
    row[TRACK_Z] += height
    row[ANGLE] = math.atan(row[ANGLE])
    return height


@compiled
def stand(
    displacement_m: Array, yaw_rad: Array, left_wheel: Array, right_wheel: Array, left_rail: Array, right_rail: Array,
    softness_m: float, table: Array, pose: Array,
) -> None:  # fmt: skip
    """Let the wheelset down on both rails for every yaw and displacement.

    `table` (yaws, displacements, 2, COLUMNS), `pose` (yaws, displacements, 2): roll (rad) and height of the centre
    (m); nan where a side touches at the end of a profile.
    """
    overlap = np.empty(max(left_wheel.shape[0], right_wheel.shape[0]))
    for p in range(yaw_rad.size):
        roll = 0.0
        for i in range(displacement_m.size):
            y, psi = displacement_m[i], yaw_rad[p]
            if not math.isfinite(roll):
                roll = 0.0
            low, high = -0.2, 0.2
            for _ in range(60):
                left = contact_of_side(y, psi, roll, left_wheel, left_rail, softness_m, overlap, table[p, i, 0])
                right = contact_of_side(-y, -psi, -roll, right_wheel, right_rail, softness_m, overlap, table[p, i, 1])
                miss = left - right
                if not abs(miss) > 1e-12:
                    break
                # turning the left side up by d(roll) lowers what it asks for by its lever arm, the right the reverse
                if miss > 0.0:
                    low = roll
                else:
                    high = roll
                step = roll + miss / (table[p, i, 0, TRACK_Y] + table[p, i, 1, TRACK_Y])
                # where the contact jumps the lever jumps too: Newton's step may leave the bracket
                roll = step if low < step < high else 0.5 * (low + high)
            pose[p, i, 0] = roll if math.isfinite(miss) else np.nan
            pose[p, i, 1] = 0.5 * (left + right)
