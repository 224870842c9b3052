"""The line: centreline and cant in nodes 1 m apart, and the track frame that wheels find anywhere on it.

Frame: s along the centreline (top of rail level, midway between the rails), world x along the track at s = 0, y left,
z up. Cant turns the track plane about the centreline; positive cant has the right rail raised, as a left-hand curve
wants.

Precision: on 60 km coordinates are exact to some 1e-9 m (sums of as many pieces), and double precision resolves them
to 7e-12 m; on a contact of 1e8 N/m that is a noise of 1 mN.
"""

import math

import numpy as np
from scipy.interpolate import CubicSpline

from wheel_rail.alignment import breakpoints_m, curvature_radpm, gradient, heading_rad, roll_rad
from wheel_rail.compiled import Array, compiled
from wheel_rail.irregularities import Irregularities
from wheel_rail.track_parameters import RAIL_SPACING_M, TrackParameters

NODE_M = 1.0  # spacing of the tabulated nodes

# columns of the table, one row per node
X, Y, Z, TX, TY, TZ, ROLL, ROLL_SLOPE, GRADIENT, CURVATURE = range(10)


class Track:
    """A line as the compiled `track_frame` and `rail_offsets` read it.

    `table` (n, 10): position x, y, z (m), its derivative by s (3), roll of the track plane (rad, left rail up), its
    slope (rad/m), gradient (tangent of the slope angle), horizontal curvature (rad/m). The table reaches `APRON_M`
    beyond both ends, straight on, so that every wheelset of a coach on the line stands on track. `irregularities` are
    None on smooth rails; `rng` is what random ones are drawn from. Raises ValueError, with the key, for irregularities
    that do not fit.
    """

    APRON_M = 40.0

    def __init__(self, parameters: TrackParameters, rng: np.random.Generator | None = None) -> None:
        self.length_m = parameters.length_m
        self.origin_m = -self.APRON_M
        n = math.ceil(parameters.length_m + 2 * self.APRON_M) + 1
        s = self.origin_m + NODE_M * np.arange(n)
        self.table = np.zeros((n, 10))
        self.table[:, X : Z + 1], self.table[:, TX : TZ + 1] = _centreline(parameters, s)
        # kinks at the ends of cant ramps are rounded over two nodes, as the uniform cubic B-spline does
        roll = roll_rad(parameters, np.concatenate([s[:1] - NODE_M, s, s[-1:] + NODE_M]))
        self.table[:, ROLL] = (roll[:-2] + 4.0 * roll[1:-1] + roll[2:]) / 6.0
        self.table[:, ROLL_SLOPE] = (roll[2:] - roll[:-2]) / (2.0 * NODE_M)
        self.table[:, GRADIENT] = gradient(parameters, s)
        self.table[:, CURVATURE] = curvature_radpm(parameters, s)
        self.irregularities = (
            Irregularities.of(parameters.irregularities, parameters.length_m, rng)
            if parameters.irregularities is not None
            else None
        )

    def gradient_permille(self, s_m: np.ndarray) -> np.ndarray:
        """Gradient at the places `s_m`, per mille, positive uphill."""
        return 1000.0 * self._read(s_m, GRADIENT)

    def curvature_radpm(self, s_m: np.ndarray) -> np.ndarray:
        """Horizontal curvature at `s_m`, rad/m, positive to the left."""
        return self._read(s_m, CURVATURE)

    def cant_mm(self, s_m: np.ndarray) -> np.ndarray:
        """Cant at `s_m`, mm, positive with the right rail raised."""
        return -1000.0 * RAIL_SPACING_M * np.sin(self._read(s_m, ROLL))

    def _read(self, s_m: np.ndarray, column: int) -> np.ndarray:
        return np.interp(s_m, self.origin_m + NODE_M * np.arange(len(self.table)), self.table[:, column])


