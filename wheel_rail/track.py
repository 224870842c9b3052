"""The line: horizontal alignment with clothoids and cant, vertical alignment with rounded gradient changes.

Frame: s along the centreline (top of rail level, midway between the rails), world x along the track at s = 0, y left,
z up. Cant turns the track plane about the centreline; positive cant has the right rail raised, as a left-hand curve
wants.
"""

import math
from typing import Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from wheel_rail.compiled import Array, compiled

RAIL_SPACING_M = 1.5  # between the rails' running lines; cant is measured over it
NODE_M = 1.0  # spacing of the tabulated nodes

# columns of the table, one row per node
X, Y, Z, TX, TY, TZ, ROLL, ROLL_SLOPE, GRADIENT, CURVATURE = range(10)


class Curve(BaseModel):
    """A circular curve with a clothoid and a linear cant ramp of `transition_m` on either side."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    start_m: float = Field(ge=0.0, description="begin of the first transition")
    transition_m: float = Field(gt=0.0)
    length_m: float = Field(ge=0.0, description="of the circular part")
    radius_m: float = Field(description="positive to the left, negative to the right")
    cant_mm: float = Field(default=0.0, description="positive with the right rail raised")

    @model_validator(mode="after")
    def _is_a_railway_curve(self) -> Self:
        if abs(self.radius_m) < 80.0:
            raise ValueError(f"radius_m = {self.radius_m}: the tightest curve allowed is 80 m")
        if abs(self.cant_mm) > 200.0:
            raise ValueError(f"cant_mm = {self.cant_mm}: at most 200 mm")
        return self

    @property
    def end_m(self) -> float:
        return self.start_m + 2.0 * self.transition_m + self.length_m


class GradientChange(BaseModel):
    """From `from_m` on the gradient is `gradient_permille`; the change is rounded over `rounding_m` centred there."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    from_m: float = Field(ge=0.0)
    gradient_permille: float = Field(ge=-60.0, le=60.0, description="positive uphill")
    rounding_m: float = Field(default=50.0, gt=0.0, description="length of the vertical curve")


