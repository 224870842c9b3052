"""Where a wheelset touches its track and how it steers, over its lateral displacement."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.figures.style import AXLE_COLOURS, REFERENCE_COLOUR, TRUE_COLOUR, legend, new_figure
from wheel_rail.contact_geometry import ContactGeometry, ContactTable
from wheel_rail.contact_search import ANGLE
from wheel_rail.equivalent_conicity import equivalent_conicity

STEP_M = 5e-5
AMPLITUDES_M = np.arange(5, 81) * 1e-4
WHEELS = (("left", AXLE_COLOURS[0]), ("right", AXLE_COLOURS[2]))
SOFT_M = 4.5e-5
Points = Sequence[tuple[float, float]]


def draw_contact_geometry(
    geometry: ContactGeometry,
    wheel_radius_m: float,
    name: str,
    reach_m: float = 0.01,
    published_place_mm: Points = (),
    published_conicity: Points = (),
) -> Figure:
    """Solid: rigid wheelset and track, which may leap; dotted: bodies pressed into each other by 45 um, as under 70 kN.

    `name` goes into the title; `published_...`: (displacement or amplitude in mm, figure) to be marked, the places on
    the left wheel. Raises ValueError if a profile ends within `reach_m`.
    """
    count = round(reach_m / STEP_M)
    y_m = STEP_M * np.arange(-count, count + 1)
    rigid = geometry.table(y_m)
    soft = geometry.table(y_m, penetration_m=SOFT_M)
    figure, panels = new_figure(f"Contact geometry: {name}", 7.4, rows=3, columns=2)
    (wheel, difference), (rail, angle), (roll, conicity) = panels
    _both_wheels(wheel, 1e3 * rigid.wheel_position_m[0], 1e3 * soft.wheel_position_m[0], y_m)
    _both_wheels(rail, 1e3 * rigid.rail_position_m[0], 1e3 * soft.rail_position_m[0], y_m)
    _both_wheels(
        angle, np.degrees(rigid.contacts[0, :, :, ANGLE]), np.degrees(soft.contacts[0, :, :, ANGLE]), y_m
    )  # fmt: skip
    for table, line in ((rigid, "-"), (soft, ":")):
        y_mm = 1e3 * y_m
        difference.plot(y_mm, 1e3 * table.rolling_radius_difference_m[0], line, color=TRUE_COLOUR)
        roll.plot(y_mm, 1e3 * table.roll_rad[0], line, color=TRUE_COLOUR)
        conicity.plot(1e3 * AMPLITUDES_M, _conicities(table, wheel_radius_m, reach_m), line, color=TRUE_COLOUR)
    _mark(wheel, published_place_mm, "CONTACT, left wheel")
    _mark(conicity, published_conicity, "published")
    wheel.set_ylabel("place on the wheel  mm")
    rail.set_ylabel("place on the rail  mm")
    roll.set_ylabel("roll of the wheelset  mrad")
    difference.set_ylabel("rolling radius left - right  mm")
    angle.set_ylabel("contact angle  deg")
    conicity.set_ylabel("equivalent conicity  -")
    conicity.set_ylim(bottom=0.0)
    wheel.set_title("solid: rigid, dotted: pressed in by 45 µm; flange and gauge side negative", fontsize=8)
    roll.set_xlabel("lateral displacement, to the left  mm")
    conicity.set_xlabel("lateral displacement; for the conicity: amplitude  mm")
    legend(wheel, place="lower center")
    legend(conicity, place="upper left")
    return figure


def _both_wheels(axes: Axes, rigid: np.ndarray, soft: np.ndarray, y_m: np.ndarray) -> None:
    for k, (side, colour) in enumerate(WHEELS):
        axes.plot(1e3 * y_m, rigid[:, k], color=colour, label=f"{side} wheel")
        axes.plot(1e3 * y_m, soft[:, k], ":", color=colour)


def _conicities(table: ContactTable, wheel_radius_m: float, reach_m: float) -> np.ndarray:
    """Over `AMPLITUDES_M`; nan where no wave of that amplitude fits into the table."""
    fits = 0.95 * reach_m > AMPLITUDES_M
    found = np.full(AMPLITUDES_M.shape, np.nan)
    found[fits] = equivalent_conicity(
        table.lateral_displacement_m, table.rolling_radius_difference_m[0], AMPLITUDES_M[fits], wheel_radius_m
    )
    return found


def _mark(axes: Axes, points: Points, label: str) -> None:
    if points:
        axes.plot(*zip(*points, strict=True), "o", color=REFERENCE_COLOUR, markersize=4, label=label)
