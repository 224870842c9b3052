"""Profiles of wheels and rails as smooth curves, by name or from a file.

Wheel: y from the tape circle, flange at negative y, z positive downwards. Rail: gauge side at negative y, z positive
downwards. Standards give a profile as arcs and lines, whose curvature jumps where they meet, and measured points are
noisy: neither has a usable second derivative. Every profile is therefore smoothed along its own length.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.ndimage import gaussian_filter1d

from wheel_rail.profile_files import read_profile_points
from wheel_rail.profile_shapes import en15302_rail_a, en15302_wheel_a, s1002, uic60, uic60_en15302

NODE_M = 5e-5  # spacing of the nodes along the curve
SMOOTHING_M = 2.5e-4  # well below the length of a contact patch (about 1e-2 m), well above the spacing of the nodes
STEEPEST = 5.0  # contact is sought where the slope stays below this (79 degrees; flanges stand at 70)


@dataclass(frozen=True)
class Profile:
    """A profile in nodes `NODE_M` apart along the curve, from the flange or gauge side outwards.

    `y_m`, `z_m` (n,): the curve, z positive downwards; `angle_rad` (n,): of the tangent, tan = dz/dy; `curvature_1pm`
    (n,): d(angle)/d(length). Curvature is positive where the metal of a rail is convex and that of a wheel is hollow.
    """

    y_m: np.ndarray
    z_m: np.ndarray
    angle_rad: np.ndarray
    curvature_1pm: np.ndarray

    def between_walls(self) -> "Profile":
        """The longest stretch in which |dz/dy| < `STEEPEST`: there the curve is a function z(y)."""
        gentle = np.concatenate([[False], np.abs(self.angle_rad) < np.arctan(STEEPEST), [False]])
        edges = np.flatnonzero(gentle[1:] != gentle[:-1]).reshape(-1, 2)
        start, end = edges[np.argmax(edges[:, 1] - edges[:, 0])]
        return self.part(int(start), int(end))

    def part(self, start: int, end: int) -> "Profile":
        """The nodes start..end-1."""
        cut = slice(start, end)
        return Profile(self.y_m[cut], self.z_m[cut], self.angle_rad[cut], self.curvature_1pm[cut])

    def turned(self, angle_rad: float) -> "Profile":
        """Turned about the origin, positive from y to z (the side of positive y sinks), then lifted to z = 0 on top."""
        c, s = np.cos(angle_rad), np.sin(angle_rad)
        y, z = c * self.y_m - s * self.z_m, s * self.y_m + c * self.z_m
        return Profile(y, z - np.min(z), self.angle_rad + angle_rad, self.curvature_1pm)


def smooth_profile(points_mm: np.ndarray, smoothing_m: float = SMOOTHING_M) -> Profile:
    """Profile through points (n, 2), y and z in mm, in order from negative to positive y.

    The polygon of the points is read at equal steps of length and y and z are each filtered along it by 2 G - G G,
    G the Gaussian of standard deviation `smoothing_m`. The filter leaves cubic curves alone (G by itself would shift
    an arc of radius R towards its centre by smoothing^2/2R); derivatives are those of the filter. Where two arcs meet,
    curvature passes from one to the other within about +-2 `smoothing_m`. Raises ValueError for a `smoothing_m`
    outside 0.15..5 mm.
    """
    if not 1.5e-4 <= smoothing_m <= 5e-3:
        raise ValueError(f"smoothing_m = {smoothing_m}: must lie within 0.00015..0.005")
    points = np.asarray(points_mm, dtype=float) / 1000.0
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    n = max(int(np.ceil(length[-1] / NODE_M)), 2)
    step = length[-1] / n
    at = np.linspace(0.0, length[-1], n + 1)
    polygon = np.stack([np.interp(at, length, column) for column in points.T])
    # beyond its ends the curve goes on point-symmetrically, which keeps ends and tangents in place
    reach = min(int(np.ceil(12.0 * smoothing_m / step)), n)
    before = 2.0 * polygon[:, :1] - polygon[:, reach:0:-1]
    after = 2.0 * polygon[:, -1:] - polygon[:, -2 : -2 - reach : -1]
    padded = np.concatenate([before, polygon, after], axis=1)
    sigma = smoothing_m / step

    def filtered(order: int) -> np.ndarray:
        once = gaussian_filter1d(padded, sigma, axis=1, order=order, truncate=6.0)
        twice = gaussian_filter1d(once, sigma, axis=1, truncate=6.0)
        return (2.0 * once - twice)[:, reach : reach + n + 1] / step**order

    (y, z), (y1, z1), (y2, z2) = filtered(0), filtered(1), filtered(2)
    return Profile(y, z, np.arctan2(z1, y1), (y1 * z2 - z1 * y2) / np.hypot(y1, z1) ** 3)


def wheel_profile(name: str, smoothing_m: float = SMOOTHING_M) -> Profile:
    """Wheel profile of `WHEEL_PROFILES` or from the file of that name. Raises ValueError, ProfileError."""
    return smooth_profile(_points(name, WHEEL_PROFILES, "wheel"), smoothing_m)


def rail_profile(name: str, inclination: float = 0.0, smoothing_m: float = SMOOTHING_M) -> Profile:
    """Rail profile of `RAIL_PROFILES` or from the file of that name, turned towards the track by `inclination`.

    `inclination` is a tangent: 1/40 for a rail laid at 1:40; 0 for a profile measured as it lies. z = 0 on top.
    Raises ValueError, ProfileError.
    """
    if not -0.2 <= inclination <= 0.2:
        raise ValueError(f"inclination = {inclination}: must lie within -0.2..0.2, 1:40 is 0.025")
    # leaning towards the track lowers the gauge side, which is the side of negative y
    return smooth_profile(_points(name, RAIL_PROFILES, "rail"), smoothing_m).turned(-np.arctan(inclination))


def gauge_point_y_m(rail: Profile, below_top_m: float = 0.014) -> float:
    """y of the gauge face: the innermost point within `below_top_m` under the top (EN 13848-1). Raises ValueError."""
    top = int(np.argmin(rail.z_m))
    inner = rail.z_m[: top + 1] - rail.z_m[top]
    if inner[0] < below_top_m:
        raise ValueError(
            f"the rail profile ends {1000 * inner[0]:.2f} mm below its top on the gauge side (negative y): "
            f"{1000 * below_top_m:g} mm are needed to measure the gauge"
        )
    last = int(np.flatnonzero(inner >= below_top_m)[-1])
    share = (inner[last] - below_top_m) / (inner[last] - inner[last + 1])
    at_depth = rail.y_m[last] + share * (rail.y_m[last + 1] - rail.y_m[last])
    return float(min(at_depth, np.min(rail.y_m[last + 1 : top + 1])))


def _points(name: str, table: dict[str, Callable[[], np.ndarray]], kind: str) -> np.ndarray:
    if name in table:
        return table[name]()
    if Path(name).suffix:
        return read_profile_points(Path(name), kind)
    raise ValueError(f"{kind} profile {name!r} is not known: one of {', '.join(table)}, or a file such as worn.txt")


WHEEL_PROFILES: dict[str, Callable[[], np.ndarray]] = {"s1002": s1002, "en15302-a": en15302_wheel_a}
RAIL_PROFILES: dict[str, Callable[[], np.ndarray]] = {
    "uic60": uic60,
    "uic60-en15302": uic60_en15302,
    "en15302-a": en15302_rail_a,
}