class TrackParameters(BaseModel):
    """A line of `length_m` that starts straight; level until the first gradient change."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    length_m: float = Field(gt=0.0, le=100_000.0)
    initial_gradient_permille: float = Field(default=0.0, ge=-60.0, le=60.0)
    curves: tuple[Curve, ...] = ()
    gradients: tuple[GradientChange, ...] = ()

    @model_validator(mode="after")
    def _nothing_overlaps(self) -> Self:
        end = 0.0
        for k, curve in enumerate(self.curves):
            if curve.start_m < end:
                raise ValueError(
                    f"curves.{k}.start_m = {curve.start_m}: overlaps the curve before, which ends at {end}"
                )
            end = curve.end_m
        end = 0.0
        for k, change in enumerate(self.gradients):
            if change.from_m - 0.5 * change.rounding_m < end:
                raise ValueError(
                    f"gradients.{k}.from_m = {change.from_m}: its vertical curve overlaps the one before or the start, "
                    f"which reaches to {end}"
                )
            end = change.from_m + 0.5 * change.rounding_m
        for name, last in (
            ("curves", [c.end_m for c in self.curves]),
            ("gradients", [g.from_m for g in self.gradients]),
        ):
            if last and last[-1] > self.length_m:
                raise ValueError(f"{name}: reach to {last[-1]} m, beyond length_m = {self.length_m}")
        return self


class Track:
    """Centreline and cant in nodes 1 m apart, to be read by the compiled `track_frame`.

    `table` (n, 10): position x, y, z (m), unit tangent (3), roll of the track plane (rad, left rail up), its slope
    (rad/m), gradient (tangent of the slope angle), horizontal curvature (rad/m). The table reaches `APRON_M` beyond
    both ends, straight on, so that every wheelset of a coach on the line stands on track.
    """

    APRON_M = 40.0

    def __init__(self, parameters: TrackParameters) -> None:
        self.length_m = parameters.length_m
        self.origin_m = -self.APRON_M
        n = math.ceil(parameters.length_m + 2 * self.APRON_M) + 1
        s = self.origin_m + NODE_M * np.arange(n)
        self.table = np.zeros((n, 10))
        curvature, roll = _horizontal(parameters, s)
        self.table[:, CURVATURE] = curvature
        self.table[:, ROLL] = roll
        self.table[:, ROLL_SLOPE] = np.gradient(roll, NODE_M)
        slope = _gradient(parameters, s)
        self.table[:, GRADIENT] = slope
        self._integrate(parameters, s)

    def _integrate(self, parameters: TrackParameters, s: np.ndarray) -> None:
        """Heading is the integral of curvature, position that of the tangent (Gauss-Legendre in each interval)."""
        sub = 4
        h = NODE_M / sub
        abscissa, weight = np.polynomial.legendre.leggauss(4)
        starts = (s[:-1, None] + h * np.arange(sub)).ravel()
        points = starts[:, None] + 0.5 * h * (abscissa + 1.0)
        curvature, _ = _horizontal(parameters, points.ravel())
        heading_starts = np.concatenate([[0.0], np.cumsum(0.5 * h * (curvature.reshape(points.shape) @ weight))])
        # heading inside a sub-interval: curvature is piecewise linear, so its integral to each point by two-point rule
        ends = 0.5 * h * (abscissa + 1.0)
        inner = np.stack(
            [
                0.5 * e * (_horizontal(parameters, starts[:, None] + 0.5 * e * (abscissa + 1.0))[0] @ weight)
                for e in ends
            ],
            axis=1,
        )
        heading = heading_starts[:-1, None] + inner
        gradient = _gradient(parameters, points.ravel()).reshape(points.shape)
        # s is arc length in space: the horizontal part of ds is ds cos(slope angle)
        cos_slope = 1.0 / np.sqrt(1.0 + gradient**2)
        steps = np.stack([np.cos(heading) * cos_slope, np.sin(heading) * cos_slope, gradient * cos_slope])
        moved = 0.5 * h * (steps @ weight)
        path = np.concatenate([np.zeros((3, 1)), np.cumsum(moved, axis=1)], axis=1)[:, ::sub]
        zero = round(-self.origin_m / NODE_M)
        self.table[:, X : Z + 1] = (path - path[:, zero : zero + 1]).T
        node_heading = heading_starts[::sub]
        node_cos = 1.0 / np.sqrt(1.0 + self.table[:, GRADIENT] ** 2)
        self.table[:, TX] = np.cos(node_heading) * node_cos
        self.table[:, TY] = np.sin(node_heading) * node_cos
        self.table[:, TZ] = self.table[:, GRADIENT] * node_cos

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


def _horizontal(parameters: TrackParameters, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Curvature (rad/m) and roll of the track plane (rad) at s of any shape."""
    curvature = np.zeros_like(s)
    roll = np.zeros_like(s)
    for curve in parameters.curves:
        share = np.clip(np.minimum(s - curve.start_m, curve.end_m - s) / curve.transition_m, 0.0, 1.0)
        curvature += share / curve.radius_m
        roll -= share * math.asin(curve.cant_mm / 1000.0 / RAIL_SPACING_M)
    return curvature, roll


def _gradient(parameters: TrackParameters, s: np.ndarray) -> np.ndarray:
    """Gradient (tangent of the slope angle) at s: changes ramp linearly over the vertical curve."""
    before = parameters.initial_gradient_permille / 1000.0
    gradient = np.full_like(s, before)
    for change in parameters.gradients:
        after = change.gradient_permille / 1000.0
        gradient += (after - before) * np.clip((s - change.from_m) / change.rounding_m + 0.5, 0.0, 1.0)
        before = after
    return gradient


@compiled
def track_frame(s_m: float, origin_m: float, table: Array, frame: Array) -> None:
    """Write the track frame at s into `frame` (14,): position (3), tangent t (3), left n (3), up b (3) of the canted
    plane, roll slope (rad/m), curvature (rad/m).

    Position is a cubic Hermite of the nodes; beyond the table the end interval is continued.
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
