"""Where a rigid wheelset stands on two rigid rails, compiled.

A wheel is a surface of revolution, a rail a prism along x. They can touch only where the wheel's normal is square to x.
Each circle of the wheel has one such point below the axle; together these points are the locus (Wang's trace). Seen
along x the locus is a plane curve and its contact with the rail a plane problem: exact for any yaw.

Both sides are solved in outward coordinates, y from the track centre towards the side: the right wheel is a left wheel
with displacement, yaw and roll of opposite sign. z is up, from the tops of the rails.
"""

import math

import numpy as np

from wheel_rail.compiled import Array, compiled

# columns of a contact; `contact_geometry.ContactTable` says what they are
(
    ALONG, RADIUS, CONICITY, AHEAD, TRACK_Y, TRACK_Z, ANGLE, WHEEL_ROLLING, WHEEL_LATERAL, RAIL_LATERAL, TURN,
) = range(11)  # fmt: skip
COLUMNS = 11
# columns of the nodes of a wheel: along the axle from the wheelset's centre (m), radius (m), d(radius)/d(along),
# curvature of the profile (1/m, convex positive). Of a rail: y (m), z (m), dz/dy, curvature (1/m, convex positive)


@compiled
def axle_direction(yaw_rad: float, roll_rad: float) -> tuple[float, float, float]:
    """Unit vector of the axle to the left, turned by yaw about z, then by roll about the wheelset's own x."""
    return -math.sin(yaw_rad) * math.cos(roll_rad), math.cos(yaw_rad) * math.cos(roll_rad), math.sin(roll_rad)


@compiled
def locus(
    along: float, radius: float, slope: float, axle: tuple[float, float, float]
) -> tuple[float, float, float]:  # fmt: skip
    """The point of the locus on the circle at `along`, from the wheelset's centre: x, y, z (m).

    With e the axle and u the radial direction the surface's normal is u - slope e; its part along x must vanish:
    u_x = slope e_x.
    """
    ex, ey, ez = axle
    across = math.sqrt(1.0 - ex * ex)
    sine = slope * ex / across
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    x = along * ex + radius * sine * across
    y = along * ey + radius * (cosine * ez - sine * ex * ey) / across
    z = along * ez - radius * (cosine * ey + sine * ex * ez) / across
    return x, y, z


@compiled
def _hermite(share: float, width: float, start: float, end: float, start_slope: float, end_slope: float) -> float:
    """Cubic through both ends with their slopes."""
    rest = 1.0 - share
    return (
        start
        + share * share * (3.0 - 2.0 * share) * (end - start)
        + share * rest * width * (rest * start_slope - share * end_slope)
    )


@compiled
def overlaps(y_m: float, axle: tuple[float, float, float], wheel: Array, rail: Array, overlap: Array) -> int:
    """Height of the wheelset's centre (m) that each node of the wheel needs to clear the rail, into `overlap` (n,).

    It is -inf where there is no rail below the node. Returns the node that needs most.
    """
    best = 0
    k = 0
    last = rail.shape[0] - 2
    for j in range(wheel.shape[0]):
        _, y, z = locus(wheel[j, 0], wheel[j, 1], wheel[j, 2], axle)
        y += y_m
        if y < rail[0, 0] or y > rail[last + 1, 0]:
            overlap[j] = -np.inf
        else:
            # neighbours on the wheel stand above neighbours on the rail
            while k > 0 and y < rail[k, 0]:
                k -= 1
            while k < last and y > rail[k + 1, 0]:
                k += 1
            width = rail[k + 1, 0] - rail[k, 0]
            share = (y - rail[k, 0]) / width
            overlap[j] = _hermite(share, width, rail[k, 1], rail[k + 1, 1], rail[k, 2], rail[k + 1, 2]) - z
        if overlap[j] > overlap[best]:
            best = j
    return best


@compiled
def _describe(
    node: int, share: float, y_m: float, axle: tuple[float, float, float], wheel: Array, rail: Array, row: Array
) -> None:
    """Columns of the contact at `share` of the way from a wheel node to the next; the slope stands for the angle."""
    a, b = wheel[node], wheel[node + 1]
    width = b[0] - a[0]
    radius = _hermite(share, width, a[1], b[1], a[2], b[2])
    slope = a[2] + share * (b[2] - a[2])
    along = a[0] + share * width
    x, y, z = locus(along, radius, slope, axle)
    y += y_m
    k = min(max(int(np.searchsorted(rail[:, 0], y)) - 1, 0), rail.shape[0] - 2)
    t = (y - rail[k, 0]) / (rail[k + 1, 0] - rail[k, 0])
    cosine = 1.0 / math.sqrt(1.0 + slope * slope)
    row[ALONG] = along
    row[RADIUS] = radius
    row[CONICITY] = -slope
    row[AHEAD] = x
    row[TRACK_Y] = y
    row[TRACK_Z] = z
    row[ANGLE] = rail[k, 2] + t * (rail[k + 1, 2] - rail[k, 2])
    # normal section of a surface of revolution (Meusnier)
    row[WHEEL_ROLLING] = cosine / radius
    row[WHEEL_LATERAL] = a[3] + share * (b[3] - a[3])
    row[RAIL_LATERAL] = rail[k, 3] + t * (rail[k + 1, 3] - rail[k, 3])
    row[TURN] = math.asin(max(-1.0, min(1.0, axle[0] / cosine)))


