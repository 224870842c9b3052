"""The swings of a coach: shapes of the first dozen as small multiples, and how all of them move with speed."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from scenarios.coach_sheet import CoachSheet
from scenarios.figures.coach_outline import Outline, outline
from scenarios.figures.style import DPI, GRID_COLOUR, REFERENCE_COLOUR, WIDTH_IN
from scenarios.units import KMH_PER_MPS
from vehicle.modes import DampedMode

SHOWN, COLUMNS = 12, 3
LARGEST_M, LARGEST_RAD = 0.75, 0.4  # displacement, or turn, to which a shape is drawn
MOVED_COLOURS = ("#1f77b4", "#d62728", "#2ca02c")  # carbody, bogies, wheelsets
HIGHEST_HZ = 25.0
# the coach is seen from its right side, ahead and above: where a metre along x, y, z goes on the paper
SEEN = np.array([(0.9, -0.12), (0.75, 0.5), (0.0, 1.0)])


def draw_mode_shapes(sheet: CoachSheet) -> Figure:
    """At the phase in which the coordinate with most energy is largest; grey: at rest."""
    shape = outline(sheet.parameters)
    shown = sheet.modes[:SHOWN]
    rows = -(-len(shown) // COLUMNS)
    figure = Figure(figsize=(WIDTH_IN, 0.6 + 1.75 * rows), dpi=DPI)
    title = f"{sheet.name}: the {len(shown)} slowest swings at {KMH_PER_MPS * sheet.speed_mps:.0f} km/h"
    figure.suptitle(title, fontsize=11, fontweight="bold")
    grid = figure.add_gridspec(rows, COLUMNS, left=0.01, right=0.99, bottom=0.01, top=0.93, hspace=0.22, wspace=0.02)
    for k, mode in enumerate(shown):
        axes = figure.add_subplot(grid[k // COLUMNS, k % COLUMNS])
        _draw_shape(axes, shape, mode)
        words = f"{mode.name}\n{mode.frequency_hz:.2f} Hz, damping {100.0 * mode.damping_ratio:.0f} %"
        axes.set_title(words, fontsize=8.5, pad=2.0)
        axes.set_aspect("equal")
        axes.set_axis_off()
    return figure


def _draw_shape(axes: Axes, shape: Outline, mode: DampedMode) -> None:
    moved = [
        [_displaced(line, mode.shape.real[6 * body : 6 * body + 6]) for line in lines]
        for body, lines in enumerate(shape.lines)
    ]
    largest = max(float(np.abs(part).max()) for parts in moved for part in parts)
    turned = float(np.abs(mode.shape.real[:42].reshape(7, 6)[:, 3:]).max())
    scale = min(LARGEST_M / max(largest, 1e-9), LARGEST_RAD / max(turned, 1e-9))
    for body, lines in enumerate(shape.lines):
        colour = MOVED_COLOURS[0 if body == 0 else 1 if body < 3 else 2]
        for line, part in zip(lines, moved[body], strict=True):
            at_rest = (shape.centres[body] + line) @ SEEN
            axes.plot(at_rest[:, 0], at_rest[:, 1], color="#cccccc", linewidth=0.6)
            now = (shape.centres[body] + line + scale * part) @ SEEN
            axes.plot(now[:, 0], now[:, 1], color=colour, linewidth=1.0, zorder=3.0)


def _displaced(line: NDArray[np.float64], shape: NDArray[np.float64]) -> NDArray[np.float64]:
    """Displacements of the points (n, 3) of a body: translation, and turn about its centre."""
    return shape[:3] + np.cross(shape[3:], line)


def draw_root_locus(sheet: CoachSheet) -> Figure:
    """Eigenvalues over speed: in the plane of growth and frequency, and the least damped against speed; the critical
    speed over the conicity of cones."""
    figure = Figure(figsize=(WIDTH_IN, 4.6), dpi=DPI)
    figure.suptitle(f"{sheet.name}: swings over speed", fontsize=11, fontweight="bold")
    plane, growth, hunting = figure.subplots(
        1, 3, gridspec_kw={"left": 0.06, "right": 0.985, "bottom": 0.12, "top": 0.88, "wspace": 0.34}
    )
    locus = sheet.locus
    kmh = KMH_PER_MPS * locus.speed_mps
    for axes in (plane, growth, hunting):
        axes.grid(visible=True, color=GRID_COLOUR, linewidth=0.7)
        axes.set_axisbelow(True)
    speed = np.concatenate([np.full(len(rates), v) for rates, v in zip(locus.rates, kmh, strict=True)])
    rates = np.concatenate(locus.rates)
    slow = (rates.imag < 2.0 * np.pi * HIGHEST_HZ) & (rates.real > -30.0)
    points = plane.scatter(rates.real[slow], rates.imag[slow] / (2.0 * np.pi), c=speed[slow], s=5.0, cmap="viridis")
    plane.axvline(0.0, color=REFERENCE_COLOUR, linewidth=0.8)
    plane.set_xlabel("growth  1/s")
    plane.set_ylabel("frequency  Hz")
    figure.colorbar(points, ax=plane, label="speed  km/h", pad=0.02)
    for k in range(4):
        growth.plot(kmh, [float(np.sort(-r.real)[k]) * -1.0 for r in locus.rates], color="#1f77b4", alpha=1.0 - 0.2 * k)
    growth.axhline(0.0, color=REFERENCE_COLOUR, linewidth=0.8)
    growth.set_xlabel("speed  km/h")
    growth.set_ylabel("growth of the four least damped  1/s")
    _, first = sheet.hunting[0]
    if first.speed_mps is not None and first.speed_mps <= locus.speed_mps[-1]:
        growth.axvline(KMH_PER_MPS * first.speed_mps, color=REFERENCE_COLOUR, linestyle="--", linewidth=0.9)
        growth.set_title(f"critical {KMH_PER_MPS * first.speed_mps:.0f} km/h", fontsize=9)
    cones = sorted((h.conicity, h.speed_mps) for on, h in sheet.hunting if on == "cones" and h.speed_mps is not None)
    if cones:
        conicity, critical = np.array(cones).T
        hunting.plot(conicity, KMH_PER_MPS * critical, marker="o", color="#1f77b4", label="cones")
    for on, found in sheet.hunting:
        if on.startswith("cones as") and found.speed_mps is not None:
            look = {"marker": "s", "color": "#ff7f0e", "linestyle": "none"}
            hunting.plot(
                found.conicity, KMH_PER_MPS * found.speed_mps, label="cones as steep as the profiles at 3 mm", **look
            )
    hunting.set_xlim(0.0, 0.45)
    hunting.set_ylim(bottom=0.0)
    hunting.set_xlabel("conicity")
    hunting.set_ylabel("critical speed  km/h")
    if hunting.get_legend_handles_labels()[0]:
        hunting.legend(loc="lower left")
    else:
        hunting.set_title("stable on all cones", fontsize=9)
    return figure