def _centreline(parameters: TrackParameters, nodes_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) at the nodes, zero at s = 0, and the slopes (n, 3) of the cubic spline through them.

    The tangent (heading and gradient are closed forms) is integrated by Gauss-Legendre from node to node and from
    breakpoint to breakpoint, so that what is integrated is smooth. s is arc length in space: the horizontal part of ds
    is ds cos(slope angle).
    """
    places = np.union1d(nodes_m, breakpoints_m(parameters))
    abscissa, weight = np.polynomial.legendre.leggauss(4)
    half = 0.5 * np.diff(places)
    points = (places[:-1] + half)[:, None] + half[:, None] * abscissa
    tangents = _tangent(parameters, points.ravel()).reshape(3, *points.shape)
    moved = half * (tangents @ weight)
    path = np.concatenate([np.zeros((3, 1)), np.cumsum(moved, axis=1)], axis=1)
    positions = (path - path[:, [np.searchsorted(places, 0.0)]])[:, np.searchsorted(places, nodes_m)].T
    ends = _tangent(parameters, nodes_m[[0, -1]]).T
    spline = CubicSpline(nodes_m, positions, bc_type=((1, ends[0]), (1, ends[1])))
    return positions, spline(nodes_m, 1)


def _tangent(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Unit tangent (3, n) at the places s (n,), which must not fall."""
    heading, rise = heading_rad(parameters, s_m), gradient(parameters, s_m)
    level = 1.0 / np.sqrt(1.0 + rise**2)
    return np.stack([np.cos(heading) * level, np.sin(heading) * level, rise * level])


@compiled
def track_frame(s_m: float, origin_m: float, table: Array, frame: Array) -> None:
    """Write the track frame at s into `frame` (14,): position (3), tangent t (3), left n (3), up b (3) of the canted
    plane, roll slope (rad/m), curvature (rad/m).

    Position and roll are the cubics that the nodes' slopes belong to, with no jump up to the second derivative; beyond
    the table the end interval is continued.
    """
    u = (s_m - origin_m) / NODE_M
    k = int(u)
    if k < 0:
        k = 0
    elif k > table.shape[0] - 2:
        k = table.shape[0] - 2
    u -= k
    p = table[k]
    q = table[k + 1]
    u2 = u * u
    h01 = u2 * (3.0 - 2.0 * u)
    h10 = u * (1.0 - u) * (1.0 - u) * NODE_M
    h11 = u2 * (u - 1.0) * NODE_M
    d01 = 6.0 * u * (1.0 - u) / NODE_M
    d10 = 1.0 - 4.0 * u + 3.0 * u2
    d11 = 3.0 * u2 - 2.0 * u
    for j in range(3):
        frame[j] = p[j] + h01 * (q[j] - p[j]) + h10 * p[j + 3] + h11 * q[j + 3]
        frame[j + 3] = d01 * (q[j] - p[j]) + d10 * p[j + 3] + d11 * q[j + 3]
    tx, ty, tz = frame[3], frame[4], frame[5]
    scale = 1.0 / math.sqrt(tx * tx + ty * ty + tz * tz)
    tx *= scale
    ty *= scale
    tz *= scale
    roll = p[6] + h01 * (q[6] - p[6]) + h10 * p[7] + h11 * q[7]
    frame[12] = d01 * (q[6] - p[6]) + d10 * p[7] + d11 * q[7]
    frame[13] = p[9] + u * (q[9] - p[9])
    # level left (horizontal) and its companion up, then turned by the cant about the tangent
    flat = 1.0 / math.sqrt(tx * tx + ty * ty)
    lx, ly = -ty * flat, tx * flat
    ux, uy, uz = -tz * ly, tz * lx, tx * ly - ty * lx
    c, s = math.cos(roll), math.sin(roll)
    frame[3], frame[4], frame[5] = tx, ty, tz
    frame[6], frame[7], frame[8] = c * lx + s * ux, c * ly + s * uy, s * uz
    frame[9], frame[10], frame[11] = c * ux - s * lx, c * uy - s * ly, c * uz
