"""The track frame anywhere on a line: at one place, or at those of a coach at once.

A frame is 14 numbers: position (3), tangent (3), left (3) and up (3) of the canted plane, roll slope (rad/m), curvature
(rad/m).
"""

from wheel_rail.compiled import Array, compiled, inlined
from wheel_rail.lane_arrays import lanes_at, of_wheels, put_lanes
from wheel_rail.lane_functions import over_root
from wheel_rail.lanes import LANES, Lanes
from wheel_rail.splines import between_nodes, hermite

NODE_M = 1.0  # spacing of the tabulated nodes

# columns of a line's table, one row per node
X, Y, Z, ROLL, TX, TY, TZ, ROLL_SLOPE, GRADIENT, CURVATURE = range(10)
COLUMNS = 10

FRAME_ROWS = 14
_TWIST, _BEND = 12, 13

_Three = tuple[Lanes, Lanes, Lanes]


@compiled
def track_frame(s_m: float, origin_m: float, table: Array, frame: Array) -> None:
    """Write the track frame at s into `frame` (14,).

    Position and roll are the cubics that the nodes' slopes belong to, with no jump up to the second derivative; beyond
    the table the end interval is continued.
    """
    k, u = _node(s_m, origin_m, table)
    p, q = table[k], table[k + 1]
    (h01, h10, h11), (d01, d10, d11) = hermite(u, NODE_M)
    for j in range(3):
        frame[j] = p[j] + h01 * (q[j] - p[j]) + h10 * p[TX + j] + h11 * q[TX + j]
        frame[j + 3] = d01 * (q[j] - p[j]) + d10 * p[TX + j] + d11 * q[TX + j]
    roll = p[ROLL] + h01 * (q[ROLL] - p[ROLL]) + h10 * p[ROLL_SLOPE] + h11 * q[ROLL_SLOPE]
    tangent, left, up = _axes(frame[3], frame[4], frame[5], roll)
    frame[3], frame[4], frame[5] = tangent
    frame[6], frame[7], frame[8] = left
    frame[9], frame[10], frame[11] = up
    frame[12] = d01 * (q[ROLL] - p[ROLL]) + d10 * p[ROLL_SLOPE] + d11 * q[ROLL_SLOPE]
    frame[13] = p[CURVATURE] + u * (q[CURVATURE] - p[CURVATURE])


@compiled
def track_frames(s_m: Array, count: int, origin_m: float, table: Array, frames: Array) -> None:
    """`track_frame` at the first `count` of the places `s_m`, a lane for each, into `frames` (14, LANES).

    Further lanes follow the last place.
    """
    for i in range(count):
        k, u = _node(s_m[i], origin_m, table)
        at = COLUMNS * k
        both = between_nodes(lanes_at(table, at), lanes_at(table, at + COLUMNS), hermite(u, NODE_M))
        put_lanes(frames, LANES * i, both)
        bend = table[k, CURVATURE]
        bend += u * (table[k + 1, CURVATURE] - bend)
        frames[_BEND, i] = bend
        if i == count - 1:
            for spare in range(count, LANES):
                put_lanes(frames, LANES * spare, both)
                frames[_BEND, spare] = bend
    centre = _column(frames, X), _column(frames, Y), _column(frames, Z)
    roll, twist = _column(frames, ROLL), _column(frames, ROLL_SLOPE)
    tangent, left, up = _axes(_column(frames, TX), _column(frames, TY), _column(frames, TZ), roll)
    for number, (x, y, z) in enumerate((centre, tangent, left, up)):
        at = 3 * LANES * number
        put_lanes(frames, at, x)
        put_lanes(frames, at + LANES, y)
        put_lanes(frames, at + 2 * LANES, z)
    put_lanes(frames, _TWIST * LANES, twist)


@inlined
def _column(frames: Array, number: int) -> Lanes:
    return of_wheels(frames, number, LANES)


@inlined
def _node(s_m: float, origin_m: float, table: Array) -> tuple[int, float]:
    """The node before s, and what is left of the way from it."""
    u = (s_m - origin_m) / NODE_M
    k = min(max(int(u), 0), table.shape[0] - 2)
    return k, u - k


@inlined
def _axes(x: Lanes, y: Lanes, z: Lanes, roll: Lanes) -> tuple[_Three, _Three, _Three]:
    """Unit vectors along (x, y, z), to the left and up, where the plane is turned by `roll` from the level."""
    # the slope of the spline has unit length but for some 1e-8
    scale = over_root(x * x + y * y + z * z - 1.0)
    tx, ty, tz = x * scale, y * scale, z * scale
    # level left (horizontal) and its companion up, then turned by the cant about the tangent
    flat = over_root(-tz * tz)
    lx, ly = -ty * flat, tx * flat
    ux, uy, uz = -tz * ly, tz * lx, tx * ly - ty * lx
    # sine and cosine to rounding up to 0.14 rad; a cant of 200 mm is a roll of 0.134 rad
    r2 = roll * roll
    s = roll * (1.0 - r2 / 6.0 * (1.0 - r2 / 20.0 * (1.0 - r2 / 42.0 * (1.0 - r2 / 72.0))))
    c = 1.0 - 0.5 * r2 * (1.0 - r2 / 12.0 * (1.0 - r2 / 30.0 * (1.0 - r2 / 56.0 * (1.0 - r2 / 90.0))))
    return (tx, ty, tz), (c * lx + s * ux, c * ly + s * uy, s * uz), (c * ux - s * lx, c * uy - s * ly, c * uz)
