"""Slip and utilised adhesion, axle by axle."""

import numpy as np
from matplotlib.figure import Figure

from scenarios.figures.style import AXLE_COLOURS, GAIN_COLOUR, TRUE_COLOUR, legend, new_figure, plot
from scenarios.metrics import SLIP_COUNTS_ABOVE_MPS, STANDSTILL_MPS, stop_span
from scenarios.truth import Truth, WheelsetStream

LEAD_S = 2.0


def draw_slip_and_adhesion(truth: Truth) -> Figure:
    """Left: slip above 10 km/h. Right: force over load of each axle along the track, below the peak that it is offered.

    The green band is what a later axle gains: its peak above the one that axle 1 found at the same place
    (at the speed that the train had then: on rail that keeps nothing, a little remains at the end). A locked
    wheel cleans more than any at the peak, which counts up to a creep of 0.3: at low speed it may use more.
    """
    span = stop_span(truth)
    whole = truth.wheelsets
    first = int(np.searchsorted(whole.t_s, whole.t_s[span[0]] - LEAD_S)) if span else 0
    last = span[1] + 1 if span else len(whole)
    wheelsets = whole.rows(slice(first, last))
    figure, panels = new_figure("Slip and utilised adhesion", 8.6, rows=4, columns=2, sharey="col")
    t_s = wheelsets.t_s
    load_n = wheelsets.normal_force_n.reshape(-1, 4, 2).sum(axis=2)
    force_n = wheelsets.longitudinal_force_n.reshape(-1, 4, 2).sum(axis=2)
    moving = np.abs(wheelsets.speed_mps) > STANDSTILL_MPS
    utilised = np.where(moving, np.abs(force_n) / np.maximum(load_n, 1.0), np.nan)
    fast = np.abs(wheelsets.speed_mps) > SLIP_COUNTS_ABOVE_MPS
    slip_percent = 100.0 * np.where(fast, wheelsets.slip, np.nan)
    for i, colour in enumerate(AXLE_COLOURS):
        left, right = panels[i]
        plot(left, t_s, slip_percent[:, i], color=colour)
        left.set_ylabel(f"axle {i + 1}   slip  %")
        peak = wheelsets.peak_adhesion[:, i]
        if i > 0:
            # slower, the few metres between the axles make a difference of speed and thus of the peak
            found = np.where(fast[:, i], _found_by_first(whole, wheelsets.position_m[:, i]), np.nan)
            every = slice(None, None, max(1, len(t_s) // round(right.bbox.width)))
            right.fill_between(
                t_s[every], found[every], np.maximum(peak, found)[every], color=GAIN_COLOUR, linewidth=0.0,
                label="more than axle 1 found there, a little faster",
            )  # fmt: skip
        plot(right, t_s, utilised[:, i], color=colour, label="utilised")
        plot(right, t_s, peak, color=TRUE_COLOUR, linewidth=0.9, label="peak on the rail there")
        right.set_ylabel("adhesion  -")
    top = 1.25 * float(np.quantile(wheelsets.peak_adhesion[span[0] - first if span else 0 :], 0.99))
    panels[0, 1].set_ylim(0.0, top)
    panels[0, 0].set_title("slip (speed - rim speed)/speed, above 10 km/h")
    panels[0, 1].set_title("force over load; the peak is that of creep up to 0.3")
    legend(panels[1, 1], place="lower center")
    for axes in panels[-1]:
        axes.set_xlabel("time  s")
    return figure


def _found_by_first(wheelsets: WheelsetStream, position_m: np.ndarray) -> np.ndarray:
    """Peak adhesion that axle 1 found at these places of its way."""
    way_m = np.maximum.accumulate(wheelsets.position_m[:, 0])
    return np.interp(position_m, way_m, wheelsets.peak_adhesion[:, 0])
