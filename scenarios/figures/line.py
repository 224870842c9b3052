"""The line as the coach met it: speed, adhesion, gradient, curvature and cant over position."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.figures.style import AXLE_COLOURS, TRUE_COLOUR, legend, new_figure, plot
from scenarios.metrics import stop_span
from scenarios.path_classes import DEGRADED_BELOW
from scenarios.truth import Truth
from scenarios.units import KMH_PER_MPS
from sensors.readings import BaliseReadings
from wheel_rail import Irregularities
from wheel_rail.irregularity_spectra import QUANTITIES

MARK_COLOUR = "#d62728"
DEGRADED_COLOUR = "#fbe5c8"


def draw_line(truth: Truth, balises: BaliseReadings, irregularities: Irregularities | None = None) -> Figure:
    """Marked: where the brake was demanded, where the coach stopped, where balises were read, where the rail is
    slippery (shaded).

    Rough rails have two panels more: what is felt in height and sideways, and what turns and squeezes wheelsets.
    """
    motion, wheelsets = truth.motion, truth.wheelsets
    heights = [1.4, 1.4, 1.0, 1.0, 1.0] + ([] if irregularities is None else [1.2, 1.2])
    height_in = 0.9 + 1.26 * sum(heights)
    figure, panels = new_figure("The line and the run over it", height_in, rows=len(heights), height_ratios=heights)
    speed, adhesion, gradient, curvature, cant = panels[:5]
    position_m = motion.position_m
    plot(speed, position_m, KMH_PER_MPS * motion.speed_mps, color=TRUE_COLOUR)
    plot(adhesion, wheelsets.position_m[:, 0], wheelsets.peak_adhesion[:, 0], color=AXLE_COLOURS[0])
    plot(gradient, position_m, motion.gradient_permille, color=TRUE_COLOUR)
    plot(curvature, position_m, 1000.0 * motion.curvature_radpm, color=TRUE_COLOUR)
    plot(cant, position_m, motion.cant_mm, color=TRUE_COLOUR)
    speed.set_ylabel("speed  km/h")
    adhesion.set_ylabel("peak adhesion, axle 1  -")
    adhesion.set_ylim(bottom=0.0)
    gradient.set_ylabel("gradient  per mille")
    curvature.set_ylabel("curvature  1/km")
    cant.set_ylabel("cant  mm")
    for axes, signs in ((gradient, "uphill"), (curvature, "to the left"), (cant, "right rail raised")):
        axes.text(0.995, 0.9, f"positive: {signs}", transform=axes.transAxes, ha="right", va="top", fontsize=8)
    if irregularities is not None:
        _draw_irregularities(panels[5], panels[6], irregularities, position_m)
    panels[-1].set_xlabel("position  m")
    mark_stop(panels, truth)
    _shade_degraded(panels, truth)
    for axes in panels:
        for k, told_m in enumerate(balises.position_m):
            axes.axvline(told_m, color="grey", linestyle=":", linewidth=0.9, label="balise" if k == 0 else None)
    legend(speed, columns=4, place="lower center")
    return figure


def _draw_irregularities(mean: Axes, difference: Axes, rough: Irregularities, position_m: np.ndarray) -> None:
    """The four quantities of the rails that the coach ran over."""
    place_m = rough.position_m
    rows = (place_m >= position_m.min()) & (place_m <= position_m.max())
    for axes, columns in ((mean, (0, 1)), (difference, (2, 3))):
        for k in columns:
            look = {"color": AXLE_COLOURS[k], "linewidth": 0.7, "label": QUANTITIES[k].replace("_", " ")}
            plot(axes, place_m[rows], 1e3 * rough.values_m[rows, k], **look)
        axes.set_ylabel("rails  mm")
        legend(axes, columns=2, place="upper right")


def _shade_degraded(panels: Iterable[Axes], truth: Truth) -> None:
    """Where the first wheelset found less peak adhesion than `DEGRADED_BELOW`; the first panel has its name."""
    position_m, peak = truth.wheelsets.position_m[:, 0], truth.wheelsets.peak_adhesion[:, 0]
    borders = np.flatnonzero(np.diff(peak < DEGRADED_BELOW, prepend=False, append=False))
    begins, ends = position_m[borders[::2]], position_m[np.minimum(borders[1::2], len(position_m) - 1)]
    spans = list(zip(begins, ends - begins, strict=True))
    for k, axes in enumerate(panels):
        label = f"peak adhesion below {DEGRADED_BELOW:g}" if k == 0 and spans else None
        axes.broken_barh(
            spans, (0.0, 1.0), transform=axes.get_xaxis_transform(), color=DEGRADED_COLOUR, linewidth=0.0, zorder=0.2,
            label=label,
        )  # fmt: skip


def mark_stop(panels: Iterable[Axes], truth: Truth) -> None:
    """Vertical lines where the carbody's centre was when the brake was demanded, and where it stopped.

    The first panel has their names.
    """
    span = stop_span(truth)
    if span is not None:
        for k, axes in enumerate(panels):
            for row, line, name in ((span[0], "-", "brake demanded"), (span[1], "--", "stopped")):
                place_m = truth.motion.position_m[row]
                label = name if k == 0 else None
                axes.axvline(place_m, color=MARK_COLOUR, linewidth=0.9, linestyle=line, label=label)