@compiled
def contact_of_side(
    y_m: float, yaw_rad: float, roll_rad: float, wheel: Array, rail: Array, softness_m: float, overlap: Array,
    row: Array,
) -> float:  # fmt: skip
    """Height of the wheelset's centre (m) at which this side touches; the contact goes into `row` (COLUMNS,).

    nan if the side touches at the end of a profile. With `softness_m` = 0 the contact is the point that touches.
    Otherwise each node weighs w = exp(overlap/softness), the contact is the weighted mean of all, and the height is
    softness log(integral of w). So the contact moves smoothly from one place to another, and the mean slope stays the
    derivative of the height: a force along it does no work on closed paths.
    """
    axle = axle_direction(yaw_rad, roll_rad)
    best = overlaps(y_m, axle, wheel, rail, overlap)
    if best == 0 or best >= wheel.shape[0] - 1 or overlap[best - 1] == -np.inf or overlap[best + 1] == -np.inf:
        return np.nan
    height = overlap[best]
    if softness_m == 0.0:
        rise, fall = height - overlap[best - 1], height - overlap[best + 1]
        # vertex of the parabola through three nodes
        share = 0.5 * (rise - fall) / (rise + fall) if rise + fall > 0.0 else 0.0
        height += 0.25 * share * (rise - fall)
        if share < 0.0:
            _describe(best - 1, 1.0 + share, y_m, axle, wheel, rail, row)
        else:
            _describe(best, share, y_m, axle, wheel, rail, row)
    else:
        mean = np.zeros(COLUMNS)
        total = 0.0
        for j in range(wheel.shape[0] - 1):
            if overlap[j] > height - 30.0 * softness_m:
                weight = math.exp((overlap[j] - height) / softness_m) * (wheel[j + 1, 0] - wheel[j, 0])
                _describe(j, 0.0, y_m, axle, wheel, rail, row)
                total += weight
                for c in range(COLUMNS):
                    mean[c] += weight * row[c]
        for c in range(COLUMNS):
            row[c] = mean[c] / total
        # the constant lets a contact of relative curvature 10/m stand as high as a hard one
        height += softness_m * math.log(total / math.sqrt(2.0 * math.pi * softness_m / 10.0))
    row[TRACK_Z] += height
    row[ANGLE] = math.atan(row[ANGLE])
    return height


@compiled
def let_down(
    displacement_m: Array, yaw_rad: Array, left_wheel: Array, right_wheel: Array, left_rail: Array, right_rail: Array,
    softness_m: float, level: bool, contacts: Array, pose: Array,
) -> None:  # fmt: skip
    """Let the wheelset down on both rails for every yaw and displacement.

    `contacts` (yaws, displacements, 2, COLUMNS), `pose` (yaws, displacements, 2): roll (rad) and height of the centre
    (m); nan where a side touches at the end of a profile. A `level` wheelset does not roll: each side is let down by
    itself, and the height is the mean of both.
    """
    overlap = np.empty(max(left_wheel.shape[0], right_wheel.shape[0]))
    for p in range(yaw_rad.size):
        roll = 0.0
        for i in range(displacement_m.size):
            y, psi = displacement_m[i], yaw_rad[p]
            low, high = -0.2, 0.2
            left, right = np.nan, np.nan
            for _ in range(60):
                left = contact_of_side(y, psi, roll, left_wheel, left_rail, softness_m, overlap, contacts[p, i, 0])
                right = contact_of_side(
                    -y, -psi, -roll, right_wheel, right_rail, softness_m, overlap, contacts[p, i, 1]
                )
                miss = left - right
                # far below the precision of profiles, above rounding; nan ends the search too
                if level or not abs(miss) > 1e-11:
                    break
                if miss > 0.0:
                    low = roll
                else:
                    high = roll
                # rolling up lowers the height that the left side asks for and raises the right's, each by the arm of
                # its normal about the centre
                a, b = contacts[p, i, 0], contacts[p, i, 1]
                arms = a[TRACK_Y] + b[TRACK_Y]
                arms -= math.tan(a[ANGLE]) * (left - a[TRACK_Z]) + math.tan(b[ANGLE]) * (right - b[TRACK_Z])
                step = roll + miss / arms
                # where a contact jumps its arm jumps too, and Newton's step may leave the bracket
                roll = step if low < step < high else 0.5 * (low + high)
            pose[p, i, 0] = roll if math.isfinite(left + right) else np.nan
            pose[p, i, 1] = 0.5 * (left + right)
            if not math.isfinite(left + right):
                roll = 0.0
