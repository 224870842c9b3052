"""Figures of runs of every kind: drawn, labelled, with units, and of readable size."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from estimators.interface import EstimateStream
from scenarios.figures import write_figures
from scenarios.figures.axle_speeds import draw_axle_speeds
from scenarios.figures.estimates import draw_estimates
from scenarios.figures.imu import draw_imu
from scenarios.figures.line import draw_line
from scenarios.figures.slip_adhesion import draw_slip_and_adhesion
from scenarios.metrics import estimator_errors
from scenarios.rail_adhesion import RailAdhesion
from scenarios.scenario_file import load_scenario
from scenarios.truth import Truth
from sensors import BaliseReadings, ImuParameters, ImuReadings

UNITS = re.compile(r"(km/h|bar|%|  -|  m|m/s²|rad/s|per mille|1/km|  mm)$")
BALISES = BaliseReadings(t_s=[5.0], position_m=[150.0])


@pytest.fixture(scope="module")
def mounting() -> ImuParameters:
    return load_scenario("low-adhesion-stop").imu


def readings(truth: Truth) -> ImuReadings:
    rows = slice(None, None, 2)
    motion = truth.motion
    return ImuReadings(
        t_s=motion.t_s[rows],
        specific_force_mps2=motion.specific_force_mps2[rows] + 0.1,
        angular_rate_radps=motion.angular_rate_radps[rows],
        temperature_degc=np.full(len(motion.t_s[rows]), 20.0),
    )


def estimates(truth: Truth, stream_of: Any) -> dict[str, EstimateStream]:
    t_s = np.arange(0.0, truth.motion.t_s[-1], 0.1)
    speed = np.interp(t_s, truth.motion.t_s, truth.motion.speed_mps)
    known = stream_of(EstimateStream, len(t_s), t_s=t_s, speed_mps=speed, position_m=np.nan, gradient_permille=np.nan)
    silent = stream_of(EstimateStream, len(t_s), t_s=t_s, speed_mps=np.nan, position_m=np.nan, gradient_permille=0.0)
    return {"scmt": known, "path/to/file.py:Mine": silent}


def drawn(truth: Truth, stream_of: Any, mounting: ImuParameters) -> list[Figure]:
    answers = estimates(truth, stream_of)
    errors = {name: estimator_errors(truth.motion, BALISES, answer) for name, answer in answers.items()}
    return [
        draw_axle_speeds(truth),
        draw_slip_and_adhesion(truth),
        draw_estimates(truth.motion, BALISES, answers, errors),
        draw_imu(truth.motion, readings(truth), mounting),
        draw_line(truth, BALISES),
    ]


def test_every_panel_has_a_unit_and_every_lowest_one_a_label(truth: Truth, stream_of: Any, mounting: Any) -> None:
    for figure in drawn(truth, stream_of, mounting):
        assert figure.get_suptitle()
        for axes in [panel for panel in figure.axes if panel.get_yticklabels()[0].get_text() != "axle 1"]:
            assert UNITS.search(axes.get_ylabel()), axes.get_ylabel()
        lowest = min(axes.get_position().y0 for axes in figure.axes)
        bottom = [axes for axes in figure.axes if axes.get_position().y0 == pytest.approx(lowest)]
        assert any(re.match(r"(time  s|position  m)", axes.get_xlabel()) for axes in bottom)


def labels(axes: Axes) -> set[str]:
    return set(axes.get_legend_handles_labels()[1])


def test_axle_speeds_carry_reference_and_truth_over_four_axles(truth: Truth) -> None:
    speeds, pressures, valves = draw_axle_speeds(truth).axes
    assert {"reference speed", "true speed", *(f"axle {k}, tachometer" for k in range(1, 5))} <= labels(speeds)
    assert {"distributor", "axle 1"} <= labels(pressures)
    assert [tick.get_text() for tick in valves.get_yticklabels()] == ["axle 1", "axle 2", "axle 3", "axle 4"]
    by_label = {line.get_label(): line for line in speeds.get_lines()}
    assert by_label["true speed"].get_ydata()[0] == pytest.approx(3.6 * truth.motion.speed_mps[0])


def test_valve_bars_last_as_long_as_the_valves_were_held(make_truth: Any, changed: Any) -> None:
    truth = make_truth()
    valve = np.zeros((len(truth.brake), 4), np.int8)
    valve[(truth.brake.t_s >= 20.0) & (truth.brake.t_s < 21.5), 2] = 2
    figure = draw_axle_speeds(changed(truth, brake=changed(truth.brake, valve=valve)))
    (bars,) = figure.axes[2].collections
    (corners,) = [path.get_extents() for path in bars.get_paths()]
    assert (corners.x0, corners.x1) == pytest.approx((20.0, 21.5), abs=1e-6)
    assert (corners.y0 + corners.y1) / 2 == pytest.approx(2.0)  # axle 3 stands at 2


def test_a_locked_axle_is_shaded(make_truth: Any) -> None:
    assert "an axle is locked" in labels(draw_axle_speeds(make_truth(slip=[1.0, 0.0, 0.0, 0.0])).axes[0])
    assert "an axle is locked" not in labels(draw_axle_speeds(make_truth(slip=0.1)).axes[0])


def test_estimates_show_each_estimator_where_it_has_an_answer(truth: Truth, stream_of: Any, mounting: Any) -> None:
    speed, speed_error, distance_error, gradient = drawn(truth, stream_of, mounting)[2].axes
    assert labels(speed) == {"true", "scmt"}
    assert labels(speed_error) == {"ETCS limit", "scmt"}
    assert labels(distance_error) == {"ETCS limit"}
    assert labels(gradient) == {"true", "Mine"}


def test_runs_without_stop_reference_or_estimators_can_be_drawn(
    make_truth: Any, changed: Any, tmp_path: Path, mounting: ImuParameters
) -> None:
    whole = make_truth()
    rows = slice(0, 1500)
    brake = changed(whole.brake.rows(rows), reference_speed_mps=np.full(1500, np.nan), demand=np.zeros(1500))
    truth = changed(whole, motion=whole.motion.rows(rows), wheelsets=whole.wheelsets.rows(rows), brake=brake)
    rail = RailAdhesion(np.linspace(0.0, 300.0, 50), np.full((2, 50), 0.3), np.full((2, 50), 0.3), recovers=False)
    nowhere = BaliseReadings(t_s=[], position_m=[])
    names = write_figures(tmp_path, truth, readings(truth), mounting, nowhere, {}, {}, rail)
    for name in names:
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


def test_line_shades_where_the_rail_is_slippery(make_truth: Any, changed: Any) -> None:
    truth = make_truth()
    place = truth.wheelsets.position_m[:, :1]
    slippery = ((place > 100.0) & (place < 250.0)) | (place > 400.0)
    peaks = np.where(slippery, 0.1, 0.3) * np.ones(4)
    figure = draw_line(changed(truth, wheelsets=changed(truth.wheelsets, peak_adhesion=peaks)), BALISES)
    for axes in figure.axes:
        (bars,) = axes.collections
        first, second = (path.get_extents() for path in bars.get_paths())
        assert (first.x0, first.x1) == pytest.approx((100.0, 250.0), abs=0.5)
        assert (second.x0, second.x1) == pytest.approx((400.0, place[-1, 0]), abs=0.5)
    assert "peak adhesion below 0.2" in labels(figure.axes[0])
    dry = draw_line(changed(truth, wheelsets=changed(truth.wheelsets, peak_adhesion=0.0 * peaks + 0.3)), BALISES)
    assert "peak adhesion below 0.2" not in labels(dry.axes[0])
