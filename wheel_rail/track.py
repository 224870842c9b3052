"""The line: centreline and cant in nodes 1 m apart.

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
from wheel_rail.irregularities import Irregularities
from wheel_rail.track_frame import (
    COLUMNS,
    CURVATURE,
    GRADIENT,
    NODE_M,
    ROLL,
    ROLL_SLOPE,
    TX,
    TZ,
    X,
    Z,
)
from wheel_rail.track_parameters import RAIL_SPACING_M, TrackParameters


class Track:
    """A line as the compiled `track_frame` and `rail_offsets` read it.

    `table` (n, 10): position x, y, z (m) and roll of the track plane (rad, left rail up), their derivatives by s (4),
    gradient (tangent of the slope angle), horizontal curvature (rad/m). The table reaches `APRON_M`
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
        self.table = np.zeros((n, COLUMNS))
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
