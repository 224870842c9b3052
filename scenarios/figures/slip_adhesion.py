"""Slip and utilised adhesion, axle by axle."""

import numpy as np
from matplotlib.figure import Figure

from scenarios.figures.style import AXLE_COLOURS, TRUE_COLOUR, legend, new_figure, thinned
from scenarios.metrics import SLIP_COUNTS_ABOVE_MPS, stop_span
from scenarios.truth import Truth

LEAD_S = 2.0


def draw_slip_and_adhesion(truth: Truth) -> Figure:
    """Left: slip above 10 km/h. Right: braking force over load of each axle below the peak that the rail offers it."""
    wheelsets = truth.wheelsets
    figure, panels = new_figure("Slip and utilised adhesion", 8.6, rows=4, columns=2, sharey="col")
    span = stop_span(truth)
    first = int(np.searchsorted(wheelsets.t_s, wheelsets.t_s[span[0]] - LEAD_S)) if span else 0
    last = span[1] + 1 if span else len(wheelsets)
    rows = np.arange(first, last)[thinned(last - first)]
    t_s = wheelsets.t_s[rows]
    load_n = wheelsets.normal_force_n[rows].reshape(-1, 4, 2).sum(axis=2)
    force_n = wheelsets.longitudinal_force_n[rows].reshape(-1, 4, 2).sum(axis=2)
    utilised = -force_n / np.maximum(load_n, 1.0)
    fast = np.abs(wheelsets.speed_mps[rows]) > SLIP_COUNTS_ABOVE_MPS
    slip_percent = 100.0 * np.where(fast, wheelsets.slip[rows], np.nan)
    for i, colour in enumerate(AXLE_COLOURS):
        left, right = panels[i]
        left.plot(t_s, slip_percent[:, i], color=colour)
        left.set_ylabel(f"axle {i + 1}   slip  %")
        right.plot(t_s, utilised[:, i], color=colour, label="utilised")
        right.plot(
            t_s, wheelsets.peak_adhesion[rows, i], color=TRUE_COLOUR, linewidth=0.9, label="peak on the rail there"
        )
        right.set_ylabel("adhesion  -")
    top = 1.25 * float(np.quantile(wheelsets.peak_adhesion[span[0] if span else 0 : last], 0.99))
    panels[0, 1].set_ylim(-0.1 * top, top)
    panels[0, 0].set_title("slip (speed - rim speed)/speed, above 10 km/h")
    panels[0, 1].set_title("braking force over load")
    legend(panels[0, 1], columns=2, place="lower right")
    for axes in panels[-1]:
        axes.set_xlabel("time  s")
    return figure
