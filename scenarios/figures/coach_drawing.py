"""A drawing of the coach to scale: side view, plan, front view, and a bogie enlarged."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.coach_sheet import CoachSheet
from scenarios.figures.coach_outline import KINDS, TREAD_HALF_SPACING_M, Element, Outline, outline
from scenarios.figures.style import DPI, WIDTH_IN
from vehicle import CoachParameters

X, Y, Z = range(3)
BODY_COLOUR, FRAME_COLOUR, WHEEL_COLOUR, SIZE_COLOUR = "#555555", "#222222", "black", "#777777"
HALF_LENGTH_M = {
    "spring": 0.17,
    "vertical damper": 0.17,
    "lateral damper": 0.28,
    "yaw damper": 0.4,
    "traction rod": 0.4,
}
BESIDE_M = 0.13  # a damper stands beside its spring


def draw_coach(sheet: CoachSheet) -> Figure:
    """All views are to scale; outlines are sketched, dimensions are the parameters'."""
    p = sheet.parameters
    shape = outline(p)
    figure = Figure(figsize=(WIDTH_IN, 9.6), dpi=DPI)
    figure.suptitle(f"{sheet.name}: {p.mass_kg / 1e3:.1f} t", fontsize=11, fontweight="bold", y=0.99)
    grid = figure.add_gridspec(
        3, 3, height_ratios=(1.25, 0.9, 1.55), left=0.02, right=0.98, top=0.95, bottom=0.035, hspace=0.06, wspace=0.04
    )
    side, plan = figure.add_subplot(grid[0, :]), figure.add_subplot(grid[1, :])
    front, bogie, above = (figure.add_subplot(grid[2, k]) for k in range(3))
    _view(side, shape, X, Z)
    _view(plan, shape, X, Y)
    _view(front, shape, Y, Z, bodies=(0, 1, 3), bogie=1)
    _view(bogie, shape, X, Z, bodies=(1, 3, 4), bogie=1)
    _view(above, shape, X, Y, bodies=(1, 3, 4), bogie=1)
    _side_sizes(side, p)
    _plan_sizes(plan, p)
    _front_sizes(front, p)
    _bogie_sizes(bogie, above, p)
    titles = ("side", "plan", "front", "bogie from the side", "bogie from above")
    for axes, title in zip((side, plan, front, bogie, above), titles, strict=True):
        axes.set_title(title, fontsize=9, loc="left", pad=2.0)
        axes.set_aspect("equal")
        axes.margins(0.03, 0.06)
        axes.set_axis_off()
    handles = [
        front.plot([], [], color=colour, linewidth=2.0, label=kind)[0]
        for kind, colour in KINDS.items()
        if any(element.kind == kind for element in shape.elements)
    ]
    figure.legend(handles=handles, loc="lower center", ncols=len(handles), frameon=False)
    return figure


def _view(
    axes: Axes, shape: Outline, across: int, up: int, bodies: tuple[int, ...] = tuple(range(7)), bogie: int = 0
) -> None:
    """Bodies and elements seen along the third axis; `bogie`: only the elements of that one (1, 2), 0 for all."""
    for body in bodies:
        colour = BODY_COLOUR if body == 0 else FRAME_COLOUR if body < 3 else WHEEL_COLOUR
        for line in shape.lines[body]:
            points = shape.centres[body] + line
            axes.plot(points[:, across], points[:, up], color=colour, linewidth=1.6 if body in (1, 2) else 0.9)
    for body in bodies:
        centre = shape.centres[body]
        axes.plot(centre[across], centre[up], marker="+", color=SIZE_COLOUR, markersize=6)
    if up == Z:
        low, high = axes.get_xlim()
        axes.plot([low, high], [0.0, 0.0], color="black", linewidth=0.6)
    else:
        low, high = axes.get_xlim()
        for y in (TREAD_HALF_SPACING_M, -TREAD_HALF_SPACING_M):
            axes.plot([low, high], [y, y], color="#bbbbbb", linewidth=1.2, zorder=0.4)
    for element in shape.elements:
        if bogie == 0 or _of_bogie(element, shape, bogie):
            _symbol(axes, element, across, up)


def _of_bogie(element: Element, shape: Outline, bogie: int) -> bool:
    away = np.abs(element.point[X] - shape.centres[1:3, X])
    return int(np.argmin(away)) == bogie - 1


def _symbol(axes: Axes, element: Element, across: int, up: int) -> None:
    """Springs as zigzags, dampers as cylinders, rods as lines; a circle where one looks along them."""
    point, colour = element.point, KINDS[element.kind]
    place = np.array([point[across], point[up]])
    if element.kind == "anti-roll bar":
        ends = np.array([point, point])
        ends[:, Y] = (0.8, -0.8)
        axes.plot(ends[:, across], ends[:, up], color=colour, linewidth=1.6, marker="o", markersize=2.5)
        return
    direction = {"spring": Z, "vertical damper": Z, "lateral damper": Y}.get(element.kind, X)
    if element.kind == "vertical damper":
        place = place + np.array([BESIDE_M if across == X else -np.sign(point[Y]) * BESIDE_M, 0.0])
    if element.kind == "lateral damper":
        # drawn towards the middle of the coach, off its spring
        place = place - 0.45 * np.sign(point[Y]) * np.array([across == Y, up == Y])
    if direction not in (across, up):
        axes.plot(*place, marker="o", markersize=3.5, markerfacecolor="white", color=colour, linewidth=0.0)
        return
    along = np.array([1.0, 0.0]) if direction == across else np.array([0.0, 1.0])
    half = HALF_LENGTH_M[element.kind]
    draw = {"spring": _zigzag, "traction rod": _rod}.get(element.kind, _cylinder)
    draw(axes, place, half * along, colour)


