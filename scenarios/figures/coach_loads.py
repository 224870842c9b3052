"""What a coach's suspension does: its curved characteristics, and the loads of its wheels at rest and in a curve."""

import numpy as np
from matplotlib.figure import Figure

from scenarios.coach_sheet import CURVE_CANT_MM, CURVE_RADIUS_M, CoachSheet
from scenarios.figures.style import AXLE_COLOURS, DPI, GRID_COLOUR, REFERENCE_COLOUR, WIDTH_IN

COLUMNS = 4


def draw_characteristics(sheet: CoachSheet) -> Figure:
    """Force over speed of dampers, over deflection of stops; all odd-symmetric, continued with their last slope."""
    curves = sheet.parameters.characteristics
    rows = max(1, -(-len(curves) // COLUMNS))
    figure = Figure(figsize=(WIDTH_IN, 0.6 + 2.3 * rows), dpi=DPI)
    figure.suptitle(f"{sheet.name}: characteristics", fontsize=11, fontweight="bold")
    height = 0.6 + 2.3 * rows
    grid = figure.add_gridspec(
        rows, COLUMNS, left=0.06, right=0.99, bottom=0.5 / height, top=1.0 - 0.65 / height, hspace=0.55, wspace=0.3
    )
    for k, (key, curve) in enumerate(curves.items()):
        axes = figure.add_subplot(grid[k // COLUMNS, k % COLUMNS])
        speed = curve.speed_mps is not None
        rising, falling = curve.halves()
        x, force = np.concatenate([-falling[:, ::-1], rising], axis=1) * np.array([[1.0 if speed else 1e3], [1e-3]])
        axes.plot(x, force, marker=".", markersize=4)
        axes.set_title(key, fontsize=9)
        axes.set_xlabel("speed  m/s" if speed else "deflection  mm")
        axes.grid(visible=True, color=GRID_COLOUR, linewidth=0.7)
        if k % COLUMNS == 0:
            axes.set_ylabel("force  kN")
    return figure


def draw_wheel_loads(sheet: CoachSheet) -> Figure:
    """Wheel by wheel: at rest, and in the curve at each cant deficiency."""
    cases = [("standing on level track", sheet.loads.wheel_load_n)] + [
        (
            f"{CURVE_RADIUS_M:g} m left, cant {CURVE_CANT_MM:g} mm, deficiency {curve.deficiency_mm:g} mm",
            curve.loads.wheel_load_n,
        )
        for curve in sheet.curves
    ]
    figure = Figure(figsize=(WIDTH_IN, 3.6), dpi=DPI)
    figure.suptitle(f"{sheet.name}: wheel loads", fontsize=11, fontweight="bold")
    panels = figure.subplots(
        1,
        len(cases),
        sharey=True,
        gridspec_kw={"left": 0.06, "right": 0.99, "bottom": 0.14, "top": 0.82, "wspace": 0.06},
    )
    places = np.arange(1, 5)
    for axes, (title, loads) in zip(np.atleast_1d(panels), cases, strict=True):
        for side, name, colour in ((0, "left", AXLE_COLOURS[0]), (1, "right", AXLE_COLOURS[2])):
            bars = axes.bar(places + 0.4 * side - 0.2, loads[side::2] / 1e3, width=0.38, color=colour, label=name)
            axes.bar_label(bars, fmt="%.1f", fontsize=7.5)
        axes.axhline(sheet.parameters.static_wheel_load_n / 1e3, color=REFERENCE_COLOUR, linewidth=0.8, linestyle="--")
        axes.set_title(title, fontsize=9)
        axes.set_xticks(places)
        axes.set_xlabel("wheelset")
    first = np.atleast_1d(panels)[0]
    first.set_ylabel("load  kN")
    first.legend(loc="lower center", ncols=2)
    return figure
