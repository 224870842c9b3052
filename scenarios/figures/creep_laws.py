"""Creep-force curves of all creep laws on one sheet."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.contact_sheet import ContactSheet
from scenarios.figures.style import AXLE_COLOURS, ESTIMATOR_COLOURS, TRUE_COLOUR, legend, new_figure
from scenarios.units import KMH_PER_MPS
from wheel_rail import Contact
from wheel_rail.creep_laws import LawInForce, creep_force

CREEPS = np.geomspace(1e-5, 0.4, 160)
SPIN_1PM = 0.2  # of a wheel whose contact stands at a slope of about 1:10
SPEEDS_MPS = (5.0, 10.0, 30.0, 50.0)
SEVERAL_SPEEDS = {"polach": "-", "modified-fastsim": "--"}
MARKERS = "ox^s"
MOST_RAILS = 4

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


def draw_laws_on_rails(laws: Mapping[str, LawInForce], in_force: str, contact: Contact, sheet: ContactSheet) -> Figure:
    """A scenario's rails from top to bottom: force over load of all `laws`, along the track and across it.

    The friction curves are the scenario's, found with the law `in_force`: any other law peaks elsewhere on them.
    Across: with the spin of a centred wheel that rolls, which pushes even without creep. Dotted: the law in force on
    rail that has recovered.
    """
    centred, rails = sheet.centred, sheet.rails[:MOST_RAILS]
    figure, panels = new_figure(
        f"Creep laws at {1e-3 * centred.load_n:.1f} kN a wheel and {KMH_PER_MPS * sheet.speed_mps:.0f} km/h",
        1.6 + 2.4 * len(rails), rows=len(rails), columns=2, squeeze=False,
    )  # fmt: skip
    for (along, across), rail in zip(panels, rails, strict=True):
        degraded = np.array(rail.degraded)
        one = CreepSheet(
            centred.load_n, contact.patch, contact.parameters.shear_modulus_pa, sheet.speed_mps, degraded, degraded,
            {}, {},
        )  # fmt: skip
        spinning = partial(_across_spinning, centred.spin_1pm)
        for name, colour in zip(laws, _colours(len(laws)), strict=True):
            ours = name == in_force
            look: dict[str, Any] = {"color": colour, "linewidth": 2.2 if ours else 1.0, "zorder": 3.0 if ours else 2.0}
            label = f"{name} (in force)" if ours else name
            for axes, creep_of, component in ((along, _along, 0), (across, spinning, 1)):
                curve = one.adhesion(laws[name], creep_of, degraded, sheet.speed_mps)
                axes.semilogx(CREEPS, curve[:, component], label=label, **look)
                if ours and rail.recovered is not None:
                    curve = one.adhesion(laws[name], creep_of, np.array(rail.recovered), sheet.speed_mps)
                    axes.semilogx(CREEPS, curve[:, component], ":", color=colour, label=f"{name}, rail recovered")
        for axes, heading in ((along, "along"), (across, f"across, spin {centred.spin_1pm:.3f}/m")):
            axes.set_ylabel("force over load  -")
            axes.set_title(f"{heading}: from {rail.from_m:g} m, {rail.name}", fontsize=8, pad=2.0)
    legend(max(panels[:, 0], key=lambda axes: len(axes.get_lines())), place="upper left")
    for axes, of in zip(panels[-1], ("longitudinal", "lateral"), strict=True):
        axes.set_xlabel(f"{of} creep  -")
    return figure


def _colours(count: int) -> list[str]:
    return [ESTIMATOR_COLOURS[k % len(ESTIMATOR_COLOURS)] for k in range(count)]


def _across_spinning(spin_1pm: float, creep: float) -> tuple[float, float, float]:
    return 0.0, creep, spin_1pm


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
