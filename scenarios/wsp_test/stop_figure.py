"""One stop in the form that brake engineers read: speeds, pressures, valves, adhesion used, brake performance."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.figures.axle_speeds import valve_bars
from scenarios.figures.style import AXLE_COLOURS, REFERENCE_COLOUR, TRUE_COLOUR, legend, new_figure, note, plot
from scenarios.truth import Truth
from scenarios.units import KMH_PER_MPS
from scenarios.wsp_test.programme import Stop
from scenarios.wsp_test.results import STRIP_SHORTEST_S
from scenarios.wsp_test.scorecard import brake_stretches, braking_ratio, slide_events_s
from scenarios.wsp_test.spans import spans

SLIDE_COLOUR = "#f3d9d9"
STRIP_COLOURS = {"more": "#4c9f70", "less": "#c65b4e"}
MEAN_OVER_S = 0.5


def draw_stop(stop: Stop, truth: Truth, required_ratio: float | None) -> Figure:
    """The whole record of a stop; `required_ratio` is the braking ratio of full service on dry rail."""
    events = slide_events_s(truth, stop.scoring)
    figure, panels = new_figure(
        f"{stop.name}: axle speeds, pressures, valves, adhesion", 11.4, rows=5, height_ratios=[4.0, 2.2, 1.6, 2.4, 1.5]
    )
    speeds, pressures, valves, adhesion, strip = panels
    for axes in (speeds, adhesion):
        for k, (begin_s, end_s) in enumerate(events):
            label = "slide event" if k == 0 and axes is speeds else None
            axes.axvspan(begin_s, end_s, color=SLIDE_COLOUR, linewidth=0.0, label=label, zorder=0)
    _speeds(speeds, truth)
    _pressures(pressures, truth)
    valve_bars(valves, truth.brake)
    _safety_timer(valves, truth)
    _adhesion(adhesion, truth)
    _strip(strip, stop, truth, required_ratio)
    strip.set_xlabel("time  s")
    strip.set_xlim(truth.motion.t_s[0], truth.motion.t_s[-1])
    return figure


def _speeds(axes: Axes, truth: Truth) -> None:
    motion, brake = truth.motion, truth.brake
    for i, colour in enumerate(AXLE_COLOURS):
        look: dict[str, Any] = {"color": colour, "linewidth": 0.9, "label": f"axle {i + 1}, as the WSP sees it"}
        plot(axes, brake.t_s, KMH_PER_MPS * brake.axle_speed_mps[:, i], **look)
    if np.isfinite(brake.reference_speed_mps).any():
        reference_kmh = KMH_PER_MPS * brake.reference_speed_mps
        plot(axes, brake.t_s, reference_kmh, color=REFERENCE_COLOUR, label="reference speed", linewidth=1.3)
    plot(axes, motion.t_s, KMH_PER_MPS * motion.speed_mps, "--", color=TRUE_COLOUR, label="true speed", linewidth=1.0)
    axes.set_ylabel("speed  km/h")
    axes.set_ylim(bottom=-2.0)
    legend(axes, columns=2, place="upper right")


def _pressures(axes: Axes, truth: Truth) -> None:
    brake = truth.brake
    for i, colour in enumerate(AXLE_COLOURS):
        plot(axes, brake.t_s, brake.cylinder_pressure_bar[:, i], color=colour, linewidth=0.9, label=f"axle {i + 1}")
    plot(axes, brake.t_s, brake.distributor_pressure_bar, "--", color="grey", label="distributor")
    plot(axes, brake.t_s, brake.reservoir_pressure_bar, ":", color="black", label="reservoir")
    axes.set_ylabel("pressure  bar")
    axes.set_ylim(-0.1, 1.35 * max(float(brake.reservoir_pressure_bar.max()), 0.1))
    legend(axes, columns=6, place="upper right")


def _safety_timer(axes: Axes, truth: Truth) -> None:
    """Where the safety timer holds an axle's valves de-energised: hatched over the bars."""
    t_s = truth.brake.t_s
    for i in range(4):
        fired = spans(truth.brake.safety_timer_fired[:, i] > 0)
        bars = [(t_s[begin], t_s[min(end, len(t_s) - 1)] - t_s[begin]) for begin, end in fired]
        axes.broken_barh(
            bars, (3.6 - i, 0.8), facecolor="white", edgecolor=REFERENCE_COLOUR, hatch="///", linewidth=0.8
        )
        if bars:
            box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
            axes.text(
                bars[0][0] + 0.5, 4.0 - i, "safety timer", va="center", fontsize=7, color=REFERENCE_COLOUR, bbox=box
            )


def _adhesion(axes: Axes, truth: Truth) -> None:
    """Longitudinal force over load of each wheelset, and what the rail offers the best and the worst placed."""
    wheelsets = truth.wheelsets
    load_n = np.maximum(wheelsets.normal_force_n.reshape(-1, 4, 2).sum(axis=2), 1.0)
    used = -wheelsets.longitudinal_force_n.reshape(-1, 4, 2).sum(axis=2) / load_n
    t_s = wheelsets.t_s
    for i, colour in enumerate(AXLE_COLOURS):
        plot(axes, t_s, used[:, i], color=colour, linewidth=0.7)
    moving = truth.motion.speed_mps > 0.5
    offered = np.where(moving[:, None], wheelsets.peak_adhesion, np.nan)
    plot(axes, t_s, offered.mean(axis=1), "--", color=TRUE_COLOUR, linewidth=1.0, label="on offer, mean of the axles")
    axes.set_ylabel("adhesion used  1")
    highest = 1.15 * float(np.quantile(used[moving], 0.999)) if moving.any() else 0.1
    axes.set_ylim(-0.005, max(1.25 * highest, 0.02))
    legend(axes, place="upper right")


def _strip(axes: Axes, stop: Stop, truth: Truth, required_ratio: float | None) -> None:
    """(achieved - required)/required: running mean in grey, stretches of constant demand of 10 s and more as bars."""
    axes.set_ylabel("performance  %")
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.set_ylim(-105.0, 60.0)
    if required_ratio is None:
        note(axes, "no dry reference tells what is required")
        return
    motion, demand = truth.motion, truth.brake.demand
    period_s = float(np.median(np.diff(motion.t_s)))
    width = max(1, round(MEAN_OVER_S / period_s))
    achieved = np.convolve(braking_ratio(truth), np.full(width, 1.0 / width), mode="same")
    braked = (demand > 0.0) & (motion.speed_mps > 0.5)
    required = np.where(braked, demand * required_ratio, np.nan)
    plot(axes, motion.t_s, 100.0 * (achieved / required - 1.0), color="grey", linewidth=0.7)
    for stretch in brake_stretches(truth, stop.scoring):
        if stretch.duration_s < STRIP_SHORTEST_S:
            continue
        value = 100.0 * (stretch.braking_ratio / (stretch.demand * required_ratio) - 1.0)
        colour = STRIP_COLOURS["more" if value >= 0.0 else "less"]
        axes.bar(stretch.begin_s, value, stretch.duration_s, align="edge", color=colour, alpha=0.55, zorder=1)
        axes.text(
            stretch.begin_s + 0.5 * stretch.duration_s,
            12.0,
            f"{value:+.0f} % at demand {stretch.demand:g}",
            ha="center",
        )
