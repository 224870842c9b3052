"""Sketched outlines of a coach's bodies, and where its suspension elements stand, for drawings."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vehicle import CoachParameters
from vehicle.layout import centres, coach_record
from vehicle.linear import polach_contact

Kind = Literal["spring", "vertical damper", "lateral damper", "yaw damper", "traction rod", "anti-roll bar"]
KINDS: dict[Kind, str] = {
    "spring": "#1f77b4",
    "vertical damper": "#d62728",
    "lateral damper": "#ff7f0e",
    "yaw damper": "#8c564b",
    "traction rod": "#2ca02c",
    "anti-roll bar": "#9467bd",
}
OVERHANG_M, BODY_HALF_WIDTH_M, FLOOR_M, ROOF_M = 3.6, 1.4, 1.15, 3.9
FRAME_OVERHANG_M, FRAME_HALF_HEIGHT_M = 0.65, 0.1
TREAD_HALF_SPACING_M, AXLE_HALF_LENGTH_M = 0.75, 1.1
_ROUND = 24


@dataclass(frozen=True)
class Element:
    """A suspension element at its point (3,), m, from the rails below the coach's middle."""

    kind: Kind
    point: NDArray[np.float64]


@dataclass(frozen=True)
class Outline:
    """Lines of the bodies: for each its centre (3,) and polylines (n, 3) from there; `elements` of the suspension."""

    centres: NDArray[np.float64]
    lines: list[list[NDArray[np.float64]]]
    elements: list[Element]


def outline(p: CoachParameters) -> Outline:
    """Carbody, bogie frames and wheelsets; the size of the carbody is not a parameter, it is sketched."""
    contact = polach_contact(p)
    at = centres(p, contact)[:7]
    half = 0.5 * p.bogie_distance_m + OVERHANG_M
    floor, roof = FLOOR_M - at[0, 2], ROOF_M - at[0, 2]
    body = _box(half, BODY_HALF_WIDTH_M, floor, roof)
    frame = _frame(0.5 * p.wheelbase_m + FRAME_OVERHANG_M, p.primary.half_spacing_m)
    wheelset = _wheelset(0.5 * p.wheelset.wheel_diameter_m)
    return Outline(at, [body, frame, frame, *[wheelset] * 4], _elements(p, centres(p, contact)))


def _box(half_length: float, half_width: float, low: float, high: float) -> list[NDArray[np.float64]]:
    ring = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1), (1, 1)]) * (half_length, half_width)
    rings = [np.column_stack([ring, np.full(5, z)]) for z in (low, high)]
    return rings + [np.array([rings[0][k], rings[1][k]]) for k in range(4)]


def _frame(half_length: float, half_width: float) -> list[NDArray[np.float64]]:
    sides = [
        np.array([(x, y, z) for x, z in _RECTANGLE * (half_length, FRAME_HALF_HEIGHT_M)])
        for y in (half_width, -half_width)
    ]
    return [*sides, np.array([(0.0, half_width, 0.0), (0.0, -half_width, 0.0)])]


_RECTANGLE = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1), (1, 1)], dtype=float)


def _wheelset(radius: float) -> list[NDArray[np.float64]]:
    around = np.linspace(0.0, 2.0 * np.pi, _ROUND + 1)
    wheels = [
        np.column_stack([radius * np.cos(around), np.full(_ROUND + 1, y), radius * np.sin(around)])
        for y in (TREAD_HALF_SPACING_M, -TREAD_HALF_SPACING_M)
    ]
    # a spoke tells how far it has turned
    wheels += [np.array([(0.0, y, 0.0), (0.0, y, radius)]) for y in (TREAD_HALF_SPACING_M, -TREAD_HALF_SPACING_M)]
    return [*wheels, np.array([(0.0, AXLE_HALF_LENGTH_M, 0.0), (0.0, -AXLE_HALF_LENGTH_M, 0.0)])]


def _elements(p: CoachParameters, at: NDArray[np.float64]) -> list[Element]:
    coach = coach_record(p, polach_contact(p))[0]
    found = []
    for e in range(len(coach["upper"])):
        point = at[coach["upper"][e]] + coach["upper_point"][e]
        k, c, curve = coach["stiffness"][e], coach["damping"][e], coach["damper"][e] >= 0
        kinds: list[tuple[Kind, bool]] = [
            ("spring", bool(k[2] > 0.0)),
            ("vertical damper", bool(curve[2] or c[2] > 0.0)),
            ("lateral damper", bool(curve[1])),
            ("yaw damper", bool(curve[0] and not k.any())),
            ("traction rod", bool(k[0] > 0.0 and k[2] == 0.0)),
            ("anti-roll bar", bool(not k.any() and not curve.any() and coach["rotational_stiffness"][e].any())),
        ]
        found += [Element(kind, point) for kind, there in kinds if there]
    return found
