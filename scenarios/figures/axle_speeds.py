"""The form that brake engineers read: speeds over cylinder pressures over the bars of the valves, axle by axle.

Drive torques have a place of their own where there are any: motors, or a dynamic brake.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from scenarios.figures.style import AXLE_COLOURS, REFERENCE_COLOUR, TRUE_COLOUR, legend, new_figure, note, plot
from scenarios.metrics import locked, stop_span
from scenarios.truth import BrakeStream, Truth, WheelsetStream
from scenarios.units import KMH_PER_MPS

HOLD, VENT = 1, 2
VALVE_COLOURS = {HOLD: "#f7d98b", VENT: "#1f4e9c"}
LEAD_S = 5.0
LEAST_DRIVE_NM = 10.0


def draw_axle_speeds(truth: Truth) -> Figure:
    """From shortly before the brake demand to the end; the whole run if nobody brakes."""
    span = stop_span(truth)
    first_s = truth.motion.t_s[0] if span is None else max(truth.motion.t_s[0], truth.motion.t_s[span[0]] - LEAD_S)
    brake = truth.brake.rows(slice(int(np.searchsorted(truth.brake.t_s, first_s)), None))
    motion = truth.motion.rows(slice(int(np.searchsorted(truth.motion.t_s, first_s)), None))
    wheelsets = truth.wheelsets.rows(slice(int(np.searchsorted(truth.wheelsets.t_s, first_s)), None))
    drives = bool((np.abs(wheelsets.drive_torque_nm) > LEAST_DRIVE_NM).any())
    brakes = bool((brake.demand > 0.0).any()) or not drives
    heights = [4.0, *([1.8] if drives else []), *([2.4, 1.8] if brakes else [])]
    title = "Axle speeds, cylinder pressures and valves" if brakes else "Axle speeds and drive torques"
    figure, rows = new_figure(title, 8.6, rows=len(heights), height_ratios=heights)
    speeds = rows[0]
    for i, colour in enumerate(AXLE_COLOURS):
        seen_kmh = KMH_PER_MPS * brake.axle_speed_mps[:, i]
        plot(speeds, brake.t_s, seen_kmh, label=f"axle {i + 1}, tachometer", color=colour, linewidth=0.9)
    if np.isfinite(brake.reference_speed_mps).any():
        reference_kmh = KMH_PER_MPS * brake.reference_speed_mps
        plot(speeds, brake.t_s, reference_kmh, color=REFERENCE_COLOUR, label="reference speed", linewidth=1.3)
    plot(speeds, motion.t_s, KMH_PER_MPS * motion.speed_mps, "--", color=TRUE_COLOUR, label="true speed", linewidth=1.3)
    _shade_locks(speeds, truth)
    speeds.set_ylabel("speed  km/h")
    speeds.set_ylim(bottom=min(0.0, float(np.nanmin(brake.axle_speed_mps) * KMH_PER_MPS)) - 2.0)
    legend(speeds, columns=2, place="upper right" if brakes else "lower right")
    if drives:
        _drive_torques(rows[1], wheelsets)
    if brakes:
        _cylinder_pressures(rows[-2], brake)
        valve_bars(rows[-1], brake)
    rows[-1].set_xlabel("time  s")
    rows[-1].set_xlim(first_s, motion.t_s[-1])
    return figure


def _drive_torques(axes: Axes, wheelsets: WheelsetStream) -> None:
    for i, colour in enumerate(AXLE_COLOURS):
        torque_knm = wheelsets.drive_torque_nm[:, i] / 1000.0
        plot(axes, wheelsets.t_s, torque_knm, color=colour, linewidth=0.9, label=f"axle {i + 1}")
    axes.set_ylabel("drive torque  kN m")
    legend(axes, columns=4, place="upper right")


def _cylinder_pressures(pressures: Axes, brake: BrakeStream) -> None:
    for i, colour in enumerate(AXLE_COLOURS):
        pressure_bar = brake.cylinder_pressure_bar[:, i]
        plot(pressures, brake.t_s, pressure_bar, color=colour, linewidth=0.9, label=f"axle {i + 1}")
    plot(pressures, brake.t_s, brake.distributor_pressure_bar, "--", color="grey", label="distributor")
    pressures.set_ylabel("cylinder pressure  bar")
    # released cylinders are as much to be seen as full ones: the legend has room of its own above
    pressures.set_ylim(-0.1, 1.3 * max(0.1, float(brake.cylinder_pressure_bar.max())))
    legend(pressures, columns=5, place="upper center")


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


def valve_bars(axes: Axes, brake: BrakeStream) -> None:
    """Bars over time of the state of each axle's valves: hold, vent, nothing where the cylinder fills."""
    for state, colour in VALVE_COLOURS.items():
        corners = np.concatenate([_bars(brake.t_s, brake.valve[:, i] == state, 4.0 - i) for i in range(4)])
        if len(corners):
            # a valve may vent for less than a pixel: an edge of its colour shows it none the less
            edge = 0.7 if state == VENT else 0.0
            bars = PolyCollection(list(corners), facecolors=colour, edgecolors=colour, linewidth=edge, snap=False)
            axes.add_collection(bars, autolim=False)
    if not brake.valve.any():
        note(axes, "no valve holds or vents: the cylinders follow the distributor")
    axes.set_yticks([4.0, 3.0, 2.0, 1.0], ["axle 1", "axle 2", "axle 3", "axle 4"])
    axes.set_ylim(0.4, 5.4)  # the room above is the legend's
    patches = [
        Patch(color=VALVE_COLOURS[HOLD], label="valves hold"),
        Patch(color=VALVE_COLOURS[VENT], label="vent"),
        Patch(facecolor="white", edgecolor="grey", label="fill"),
    ]
    axes.legend(handles=patches, loc="upper left", ncols=3, frameon=False)


def _bars(t_s: np.ndarray, is_on: np.ndarray, place: float) -> np.ndarray:
    """Corners (n, 4, 2) of bars about the height `place` over all spans in which `is_on` holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], is_on, [False]]).astype(np.int8)))
    begins, ends = t_s[edges[::2]], t_s[np.minimum(edges[1::2], len(t_s) - 1)]
    low, high = np.full(len(begins), place - 0.4), np.full(len(begins), place + 0.4)
    return np.stack([begins, low, begins, high, ends, high, ends, low], axis=1).reshape(-1, 4, 2)
