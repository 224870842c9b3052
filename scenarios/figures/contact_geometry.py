"""Where a wheelset touches its track and how it steers, over its lateral displacement."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.figures.style import AXLE_COLOURS, REFERENCE_COLOUR, TRUE_COLOUR, legend, new_figure
from wheel_rail.contact_geometry import ContactGeometry, ContactTable
from wheel_rail.contact_search import ALONG, ANGLE, COLUMNS, RADIUS, TRACK_Y, TRACK_Z
from wheel_rail.contact_table import NODES, PLACE_ALONG, RAIL_Y, RAIL_Z, ROLLING_RADIUS, SLOPE, Contact
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
) -> Figure:
    """Solid: rigid wheelset and track, which may leap; dotted: bodies pressed into each other by 45 um, as under 70 kN.

    `name` goes into the title; `published_place_mm`: (displacement in mm, place) to be marked, on the left wheel.
    Raises ValueError if a profile ends within `reach_m`.
    """
    count = round(reach_m / STEP_M)
    y_m = STEP_M * np.arange(-count, count + 1)
    tables = {"-": geometry.table(y_m), ":": geometry.table(y_m, penetration_m=SOFT_M)}
    figure = _draw(
        tables, wheel_radius_m, name, "solid: rigid, dotted: pressed in by 45 µm; flange and gauge side negative"
    )
    _mark(figure.axes[0], published_place_mm, "CONTACT, left wheel")
    legend(figure.axes[0], place="lower center")
    return figure


def draw_tabulated_geometry(contact: Contact, name: str) -> Figure:
    """The same of conical wheels, as the co-simulation reads it; beyond the play the flange's stop takes over."""
    constants = contact.constants
    y_m = contact.displacement_m
    rows = constants["table"].transpose(1, 0, 2)[None]
    contacts = np.zeros((1, NODES, 2, COLUMNS))
    for to, column in ((ALONG, PLACE_ALONG), (RADIUS, ROLLING_RADIUS), (TRACK_Y, RAIL_Y), (TRACK_Z, RAIL_Z)):
        contacts[..., to] = rows[..., column]
    contacts[..., ANGLE] = np.arctan(rows[..., SLOPE])
    along_m, radius_m = contacts[..., ALONG], contacts[..., RADIUS]
    roll_rad = (radius_m[..., 0] - radius_m[..., 1]) / along_m.sum(axis=-1)
    centre_m = float(along_m[0, NODES // 2, 0])
    table = ContactTable(
        y_m, np.zeros(1), roll_rad, radius_m.mean(axis=-1), contacts, centre_m, np.full(2, centre_m), ()
    )  # fmt: skip
    figure = _draw({"-": table}, contact.radius_m, name, "places from those of a centred wheelset, inwards negative")
    legend(figure.axes[0], place="lower center")
    return figure


def _draw(tables: Mapping[str, ContactTable], wheel_radius_m: float, name: str, how: str) -> Figure:
    """Each table in its own kind of line."""
    figure, panels = new_figure(f"Contact geometry: {name}", 7.4, rows=3, columns=2)
    (wheel, difference), (rail, angle), (roll, conicity) = panels
    for line, table in tables.items():
        y_mm = 1e3 * table.lateral_displacement_m
        _both_wheels(wheel, y_mm, 1e3 * table.wheel_position_m[0], line)
        _both_wheels(rail, y_mm, 1e3 * table.rail_position_m[0], line)
        _both_wheels(angle, y_mm, np.degrees(table.contacts[0, :, :, ANGLE]), line)
        difference.plot(y_mm, 1e3 * table.rolling_radius_difference_m[0], line, color=TRUE_COLOUR)
        roll.plot(y_mm, 1e3 * table.roll_rad[0], line, color=TRUE_COLOUR)
        conicity.plot(1e3 * AMPLITUDES_M, _conicities(table, wheel_radius_m), line, color=TRUE_COLOUR)
    wheel.set_ylabel("place on the wheel  mm")
    rail.set_ylabel("place on the rail  mm")
    roll.set_ylabel("roll of the wheelset  mrad")
    difference.set_ylabel("rolling radius left - right  mm")
    angle.set_ylabel("contact angle  deg")
    conicity.set_ylabel("equivalent conicity  -")
    highest = max(float(np.nanmax(line.get_ydata(), initial=0.0)) for line in conicity.get_lines())
    conicity.set_ylim(0.0, 1.15 * highest + 0.01)
    wheel.set_title(how, fontsize=8)
    roll.set_xlabel("lateral displacement, to the left  mm")
    conicity.set_xlabel("lateral displacement; for the conicity: amplitude  mm")
    return figure


def _both_wheels(axes: Axes, y_mm: np.ndarray, of_wheels: np.ndarray, line: str) -> None:
    for k, (side, colour) in enumerate(WHEELS):
        axes.plot(y_mm, of_wheels[:, k], line, color=colour, label=f"{side} wheel" if line == "-" else None)


def _conicities(table: ContactTable, wheel_radius_m: float) -> np.ndarray:
    """Over `AMPLITUDES_M`; nan where no wave of that amplitude fits into the table."""
    fits = 0.95 * table.lateral_displacement_m[-1] > AMPLITUDES_M
    found = np.full(AMPLITUDES_M.shape, np.nan)
    if not np.ptp(table.rolling_radius_difference_m) > 0.0:  # cylinders do not steer
        return found
    found[fits] = equivalent_conicity(
        table.lateral_displacement_m, table.rolling_radius_difference_m[0], AMPLITUDES_M[fits], wheel_radius_m
    )
    return found


def _mark(axes: Axes, points: Points, label: str) -> None:
    if points:
        axes.plot(*zip(*points, strict=True), "o", color=REFERENCE_COLOUR, markersize=4, label=label)
