"""Creep-force curves of all creep laws on one sheet."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.figures.style import AXLE_COLOURS, ESTIMATOR_COLOURS, TRUE_COLOUR, legend, new_figure
from wheel_rail.creep_laws import LawInForce, creep_force

CREEPS = np.geomspace(1e-5, 0.4, 160)
SPIN_1PM = 0.2  # of a wheel whose contact stands at a slope of about 1:10
SPEEDS_MPS = (5.0, 10.0, 30.0, 50.0)
SEVERAL_SPEEDS = {"polach": "-", "modified-fastsim": "--"}
MARKERS = "ox^s"

Points = Mapping[float, float]
CreepOf = Callable[[float], tuple[float, float, float]]


@dataclass(frozen=True)
class CreepSheet:
    """What the curves are drawn for: one patch under one load at `speed_mps`.

    `patch` (6,) and the friction curves `constant`, `falling` (5,): as creep laws take them. `published`,
    `published_falling`: name -> creep -> longitudinal force in N, to be marked.
    """

    normal_force_n: float
    patch: np.ndarray
    shear_modulus_pa: float
    speed_mps: float
    constant: np.ndarray
    falling: np.ndarray
    published: Mapping[str, Points]
    published_falling: Mapping[str, Points]

    def adhesion(self, law: LawInForce, creep_of: CreepOf, rail: np.ndarray, speed_mps: float) -> np.ndarray:
        """Force against the creep over load, along and across the track, (n, 2), for all `CREEPS`.

        `creep_of`: from the abscissa to longitudinal and lateral creepage and spin (1/m).
        """
        found = []
        for creep in CREEPS:
            x, y, spin = creep_of(creep)
            slip_speed = float(np.hypot(x, y)) * speed_mps
            force = creep_force(
                law.number, law.address, law.extra, x, y, spin, slip_speed, self.normal_force_n, self.patch, rail,
                self.shear_modulus_pa,
            )  # fmt: skip
            found.append(force[:2])
        return -np.array(found) / self.normal_force_n


def draw_creep_laws(laws: Mapping[str, LawInForce], sheet: CreepSheet) -> Figure:
    """Force over load, over creep: along the track, across it (with spin too), with friction that falls."""
    figure, panels = new_figure("Creep laws", 6.8, rows=2, columns=2)
    (along, falling), (across, speeds) = panels
    for name, colour in zip(laws, ESTIMATOR_COLOURS, strict=False):
        curve = sheet.adhesion(laws[name], _along, sheet.constant, sheet.speed_mps)
        along.semilogx(CREEPS, curve[:, 0], color=colour, label=name)
        curve = sheet.adhesion(laws[name], _along, sheet.falling, sheet.speed_mps)
        falling.semilogx(CREEPS, curve[:, 0], color=colour, label=name)
        curve = sheet.adhesion(laws[name], _across, sheet.constant, sheet.speed_mps)
        across.semilogx(CREEPS, curve[:, 1], color=colour, label=name)
        curve = sheet.adhesion(laws[name], _across_with_spin, sheet.constant, sheet.speed_mps)
        across.semilogx(CREEPS, curve[:, 1], "--", color=colour)
    for name, line in SEVERAL_SPEEDS.items():
        for speed_mps, colour in zip(SPEEDS_MPS, AXLE_COLOURS, strict=True):
            if name in laws:
                curve = sheet.adhesion(laws[name], _along, sheet.falling, speed_mps)
                speeds.semilogx(CREEPS, curve[:, 0], line, color=colour, label=f"{name}, {speed_mps:.0f} m/s")
    _mark(along, sheet.published, sheet.normal_force_n)
    _mark(falling, sheet.published_falling, sheet.normal_force_n)
    along.set_title("along the track, constant friction", fontsize=8)
    across.set_title(f"across the track, constant friction; dashed: with spin {SPIN_1PM:g}/m", fontsize=8)
    falling.set_title(f"along the track, falling friction, {sheet.speed_mps:.0f} m/s", fontsize=8)
    speeds.set_title("along the track, falling friction, several speeds", fontsize=8)
    for axes in figure.axes:
        axes.set_ylabel("force over load  -")
        legend(axes, place="upper left")
    for axes in panels[-1]:
        axes.set_xlabel("creep  -")
    return figure


def _along(creep: float) -> tuple[float, float, float]:
    return creep, 0.0, 0.0


def _across(creep: float) -> tuple[float, float, float]:
    return 0.0, creep, 0.0


def _across_with_spin(creep: float) -> tuple[float, float, float]:
    return 0.0, creep, SPIN_1PM


def _mark(axes: Axes, published: Mapping[str, Points], normal_force_n: float) -> None:
    for (name, points), marker in zip(published.items(), MARKERS, strict=False):
        adhesion = np.array(list(points.values())) / normal_force_n
        axes.plot(list(points), adhesion, marker, color=TRUE_COLOUR, fillstyle="none", markersize=5, label=name)
