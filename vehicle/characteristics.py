"""Nonlinear characteristics of springs, stops, dampers and friction: named curves with a source."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

MOST_POINTS = 12


class Characteristic(BaseModel):
    """Force over deflection or over speed: straight lines through the points, continued with the first and last slope.

    A curve that starts at 0 is odd-symmetric; one that starts below 0 is given in full, through (0, 0). Of a vertical
    element, positive is compression. Dry friction is a curve over speed that rises to its force within some cm/s: the
    smoothed form of Coulomb's.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    source: str = Field(min_length=1, description="where the curve comes from, or that it is assumed")
    deflection_m: tuple[float, ...] | None = Field(default=None, min_length=2, max_length=2 * MOST_POINTS - 1)
    speed_mps: tuple[float, ...] | None = Field(default=None, min_length=2, max_length=2 * MOST_POINTS - 1)
    force_n: tuple[float, ...] = Field(min_length=2, max_length=2 * MOST_POINTS - 1)

    @property
    def over(self) -> tuple[float, ...]:
        """What the force is given over: deflections in m or speeds in m/s."""
        return self.speed_mps if self.deflection_m is None else self.deflection_m  # type: ignore[return-value]

    @property
    def slope_at_zero(self) -> float:
        """The smaller one of the slopes on either side of zero."""
        rising, falling = self.halves()
        return float(min(half[1, 1] / half[0, 1] for half in (rising, falling)))

    def halves(self) -> tuple[np.ndarray, np.ndarray]:
        """The side above 0 and the side below, as magnitudes: (2, n) each, x and force from (0, 0) on."""
        points = np.array([self.over, self.force_n])
        if points[0, 0] == 0.0:
            return points, points
        zero = int(np.flatnonzero(points[0] == 0.0)[0])
        return points[:, zero:], -points[:, zero::-1]

    @model_validator(mode="after")
    def _is_a_curve(self) -> Self:
        if (self.deflection_m is None) == (self.speed_mps is None):
            raise ValueError("deflection_m: give it or speed_mps, one of the two")
        key = "speed_mps" if self.deflection_m is None else "deflection_m"
        x = self.over
        if len(x) != len(self.force_n):
            raise ValueError(f"force_n: has {len(self.force_n)} points, {key} has {len(x)}: they must be equally many")
        if any(b <= a for a, b in pairwise(x)):
            raise ValueError(f"{key} = {list(x)}: must increase from point to point")
        if any(b < a for a, b in pairwise(self.force_n)):
            raise ValueError(f"force_n = {list(self.force_n)}: must not fall from point to point")
        if 0.0 not in x[:-1] or self.force_n[x.index(0.0)] != 0.0:
            raise ValueError(
                f"{key} = {list(x)}: must start at 0 with force 0, or below and pass through 0 with force 0"
            )
        if max(x.index(0.0) + 1, len(x) - x.index(0.0)) > MOST_POINTS:
            raise ValueError(f"{key}: has more than {MOST_POINTS} points on one side of 0")
        return self


def summed(curves: Sequence[Characteristic]) -> tuple[np.ndarray, np.ndarray]:
    """The sum of curves over the same quantity as one curve, exactly: its halves as of `Characteristic.halves`."""
    return tuple(_summed_half([curve.halves()[side] for curve in curves]) for side in range(2))  # type: ignore[return-value]


def _summed_half(halves: Sequence[np.ndarray]) -> np.ndarray:
    x = np.unique(np.concatenate([half[0] for half in halves]))
    total = np.zeros_like(x)
    for at, force in halves:
        slope = (force[-1] - force[-2]) / (at[-1] - at[-2])
        total += np.interp(x, at, force) + slope * np.maximum(x - at[-1], 0.0)
    return np.stack([x, total])
