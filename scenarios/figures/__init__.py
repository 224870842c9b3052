"""The pictures of a run. matplotlib is imported by this package alone, so import it late."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from estimators.interface import EstimateStream
from scenarios.figures.axle_speeds import draw_axle_speeds
from scenarios.figures.estimates import draw_estimates
from scenarios.figures.imu import draw_imu
from scenarios.figures.line import draw_line
from scenarios.figures.rail import draw_rail
from scenarios.figures.slip_adhesion import draw_slip_and_adhesion
from scenarios.figures.style import figure_style, write_png
from scenarios.metrics import EstimatorErrors
from scenarios.rail_adhesion import RailAdhesion
from scenarios.truth import Truth
from sensors import BaliseReadings, ImuParameters, ImuReadings
from wheel_rail import Irregularities

__all__ = ["write_figures"]


def write_figures(
    folder: Path,
    truth: Truth,
    imu: ImuReadings,
    mounting: ImuParameters,
    balises: BaliseReadings,
    estimates: Mapping[str, EstimateStream],
    errors: Mapping[str, EstimatorErrors],
    rail: RailAdhesion,
    irregularities: Irregularities | None = None,
) -> list[str]:
    """Draw the run into `folder` as PNG files and return their names, in the order in which one looks at them."""
    drawings: dict[str, Callable[[], Figure]] = {
        "axle-speeds.png": partial(draw_axle_speeds, truth),
        "slip-and-adhesion.png": partial(draw_slip_and_adhesion, truth),
        "estimates.png": partial(draw_estimates, truth.motion, balises, estimates, errors),
        "imu.png": partial(draw_imu, truth.motion, imu, mounting),
        "line.png": partial(draw_line, truth, balises, irregularities),
        "rail.png": partial(draw_rail, truth, rail),
    }
    folder.mkdir(exist_ok=True)
    for name, draw in drawings.items():
        with figure_style():
            write_png(draw(), folder / name)
    return list(drawings)
