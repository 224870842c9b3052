"""Pictures of a whole programme: distances, slip, air, brake performance."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from scenarios.figures.style import DPI, GRID_COLOUR, WIDTH_IN, figure_style, note, write_png
from scenarios.wsp_test.limits import Limit
from scenarios.wsp_test.report import Scorecard
from scenarios.wsp_test.results import METRICS, Result
from scenarios.wsp_test.scorecard import SLIP_BINS

GROUP_COLOURS = (
    "#7f7f7f", "#1f77b4", "#17becf", "#9467bd", "#ff7f0e", "#bcbd22", "#8c564b", "#2ca02c", "#d62728", "#e377c2",
)  # fmt: skip
BEYOND_COLOUR = "#d62728"
ROW_IN = 0.185


def write_summaries(folder: Path, card: Scorecard) -> list[Path]:
    """Draw all pictures of the programme into `folder`."""
    drawings: dict[str, Callable[[Scorecard], Figure]] = {
        "distances.png": draw_distances,
        "brake-performance.png": draw_performance,
        "slip-histogram.png": draw_slip_histogram,
        "utilisation-air.png": draw_utilisation_air,
    }
    with figure_style():
        for name, draw in drawings.items():
            write_png(draw(card), folder / name)
    return [folder / name for name in drawings]


def _colours(card: Scorecard) -> dict[str, str]:
    return {group: GROUP_COLOURS[k % len(GROUP_COLOURS)] for k, group in enumerate(card.programme.groups)}


def _title(figure: Figure, card: Scorecard, text: str) -> None:
    height_in = figure.get_size_inches()[1]
    figure.suptitle(f"{card.controller}: {text}", fontsize=11, fontweight="bold", y=1.0 - 0.12 / height_in, va="top")


def _group_legend(figure: Figure, card: Scorecard, more: list[Patch | Line2D]) -> None:
    """Below the panels: colours of the groups that there are, and what else is to be told."""
    handles: list[Patch | Line2D] = [
        Patch(color=colour, label=card.programme.groups[group])
        for group, colour in _colours(card).items()
        if card.of_group(group)
    ]
    figure.legend(handles=[*handles, *more], loc="lower center", ncols=4, frameon=False, fontsize=8)


def _rows_figure(card: Scorecard, panels: int) -> tuple[Figure, list[Axes]]:
    """A row for each stop, named at the left, and some panels beside each other."""
    rows = max(len(card.results), 3)
    height_in = 1.9 + ROW_IN * rows
    figure = Figure(figsize=(WIDTH_IN, height_in), dpi=DPI)
    margins = {
        "left": 2.2 / WIDTH_IN,
        "right": 1.0 - 0.2 / WIDTH_IN,
        "bottom": 1.3 / height_in,
        "top": 1.0 - 0.55 / height_in,
        "wspace": 0.08,
    }
    found = figure.subplots(1, panels, sharey=True, squeeze=False, gridspec_kw=margins)[0]
    for axes in found:
        axes.set_ylim(rows - 0.4, -0.6)
        axes.grid(axis="x", color=GRID_COLOUR)
        axes.set_axisbelow(True)
        axes.tick_params(axis="y", length=0, labelsize=8)
    found[0].set_yticks(range(len(card.results)), [result.stop.name for result in card.results])
    return figure, list(found)


def draw_distances(card: Scorecard) -> Figure:
    """Bars per stop: distance over the shortest possible, over dry, and adhesion utilisation; limits as strokes."""
    figure, panels = _rows_figure(card, 3)
    for axes, metric, label in zip(
        panels,
        ("distance_over_shortest", "distance_over_dry", "adhesion_utilisation"),
        ("distance over shortest possible  1", "distance over dry  1", "adhesion utilisation  1"),
        strict=True,
    ):
        _bars(axes, card, metric)
        axes.set_xlabel(label)
    _title(figure, card, "stopping distances and adhesion used, stop by stop")
    _group_legend(figure, card, _limit_handles())
    return figure


def _limit_handles() -> list[Patch | Line2D]:
    return [
        Line2D([], [], color="black", linewidth=2.0, linestyle="none", marker="|", markersize=9, label="limit, kept"),
        Line2D([], [], color=BEYOND_COLOUR, linewidth=2.0, linestyle="none", marker="|", markersize=9,
               markeredgewidth=2.0, label="limit, stop lies beyond"),
    ]  # fmt: skip


def _bars(axes: Axes, card: Scorecard, metric: str) -> None:
    colours = _colours(card)
    begin = 1.0 if metric.startswith("distance_over") else 0.0
    known = [value for value in (METRICS[metric].value(result) for result in card.results) if value is not None]
    # one stop far off must not flatten all others
    right = max(begin + 0.4, begin + 1.2 * float(np.quantile(known, 0.9) - begin)) if known else begin + 1.0
    for row, result in enumerate(card.results):
        value = METRICS[metric].value(result)
        if value is None:
            axes.text(begin, row, " -", va="center", fontsize=7, color="grey")
            continue
        axes.barh(row, min(value, right) - begin, left=begin, height=0.72, color=colours[result.stop.group])
        limits = _limits_of(card, result, metric)
        if value > right:
            axes.text(right, row, f"{value:.2f} > ", va="center", ha="right", fontsize=7, color="white")
        else:
            place = max([value, begin, *(limit.bound for limit in limits)])
            axes.text(place, row, f" {value:.2f}", va="center", fontsize=7)
        for limit in limits:
            colour = BEYOND_COLOUR if limit.exceeded(value) else "black"
            axes.plot([limit.bound] * 2, [row - 0.45, row + 0.45], color=colour, linewidth=2.0)
    least = min([begin, *known])
    axes.set_xlim(least - 0.04 * (right - least), right + 0.16 * (right - least))


def _limits_of(card: Scorecard, result: Result, metric: str) -> list[Limit]:
    return [limit for limit in card.limits if limit.metric == metric and limit.applies(result.stop.limits)]


def draw_performance(card: Scorecard) -> Figure:
    """(achieved - required)/required of every stretch of constant demand of 10 s and more."""
    figure, (axes,) = _rows_figure(card, 1)
    colours = _colours(card)
    for row, result in enumerate(card.results):
        stretches = result.performances()
        height = 0.72 / max(len(stretches), 1)
        for k, (_, value) in enumerate(stretches):
            place = row - 0.36 + (k + 0.5) * height
            axes.barh(place, 100.0 * value, height=height, color=colours[result.stop.group])
        told = [f"{100.0 * value:+.0f} % in {s.duration_s:.0f} s at demand {s.demand:g}" for s, value in stretches]
        text = ", ".join(told) or "no stretch of 10 s"
        place = max([100.0 * value for _, value in stretches], default=0.0)
        axes.text(max(place, 0.0) + 1.0, row, text, va="center", fontsize=7, color="black" if told else "grey")
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.set_xlabel(
        "brake force achieved over required, less 1  %   (required: the demand's share of full service on dry rail)"
    )
    axes.set_xlim(-100.0, 60.0)
    _title(figure, card, "brake performance in stretches of constant demand of 10 s and more")
    _group_legend(figure, card, [])
    return figure


def draw_slip_histogram(card: Scorecard) -> Figure:
    """Share of the time under brake demand above 10 km/h that the wheelsets of a group spend in each range of slip."""
    groups = [group for group in card.programme.groups if card.of_group(group)]
    figure = Figure(figsize=(WIDTH_IN, 5.4), dpi=DPI)
    axes = figure.subplots(
        gridspec_kw={"left": 0.075, "right": 0.985, "bottom": 0.29, "top": 0.9}  # the legend lies below
    )
    bins = len(SLIP_BINS) - 1
    width = 0.84 / max(len(groups), 1)
    colours = _colours(card)
    for k, group in enumerate(groups):
        time_s = np.sum([w.slip_histogram_s for result in card.of_group(group) for w in result.score.wheelsets], axis=0)
        share = 100.0 * time_s / max(float(time_s.sum()), 1e-9)
        axes.bar(np.arange(bins) - 0.42 + (k + 0.5) * width, share, width, color=colours[group])
    edges = [f"{100 * low:g}..{100 * high:g}" for low, high in pairwise(SLIP_BINS)]
    edges[0], edges[-1] = "below 0", "above 90"
    axes.set_xticks(range(bins), edges)
    axes.set_xlabel("slip  %")
    axes.set_ylabel("share of braking time above 10 km/h  %")
    axes.set_yscale("log")  # rare high slip is what flattens wheels
    axes.set_ylim(0.01, 130.0)
    axes.yaxis.set_major_formatter("{x:g}")
    axes.grid(axis="y", color=GRID_COLOUR)
    axes.set_axisbelow(True)
    _title(figure, card, "slip of all wheelsets")
    _group_legend(figure, card, [])
    return figure


def draw_utilisation_air(card: Scorecard) -> Figure:
    """Adhesion utilisation of each stop over the air that it took."""
    figure = Figure(figsize=(WIDTH_IN, 6.0), dpi=DPI)
    axes = figure.subplots(gridspec_kw={"left": 0.075, "right": 0.985, "bottom": 0.25, "top": 0.91})
    colours = _colours(card)
    shown = 0
    for result in card.results:
        used = result.score.adhesion_utilisation
        if used is None:
            continue
        shown += 1
        axes.scatter(
            result.score.air_nl, used, s=34, color=colours[result.stop.group], edgecolor="white", linewidth=0.5
        )
    if not shown:
        note(axes, "no wheelset slid in any stop")
    axes.set_xlabel("air drawn in the stop  normal litres")
    axes.set_ylabel("adhesion utilisation  1")
    axes.set_ylim(top=1.02)
    axes.set_xlim(left=0.0)
    axes.grid(color=GRID_COLOUR)
    axes.set_axisbelow(True)
    _title(figure, card, "adhesion used over air drawn, a point for each stop")
    _group_legend(figure, card, [])
    return figure
