"""The look that all figures share, and what keeps drawing them cheap."""

import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import Any, Literal

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.path import Path
from matplotlib.transforms import IdentityTransform
from numpy.typing import NDArray

AXLE_COLOURS = ("#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd")
ESTIMATOR_COLOURS = ("#d62728", "#1f77b4", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b")
TRUE_COLOUR = "black"
REFERENCE_COLOUR = "#d62728"
BAND_COLOUR = "#c8dcc8"
GAIN_COLOUR = "#8fcf8f"
GRID_COLOUR = "#e4e4e4"
DPI = 100
WIDTH_IN = 11.0
LABEL_DISTANCE_IN = 0.58
TICKS_PER_IN = 2.5
POINTS_PER_IN = 72.0
PNG_SIGNATURE, FILTER_UP = b"\x89PNG\r\n\x1a\n", 2

Place = Literal[
    "best", "upper left", "upper right", "lower left", "lower right", "lower center", "upper center", "center"
]

SETTINGS: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.grid": False,  # see _Grid
    "axes.xmargin": 0.01,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.fontsize": 8.0,
    "legend.framealpha": 0.85,
    "legend.fancybox": False,
    "lines.linewidth": 1.0,
    "path.simplify_threshold": 0.3,
    "agg.path.chunksize": 20_000,
}


class _Grid(Artist):
    """Grid lines of one panel in one stroke: matplotlib's own cost an object each, for every panel that shares an axis.

    A panel whose horizontal axis is drawn by the panel below has no ticks of its own, so the lines come from the
    locators alone.
    """

    zorder = 0.5

    def draw(self, renderer: RendererBase) -> None:
        axes = self.axes
        if axes is None or not self.get_visible():
            return
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        ends = [((x, bottom), (x, top)) for x in axes.xaxis.get_majorticklocs() if left <= x <= right]
        ends += [((left, y), (right, y)) for y in axes.yaxis.get_majorticklocs() if bottom <= y <= top]
        if ends:
            # the renderer takes affine transforms only, and an axis may be logarithmic
            corners = axes.transData.transform(np.reshape(ends, (-1, 2)))
            lines = Path(corners, np.tile([Path.MOVETO, Path.LINETO], len(ends)))
            pen = renderer.new_gc()
            pen.set_foreground(GRID_COLOUR)
            pen.set_linewidth(0.7 * DPI / POINTS_PER_IN)
            pen.set_snap(True)
            renderer.draw_path(pen, lines, IdentityTransform())
            pen.restore()


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
        "wspace": 0.18,
    }
    panels = figure.subplots(rows, columns, sharex=True, gridspec_kw=margins, **subplots)
    for axes in figure.axes:
        place = axes.get_position()
        # every tick costs as much as a line
        axes.locator_params(axis="x", nbins=6)
        axes.locator_params(axis="y", nbins=int(np.clip(round(TICKS_PER_IN * place.height * height_in), 3, 6)))
        axes.yaxis.set_label_coords(-LABEL_DISTANCE_IN / (place.width * WIDTH_IN), 0.5)
        axes.add_artist(_Grid())
        if axes not in figure.axes[-columns:]:
            axes.xaxis.set_visible(False)
    return figure, panels


def write_png(figure: Figure, file: FilePath) -> None:
    """Paint the figure into a PNG file: its rows as differences to the row above, which for figures are mostly zeros.

    Plain run lengths of those pack as well as what encoders choose row by row, in a quarter of the time.
    """
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[:, :, :3]
    height, width, colours = pixels.shape
    values = pixels.reshape(height, colours * width)
    rows = np.full((height, 1 + colours * width), FILTER_UP, np.uint8)
    rows[0, 1:] = values[0]
    np.subtract(values[1:], values[:-1], out=rows[1:, 1:])
    packer = zlib.compressobj(1, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE)
    # 8 bits of red, green and blue; no interlacing
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", packer.compress(rows.tobytes()) + packer.flush()), (b"IEND", b""))
    file.write_bytes(PNG_SIGNATURE + b"".join(_png_part(kind, content) for kind, content in parts))


def _png_part(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def plot(axes: Axes, x: NDArray[np.float64], y: NDArray[np.float64], *form: str, **look: Any) -> None:
    """A line through no more points than the panel can show; all of its extremes are kept."""
    rows = with_extremes(y, round(axes.bbox.width))
    axes.plot(x[rows], y[rows], *form, **look)


def with_extremes(values: NDArray[np.float64], parts: int) -> NDArray[np.intp]:
    """Rows of the least and the greatest of `values` (n,) in each of some `parts` equal parts, and of both ends.

    Parts that hold nothing but nan keep one, so that gaps stay gaps.
    """
    size = len(values) // max(parts, 1)
    if size < 3:
        return np.arange(len(values))
    whole = len(values) // size * size
    part = values[:whole].reshape(-1, size)
    unknown = np.isnan(part)
    begins = size * np.arange(len(part))
    least = begins + np.where(unknown, np.inf, part).argmin(axis=1)
    greatest = begins + np.where(unknown, -np.inf, part).argmax(axis=1)
    return np.unique(np.concatenate([[0], least, greatest, np.arange(whole, len(values)), [len(values) - 1]]))


def legend(axes: Axes, columns: int = 1, place: Place = "best") -> None:
    """A legend if there is anything to tell; looking for the "best" place is slow over long lines."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc=place, ncols=columns)


def note(axes: Axes, text: str) -> None:
    """A sentence in the middle of a panel, where its curves do not speak for themselves."""
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85}
    axes.text(0.5, 0.45, text, transform=axes.transAxes, ha="center", va="center", color="dimgrey", bbox=box)


def robust_limits(values: NDArray[np.float64], margin: float = 0.05) -> tuple[float, float]:
    """Limits of an axis that a few outliers do not blow up: the 0.1 % and 99.9 % quantiles and a margin."""
    low, high = np.nanquantile(values, [0.001, 0.999])
    span = max(high - low, 1e-9)
    return low - margin * span, high + margin * span
