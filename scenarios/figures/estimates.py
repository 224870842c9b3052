"""What the estimators made of it: speed, its error and the distance's error in the ETCS band, gradient."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from estimators.interface import EstimateStream
from scenarios.figures.style import BAND_COLOUR, ESTIMATOR_COLOURS, TRUE_COLOUR, legend, new_figure, plot
from scenarios.metrics import EstimatorErrors
from scenarios.names import display_name
from scenarios.truth import MotionStream
from scenarios.units import KMH_PER_MPS
from sensors.readings import BaliseReadings


def draw_estimates(
    motion: MotionStream,
    balises: BaliseReadings,
    estimates: Mapping[str, EstimateStream],
    errors: Mapping[str, EstimatorErrors],
) -> Figure:
    """Every estimator in the panels of the quantities that it has; balises as dotted lines."""
    figure, (speed, speed_error, distance_error, gradient) = new_figure(
        "Estimates and their errors", 9.6, rows=4, height_ratios=[1.3, 1.0, 1.0, 1.0]
    )
    plot(speed, motion.t_s, KMH_PER_MPS * motion.speed_mps, color=TRUE_COLOUR, label="true", linewidth=1.6)
    plot(gradient, motion.t_s, motion.gradient_permille, color=TRUE_COLOUR, label="true", linewidth=1.6)
    for any_errors in list(errors.values())[:1]:  # the band follows the truth and is the same for all
        _band(speed_error, any_errors.t_s, any_errors.speed_limit_kmh)
        _band(distance_error, any_errors.t_s, any_errors.distance_limit_m)
    for k, (name, estimate) in enumerate(estimates.items()):
        colour = ESTIMATOR_COLOURS[k % len(ESTIMATOR_COLOURS)]
        label = display_name(name)
        error = errors[name]
        for axes, t_s, values in (
            (speed, estimate.t_s, KMH_PER_MPS * estimate.speed_mps),
            (speed_error, error.t_s, error.speed_kmh),
            (distance_error, error.t_s, error.distance_m),
            (gradient, estimate.t_s, estimate.gradient_permille),
        ):
            if np.isfinite(values).any():
                plot(axes, t_s, values, color=colour, label=label)
    for axes in (speed_error, distance_error):
        axes.axhline(0.0, color=TRUE_COLOUR, linewidth=0.6)
        for t_s in balises.t_s:
            axes.axvline(t_s, color="grey", linestyle=":", linewidth=0.9)
    speed.set_ylabel("speed  km/h")
    speed_error.set_ylabel("speed error  km/h")
    distance_error.set_ylabel("distance error  m")
    gradient.set_ylabel("gradient  per mille")
    gradient.set_xlabel("time  s   (dotted: a balise is read)")
    legend(speed, columns=4, place="lower left")
    legend(speed_error, columns=4, place="upper right")
    legend(gradient, columns=4, place="upper right")
    return figure


def _band(axes: Axes, t_s: NDArray[np.float64], limit: NDArray[np.float64]) -> None:
    axes.fill_between(t_s, -limit, limit, color=BAND_COLOUR, linewidth=0.0, label="ETCS limit")
