"""Drawn shapes of wheel and rail profiles, piece by piece as their standards define them: points (n, 2) in mm.

Wheel: y from the tape circle, flange at negative y, z positive downwards (towards the flange tip), z = 0 at the tape
circle. Rail: gauge side at negative y, z positive downwards. All shapes run from the flange or gauge side outwards.
"""

from collections.abc import Callable

import numpy as np

# one piece: start and end in y, and z(y)
Piece = tuple[float, float, Callable[[np.ndarray], np.ndarray]]

POINTS_PER_PIECE = 4000


def _arc(centre_y: float, centre_z: float, radius: float) -> Callable[[np.ndarray], np.ndarray]:
    """Circular arc about the centre, its upper half (z counts downwards) for a positive radius, else the lower."""

    def height(y: np.ndarray) -> np.ndarray:
        # rounding of published figures may leave an end a hair outside the circle
        return centre_z - np.sign(radius) * np.sqrt(np.maximum(radius**2 - (y - centre_y) ** 2, 0.0))

    return height


def _polynomial(*coefficients: float) -> Callable[[np.ndarray], np.ndarray]:
    """Polynomial with the coefficients of y^0, y^1, ..."""

    def height(y: np.ndarray) -> np.ndarray:
        return np.polynomial.polynomial.polyval(y, coefficients)

    return height


def _sampled(pieces: list[Piece]) -> np.ndarray:
    """Points (n, 2) of the pieces in order; they crowd towards the ends of a piece, where arcs may stand upright."""
    share = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, POINTS_PER_PIECE + 1)))
    points = []
    for k, (start, end, height) in enumerate(pieces):
        y = start + (end - start) * (share if k == 0 else share[1:])
        points.append(np.stack([y, height(y)], axis=1))
    return np.concatenate(points)


def s1002() -> np.ndarray:
    """Wheel profile S1002 (EN 13715, flange 28 mm high; UIC 510-2 gives the same curves)."""
    return _sampled(
        [
            (-70.0, -62.764705882, _arc(-49.5, 9.519259302, -20.5)),
            (-62.764705882, -49.662510381, _arc(-55.0, 16.0, -12.0)),
            (-49.662510381, -39.764473993, _arc(-58.558326413, 8.834924130, -20.0)),
            (-39.764473993, -38.426669071, _polynomial(-93.576667419, -2.747477419)),
            (-38.426669071, -35.0, _arc(-26.210665, 16.446, 13.0)),
            (
                -35.0,
                -26.0,
                _polynomial(
                    -4.320221063e3, -1.038384026e3, -1.065501873e2, -6.051367875,
                    -2.054332446e-1, -4.169739389e-3, -4.687195829e-5, -2.252755540e-7,
                ),
            ),
            (
                -26.0,
                32.15796,
                _polynomial(
                    0.0, -3.358537058e-2, 1.565681624e-3, -2.810427944e-5, 5.844240864e-8,
                    -1.562379023e-8, 5.309217349e-15, -5.957839843e-12, 2.646656573e-13,
                ),
            ),
            (32.15796, 60.0, _polynomial(1.364323640, -0.066666667)),
        ]
    )  # fmt: skip


def en15302_wheel_a() -> np.ndarray:
    """Reference wheel profile A of EN 15302."""
    return _sampled(
        [
            (-70.0, -62.7647, _arc(-49.5, 9.51926, -20.5)),
            (-62.7647, -49.6625, _arc(-55.0, 16.00065, -12.0)),
            (-49.6625, -39.7645, _arc(-58.5583, 8.83556, -20.0)),
            (-39.7645, -38.7372, _polynomial(-93.57685, -2.7475)),
            (-38.7372, -29.4591, _arc(-25.5816, 17.64215, 14.0)),
            (-29.4591, -10.8749, _arc(-2.6594, 97.16493, 96.76055)),
            (-10.8749, 18.4173, _arc(18.4173, 344.50806, 345.0)),
            (18.4173, 30.0, _polynomial(-0.49194)),
            (30.0, 60.0, _polynomial(1.50804, -0.066666)),
            (60.0, 65.0, _polynomial(57.50808, -1.0)),
        ]
    )


def en15302_rail_a() -> np.ndarray:
    """Reference rail profile A of EN 15302, already laid as the benchmark wants it."""
    return _sampled(
        [
            (-32.634, -23.2401, _arc(-19.63949, 15.899044, 13.0)),
            (-23.2401, -7.8749, _arc(-1.0825, 80.277908, 80.0)),
            (-7.8749, 13.0989, _arc(17.5966, 299.48349, 300.0)),
            (13.0989, 28.6709, _arc(14.29829, 79.508225, 80.0)),
            (28.6709, 39.2705, _arc(26.33535, 13.598369, 13.0)),
        ]
    )


def uic60() -> np.ndarray:
    """Head of the rail UIC60 (60E1 of EN 13674-1) standing upright, z = 0 on top.

    Tangent arcs R300 to |y| = 10.25, R80 to 26.05, R13 beyond, then the head's side at 1:20 to 25 mm below the top.
    """
    return _upright_head(10.25, 26.05)


def uic60_en15302() -> np.ndarray:
    """Head of UIC60 with the wider crown of EN 15302's rail A (UIC 519), upright; turned by 0.05 rad it is that rail.

    Tangent arcs R300 to |y| = 10.5, R80 to 25.988, then R13 that meets the head's side, at 1:20, 36 mm from the middle.
    """
    return _upright_head(10.5, 25.988)


def _upright_head(crown_mm: float, shoulder_mm: float) -> np.ndarray:
    """Tangent arcs R300 to |y| = `crown_mm`, R80 to `shoulder_mm`, R13 beyond, then the side at 1:20."""
    ends, radii = (0.0, crown_mm, shoulder_mm), (300.0, 80.0, 13.0)
    # each centre lies on the line through the arc before's centre and the common point
    centre_y, centre_z = 0.0, radii[0]
    half: list[Piece] = []
    for k, radius in enumerate(radii):
        if k > 0:
            share = radius / radii[k - 1]
            joint_z = centre_z - np.sqrt(radii[k - 1] ** 2 - (ends[k] - centre_y) ** 2)
            centre_y = ends[k] + share * (centre_y - ends[k])
            centre_z = joint_z + share * (centre_z - joint_z)
        end = ends[k + 1] if k < 2 else centre_y + radius * 20.0 / np.hypot(20.0, 1.0)
        half.append((ends[k], end, _arc(centre_y, centre_z, radius)))
    side_y, side_z = half[-1][1], centre_z - radii[2] / np.hypot(20.0, 1.0)
    half.append((side_y, side_y + (25.0 - side_z) / 20.0, _polynomial(side_z - 20.0 * side_y, 20.0)))
    right = _sampled(half)
    return np.concatenate([right[:0:-1] * (-1.0, 1.0), right])
