"""The form that brake engineers read: speeds over cylinder pressures over the bars of the valves, axle by axle."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from scenarios.figures.style import AXLE_COLOURS, REFERENCE_COLOUR, TRUE_COLOUR, legend, new_figure, thinned
from scenarios.metrics import KMH, locked, stop_span
from scenarios.truth import BrakeStream, Truth

HOLD, VENT = 1, 2
VALVE_COLOURS = {HOLD: "#f7d98b", VENT: "#1f4e9c"}
LEAD_S = 5.0


def draw_axle_speeds(truth: Truth) -> Figure:
    """From shortly before the brake demand to the end; the whole run if nobody brakes."""
    brake, motion = truth.brake, truth.motion
    figure, (speeds, pressures, valves) = new_figure(
        "Axle speeds, cylinder pressures and valves", 8.6, rows=3, height_ratios=[4.0, 2.4, 1.8]
    )
    shown = thinned(len(brake))
    t_s = brake.t_s[shown]
    for i, colour in enumerate(AXLE_COLOURS):
        speeds.plot(
            t_s, KMH * brake.axle_speed_mps[shown, i], color=colour, label=f"axle {i + 1}, tachometer", linewidth=0.9
        )
        pressures.plot(t_s, brake.cylinder_pressure_bar[shown, i], color=colour, label=f"axle {i + 1}", linewidth=0.9)
    reference_kmh = KMH * brake.reference_speed_mps[shown]
    if np.isfinite(reference_kmh).any():
        speeds.plot(t_s, reference_kmh, color=REFERENCE_COLOUR, label="reference speed", linewidth=1.3)
    speeds.plot(
        motion.t_s[thinned(len(motion))],
        KMH * motion.speed_mps[thinned(len(motion))],
        color=TRUE_COLOUR,
        linestyle="--",
        label="true speed",
        linewidth=1.3,
    )
    _shade_locks(speeds, truth)
    speeds.set_ylabel("speed  km/h")
    speeds.set_ylim(bottom=min(0.0, float(np.nanmin(brake.axle_speed_mps) * KMH)) - 2.0)
    legend(speeds, columns=2, place="upper right")
    pressures.plot(t_s, brake.distributor_pressure_bar[shown], color="grey", linestyle="--", label="distributor")
    pressures.set_ylabel("cylinder pressure  bar")
    pressures.set_ylim(bottom=-0.1)
    legend(pressures, columns=5, place="lower center")
    _valve_bars(valves, brake)
    valves.set_xlabel("time  s")
    span = stop_span(truth)
    if span is not None:
        valves.set_xlim(max(motion.t_s[0], motion.t_s[span[0]] - LEAD_S), motion.t_s[-1])
    return figure


def _shade_locks(axes: Axes, truth: Truth) -> None:
    """Grey where any axle counts as locked."""
    any_locked = np.asarray(locked(truth.motion, truth.wheelsets).any(axis=1))
    if any_locked.any():
        axes.fill_between(
            truth.motion.t_s,
            0.0,
            1.0,
            where=list(any_locked),
            transform=axes.get_xaxis_transform(),
            color="grey",
            alpha=0.2,
            linewidth=0.0,
            label="an axle is locked",
        )


def _valve_bars(axes: Axes, brake: BrakeStream) -> None:
    for i in range(4):
        for state, colour in VALVE_COLOURS.items():
            is_on = np.concatenate([[False], brake.valve[:, i] == state, [False]])
            edges = np.flatnonzero(np.diff(is_on.astype(np.int8)))
            begins, ends = edges[::2], np.minimum(edges[1::2], len(brake) - 1)
            bars = [(brake.t_s[b], brake.t_s[e] - brake.t_s[b]) for b, e in zip(begins, ends, strict=True)]
            if bars:
                axes.broken_barh(bars, (3.6 - i, 0.8), facecolors=colour, linewidth=0.0)
    axes.set_yticks([4.0, 3.0, 2.0, 1.0], ["axle 1", "axle 2", "axle 3", "axle 4"])
    axes.set_ylim(0.4, 5.4)  # the room above is the legend's
    axes.grid(visible=False, axis="y")
    patches = [
        Patch(color=VALVE_COLOURS[HOLD], label="valves hold"),
        Patch(color=VALVE_COLOURS[VENT], label="vent"),
        Patch(facecolor="white", edgecolor="grey", label="fill"),
    ]
    axes.legend(handles=patches, loc="upper left", ncols=3, frameon=False)