def _zigzag(axes: Axes, place: Any, half: Any, colour: str) -> None:
    along = np.linspace(-1.0, 1.0, 11)
    aside = np.array([0.0, 0.0, *[1.0, -1.0] * 3, 1.0, 0.0, 0.0]) * 0.07
    normal = np.array([-half[1], half[0]]) / np.hypot(*half)
    points = place + along[:, None] * half + aside[:, None] * normal
    axes.plot(points[:, 0], points[:, 1], color=colour, linewidth=1.0)


def _rod(axes: Axes, place: Any, half: Any, colour: str) -> None:
    ends = np.array([place - half, place + half])
    axes.plot(ends[:, 0], ends[:, 1], color=colour, linewidth=1.8, marker="o", markersize=2.5)


def _cylinder(axes: Axes, place: Any, half: Any, colour: str) -> None:
    normal = 0.045 * np.array([-half[1], half[0]]) / np.hypot(*half)
    for line in (
        [place - half, place - 0.45 * half],
        [place + 0.45 * half + normal, place - 0.45 * half + normal, place - 0.45 * half - normal,
         place + 0.45 * half - normal],
        [place + 0.1 * half + 0.8 * normal, place + 0.1 * half - 0.8 * normal],
        [place + 0.1 * half, place + half],
    ):  # fmt: skip
        points = np.array(line)
        axes.plot(points[:, 0], points[:, 1], color=colour, linewidth=1.0)


def _size(axes: Axes, start: tuple[float, float], end: tuple[float, float], text: str) -> None:
    """A dimension line with its figure beside the middle."""
    form = {"arrowstyle": "<->", "color": SIZE_COLOUR, "linewidth": 0.8, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", end, start, arrowprops=form)
    axes.plot(*zip(start, end, strict=True), linestyle="none")  # an annotation alone does not widen the view
    level = abs(end[0] - start[0]) > abs(end[1] - start[1])
    middle = (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]))
    box = {"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.9}
    axes.text(
        *middle,
        text,
        fontsize=7.5,
        color="#333333",
        ha="center",
        va="center",
        rotation=0.0 if level else 90.0,
        bbox=box,
    )


def _millimetres(length_m: float) -> str:
    return f"{1e3 * length_m:,.0f}".replace(",", " ")


def _side_sizes(axes: Axes, p: CoachParameters) -> None:
    half, below = 0.5 * p.bogie_distance_m, -0.55
    _size(axes, (-half, below), (half, below), _millimetres(p.bogie_distance_m))
    axle = half + 0.5 * p.wheelbase_m
    _size(axes, (axle - p.wheelbase_m, 2.0 * below), (axle, 2.0 * below), _millimetres(p.wheelbase_m))
    _size(axes, (0.6, 0.0), (0.6, p.body.height_m), _millimetres(p.body.height_m))


def _plan_sizes(axes: Axes, p: CoachParameters) -> None:
    half, wide = 0.5 * p.bogie_distance_m, p.secondary.half_spacing_m
    _size(axes, (half - 2.2, -wide), (half - 2.2, wide), _millimetres(2.0 * wide))


def _front_sizes(axes: Axes, p: CoachParameters) -> None:
    for level, spacing in ((-0.3, TREAD_HALF_SPACING_M), (-0.6, p.primary.half_spacing_m)):
        _size(axes, (-spacing, level), (spacing, level), _millimetres(2.0 * spacing))
    _size(axes, (1.62, 0.0), (1.62, p.secondary.height_m), _millimetres(p.secondary.height_m))
    _size(axes, (-1.62, 0.0), (-1.62, p.body.height_m), _millimetres(p.body.height_m))


def _bogie_sizes(side: Axes, above: Axes, p: CoachParameters) -> None:
    middle = 0.5 * p.bogie_distance_m
    front = middle + 0.5 * p.wheelbase_m
    _size(side, (front - p.wheelbase_m, -0.25), (front, -0.25), _millimetres(p.wheelbase_m))
    edge = front + 0.85
    _size(side, (edge, 0.0), (edge, p.wheelset.wheel_diameter_m), f"⌀ {_millimetres(p.wheelset.wheel_diameter_m)}")
    back = front - p.wheelbase_m - 0.9
    _size(side, (back, 0.0), (back, p.bogie.height_m), _millimetres(p.bogie.height_m))
    if p.yaw_dampers is not None:
        wide = p.yaw_dampers.half_spacing_m
        _size(above, (back, -wide), (back, wide), _millimetres(2.0 * wide))
    wide = p.primary.half_spacing_m
    _size(above, (edge, -wide), (edge, wide), _millimetres(2.0 * wide))
