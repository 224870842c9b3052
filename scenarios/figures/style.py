"""The look that all figures share."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

AXLE_COLOURS = ("#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd")
ESTIMATOR_COLOURS = ("#d62728", "#1f77b4", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b")
TRUE_COLOUR = "black"
REFERENCE_COLOUR = "#d62728"
BAND_COLOUR = "#c8dcc8"
DPI = 110
WIDTH_IN = 11.0
LABEL_DISTANCE_IN = 0.58
MOST_POINTS = 6000

Place = Literal["best", "upper left", "upper right", "lower left", "lower right", "lower center"]

SETTINGS: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.xmargin": 0.01,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.fontsize": 8.0,
    "legend.framealpha": 0.85,
    "lines.linewidth": 1.0,
    "path.simplify_threshold": 0.3,
    "agg.path.chunksize": 20_000,
}


@contextmanager
def figure_style() -> Iterator[None]:
    """The settings hold for what is drawn inside."""
    with matplotlib.rc_context(SETTINGS):
        yield


def new_figure(
    title: str, height_in: float, rows: int, columns: int = 1, right_in: float = 0.15, **subplots: Any
) -> tuple[Figure, Any]:
    """A figure (without any window system behind it) and its panels, which share the horizontal axis.

    Margins are fixed: letting matplotlib find them takes as long as all the drawing.
    """
    figure = Figure(figsize=(WIDTH_IN, height_in), dpi=DPI)
    figure.suptitle(title, fontsize=11, fontweight="bold", y=1.0 - 0.12 / height_in, va="top")
    margins = {
        "left": 0.75 / WIDTH_IN,
        "right": 1.0 - right_in / WIDTH_IN,
        "bottom": 0.5 / height_in,
        "top": 1.0 - (0.42 if columns == 1 else 0.62) / height_in,
        "hspace": 0.1,
        "wspace": 0.16,
    }
    panels = figure.subplots(rows, columns, sharex=True, gridspec_kw=margins, **subplots)
    for axes in figure.axes:
        axes.locator_params(nbins=6)  # every tick costs as much as a line
        axes.yaxis.set_label_coords(-LABEL_DISTANCE_IN / (axes.get_position().width * WIDTH_IN), 0.5)
    return figure, panels


def thinned(length: int) -> slice:
    """Every n-th row, so that no more points are drawn than a screen can show."""
    return slice(None, None, max(1, length // MOST_POINTS))


def legend(axes: Axes, columns: int = 1, place: Place = "best") -> None:
    """A legend if there is anything to tell; looking for the "best" place is slow over long lines."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc=place, ncols=columns)


def robust_limits(values: NDArray[np.float64], margin: float = 0.05) -> tuple[float, float]:
    """Limits of an axis that a few outliers do not blow up: the 0.1 % and 99.9 % quantiles and a margin."""
    low, high = np.nanquantile(values, [0.001, 0.999])
    span = max(high - low, 1e-9)
    return low - margin * span, high + margin * span
