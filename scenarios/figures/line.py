"""The line as the coach met it: speed, adhesion, gradient, curvature and cant over position."""

from matplotlib.figure import Figure

from scenarios.figures.style import AXLE_COLOURS, TRUE_COLOUR, legend, new_figure, thinned
from scenarios.metrics import KMH, stop_span
from scenarios.truth import Truth
from sensors.readings import BaliseReadings


def draw_line(truth: Truth, balises: BaliseReadings) -> Figure:
    """Marked: where the brake was demanded, where the coach stopped, where balises were read."""
    motion, wheelsets = truth.motion, truth.wheelsets
    figure, (speed, adhesion, gradient, curve) = new_figure("The line and the run over it", 7.6, rows=4, right_in=0.7)
    shown = thinned(len(motion))
    position_m = motion.position_m[shown]
    speed.plot(position_m, KMH * motion.speed_mps[shown], color=TRUE_COLOUR)
    speed.set_ylabel("speed  km/h")
    adhesion.plot(wheelsets.position_m[shown, 0], wheelsets.peak_adhesion[shown, 0], color=AXLE_COLOURS[0])
    adhesion.set_ylabel("peak adhesion, axle 1  -")
    adhesion.set_ylim(bottom=0.0)
    gradient.plot(position_m, motion.gradient_permille[shown], color=TRUE_COLOUR)
    gradient.set_ylabel("gradient  per mille")
    curve.plot(
        position_m, 1000.0 * motion.curvature_radpm[shown], color=TRUE_COLOUR, label="curvature, positive to the left"
    )
    curve.set_ylabel("curvature  1/km")
    cant = curve.twinx()
    cant.plot(position_m, motion.cant_mm[shown], color=AXLE_COLOURS[2], linestyle="--", label="cant, right axis")
    cant.set_ylabel("cant  mm")
    cant.grid(visible=False)
    cant.spines["right"].set_visible(True)
    lines = [*curve.get_lines(), *cant.get_lines()]
    curve.legend(handles=lines, loc="upper right")
    curve.set_xlabel("position  m")
    span = stop_span(truth)
    for axes in (speed, adhesion, gradient, curve):
        if span is not None:
            axes.axvline(motion.position_m[span[0]], color="#d62728", linewidth=0.9, label="brake demanded")
            axes.axvline(motion.position_m[span[1]], color="#d62728", linewidth=0.9, linestyle="--", label="stopped")
        for k, told_m in enumerate(balises.position_m):
            axes.axvline(told_m, color="grey", linestyle=":", linewidth=0.9, label="balise" if k == 0 else None)
    legend(speed, place="lower left")
    return figure
