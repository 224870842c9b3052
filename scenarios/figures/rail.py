"""Adhesion along the rail before and after the train."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from scenarios.figures.line import mark_stop
from scenarios.figures.style import AXLE_COLOURS, GAIN_COLOUR, TRUE_COLOUR, legend, new_figure, note, plot
from scenarios.metrics import STANDSTILL_MPS
from scenarios.rail_adhesion import RailAdhesion
from scenarios.truth import RAILS, Truth

RAIL_COLOURS = ("#1f77b4", "#ff7f0e")
LOOKS = ("-", "--")  # left and right rail often are alike
MEASURE = "peak adhesion as a wheel of 68.7 kN finds it at 100 km/h, before it cleans anything itself"


def draw_rail(truth: Truth, adhesion: RailAdhesion) -> Figure:
    """Both rails before and after, the peak that each axle met, the energy left, and the sand if there is any."""
    cells = _cells(truth, adhesion)
    before, after = truth.rail_before.rows(cells), truth.rail.rows(cells)
    sanded = bool(np.any(after.sand_gpm > 0.0) or np.any(before.sand_gpm > 0.0))
    rows = 5 if sanded else 4
    figure, panels = new_figure("Adhesion along the rail before and after the train", 2.0 + 1.7 * rows, rows=rows)
    _rails(panels, adhesion)
    _axles(panels[2], truth, adhesion)
    position_m = after.position_m
    for k, (side, colour) in enumerate(zip(RAILS, RAIL_COLOURS, strict=True)):
        look, name = LOOKS[k], f"{side} rail"
        if np.any(before.energy_jpm > 0.0):
            plot(panels[3], position_m, before.energy_jpm[:, k], ":", color=colour, label=f"{name}, before")
        plot(panels[3], position_m, after.energy_jpm[:, k], look, color=colour, label=f"{name}, after")
        if sanded:
            plot(panels[4], position_m, before.sand_gpm[:, k], ":", color=colour, label=f"{name}, before")
            plot(panels[4], position_m, after.sand_gpm[:, k], look, color=colour, label=f"{name}, after")
    panels[3].set_ylabel("energy on rail  J/m")
    if sanded:
        panels[4].set_ylabel("sand on rail  g/m")
    panels[-1].set_xlabel("position  m")
    _log_scale(panels[3], after.energy_jpm)
    if sanded:
        panels[4].set_ylim(bottom=0.0)
    mark_stop(panels, truth)
    panels[0].set_xlim(adhesion.position_m[0], adhesion.position_m[-1])
    for axes in (panels[0], *panels[2:4]):
        legend(axes, columns=4, place="upper left")
    return figure


def _log_scale(axes: Axes, energy_jpm: np.ndarray) -> None:
    """From 1 J/m up: a wheel that locks in the last metres leaves more than all that slid before."""
    axes.set_ylim(1.0, 3.0 * max(float(energy_jpm.max()), 10.0))
    axes.set_yscale("log")
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter("{x:g}")  # setting powers as formulae takes long
    if not np.any(energy_jpm >= 1.0):
        note(axes, "less than 1 J/m")


def _cells(truth: Truth, adhesion: RailAdhesion) -> slice:
    first, last = np.searchsorted(truth.rail.position_m, [adhesion.position_m[0], adhesion.position_m[-1]])
    return slice(int(first), int(last) + 1)


def _rails(panels: np.ndarray, adhesion: RailAdhesion) -> None:
    """Left and right rail, with a band where the train changed them."""
    position_m = adhesion.position_m
    panels[0].set_title(MEASURE, fontsize=8, pad=2.0)
    lowest = float(min(adhesion.before.min(), adhesion.after.min()))
    highest = float(max(adhesion.before.max(), adhesion.after.max()))
    for axes, side, colour, before, after in zip(
        panels[:2], RAILS, RAIL_COLOURS, adhesion.before, adhesion.after, strict=True
    ):
        axes.fill_between(position_m, before, after, color=GAIN_COLOUR, linewidth=0.0)
        plot(axes, position_m, before, "--", color=TRUE_COLOUR, linewidth=0.9, label="before the train")
        plot(axes, position_m, after, color=colour, label="after it")
        axes.set_ylabel(f"peak, {side} rail  -")
        # room for the legend above
        axes.set_ylim(max(0.0, lowest - 0.15 * (highest - lowest + 0.01)), highest + 0.4 * (highest - lowest + 0.01))
        if np.allclose(before, after, rtol=1e-4):
            note(axes, "left as it was found" if adhesion.recovers else "left as it was found: nothing here recovers")


def _axles(axes: Axes, truth: Truth, adhesion: RailAdhesion) -> None:
    """What each axle met on its way, at its own speed and load."""
    wheelsets = truth.wheelsets
    low, high = np.inf, 0.0
    for i, colour in enumerate(AXLE_COLOURS):
        place_m = wheelsets.position_m[:, i]
        there = (
            (place_m >= adhesion.position_m[0])
            & (place_m <= adhesion.position_m[-1])
            & (np.abs(wheelsets.speed_mps[:, i]) > STANDSTILL_MPS)
        )
        peak = wheelsets.peak_adhesion[there, i]
        if len(peak):
            plot(axes, place_m[there], peak, color=colour, linewidth=0.9, label=f"axle {i + 1}")
            low, high = min(low, float(peak.min())), max(high, float(peak.max()))
    if np.isfinite(low):
        axes.set_ylim(max(0.0, low - 0.15 * (high - low + 0.01)), high + 0.4 * (high - low + 0.01))
    axes.set_ylabel("peak met there  -")
