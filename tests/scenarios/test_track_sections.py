"""Scenario files whose line comes from files, or has rough rails: the user's own files, refusals, the picture."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenarios.cosimulation.line import track_of
from scenarios.errors import BadInput
from scenarios.figures.line import draw_line
from scenarios.figures.style import figure_style, write_png
from scenarios.scenario_file import dump_scenario, load_scenario
from scenarios.truth import Truth
from sensors import BaliseReadings
from wheel_rail import Irregularities

CURVES = (
    "start_m,end_m,radius_m,transition_in_m,transition_out_m,transition_kind,cant_mm\n250,900,1200,100,80,bloss,100\n"
)
GRADIENTS = "from_m,gradient_permille,vertical_radius_m\n1200,-5,9000\n"
FILES = '[track]\ncurves = []\ngradients = []\ncurves_file = "curves.csv"\ngradients_file = "line/gradients.csv"\n'

Write = Callable[[str], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def written(text: str) -> Path:
        path = tmp_path / "my.toml"
        # cones: profiles take a while to be tabulated
        head = '[scenario]\nextends = "low-adhesion-stop"\n[coach.contact]\ngeometry = "conical"\n'
        path.write_text(head + text, encoding="utf-8")
        return path

    return written


def refusal(path: Path, *settings: str) -> str:
    with pytest.raises(BadInput) as caught:
        load_scenario(path, settings)
    return str(caught.value)


def test_a_line_from_files_beside_the_scenario_is_resolved(write: Write, tmp_path: Path) -> None:
    (tmp_path / "curves.csv").write_text(CURVES, encoding="utf-8")
    (tmp_path / "line").mkdir()
    (tmp_path / "line" / "gradients.csv").write_text(GRADIENTS, encoding="utf-8")
    scenario = load_scenario(write(FILES))
    (curve,), (change,) = scenario.track.curves, scenario.track.gradients
    assert (curve.start_m, curve.last_m, curve.exit_m, curve.transition_kind) == (250.0, 900.0, 80.0, "bloss")
    assert change.vertical_radius_m == 9000.0
    resolved = tmp_path / "resolved.toml"
    resolved.write_text(dump_scenario(scenario), encoding="utf-8")
    assert "curves_file" not in resolved.read_text(encoding="utf-8")
    assert load_scenario(resolved) == scenario.model_copy(update={"presets": {}})


def test_bad_line_files_are_told_with_scenario_key_file_and_line(write: Write, tmp_path: Path) -> None:
    (tmp_path / "curves.csv").write_text(CURVES.replace("1200", "79"), encoding="utf-8")
    (tmp_path / "line").mkdir()
    (tmp_path / "line" / "gradients.csv").write_text(GRADIENTS, encoding="utf-8")
    path = write(FILES)
    file = tmp_path / "curves.csv"
    told = f"{path}: track.curves_file = {file}, line 2: radius_m = 79.0: the tightest curve allowed is 80 m"
    assert told in refusal(path)


def test_curves_of_a_file_that_do_not_meet_are_told_with_scenario_file_and_key(write: Write, tmp_path: Path) -> None:
    file = tmp_path / "curves.csv"
    rows = "start_m,joins_previous,radius_m,transition_in_m,transition_out_m,length_m\n250,,900,80,,300\n"
    file.write_text(rows + "640,true,-600,90,90,200\n", encoding="utf-8")
    path = write('[track]\ncurves = []\ncurves_file = "curves.csv"\n')
    assert f"{path}: track.curves_file = {file}: curves.1.start_m = 640.0: a gap of 10 m" in refusal(path)
    file.write_text(rows + "630,true,-600,90,90,200\n", encoding="utf-8")
    assert [curve.joins_previous for curve in load_scenario(path).track.curves] == [False, True]


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("track.curves.0.radius_m=70", "track.curves.0.radius_m = 70.0: the tightest curve allowed is 80 m"),
        ("track.curves.0.cant_mm=230", "track.curves.0.cant_mm = 230.0: at most 200 mm"),
        ("track.curves.0.transition_m=15", "track.curves.0.cant_mm = 100.0: its ramp in, 15 m, is too steep"),
        ("track.curves.0.transition_kind='wiener'", "track.curves.0.transition_kind = \"wiener\": must be 'clothoid'"),
        ("track.curves.0.joins_previous=true", "track.curves.0.joins_previous = true: there is no curve before the"),
        ("track.curves.0.joins_previous='yes'", 'track.curves.0.joins_previous = "yes": must be a valid boolean'),
        ("track.gradients.0.gradient_permille=120", "track.gradients.0.gradient_permille = 120"),
        ("track.gradients.0.rounding_m=1", "track.gradients.0.rounding_m = 1: too short for a change of -5 per mille"),
        ("track.length_m=800", "track.curves: reach to 900.0 m, beyond length_m = 800"),
        ("track.irregularities.spectrum='erri'", "track.irregularities.spectrum = \"erri\": must be 'erri-b176-low'"),
        ("track.irregularities={spectrum='aar-6', shortest_wavelength_m=0.2}", "shortest_wavelength_m = 0.2: must be"),
        ("track.irregularities={spectrum='aar-6', to_m=9000.0}", "track.irregularities.to_m = 9000.0: beyond length_m"),
        ("track.irregularities.file='none.csv'", "track.irregularities.file = "),
    ],
)
def test_bad_tracks_are_refused_with_key_and_reason(write: Write, setting: str, message: str) -> None:
    assert message in refusal(write(""), setting)


def test_the_world_seed_draws_the_rails(write: Write) -> None:
    path = write('[track.irregularities]\nspectrum = "erri-b176-low"\n')
    rails = []
    for seeds in ("world_seed=1", "sensor_seed=9", "world_seed=2"):
        rough = track_of(load_scenario(path, [f"scenario.{seeds}"])).irregularities
        assert rough is not None
        rails.append(rough.values_m)
    assert np.array_equal(rails[0], rails[1])
    assert not np.array_equal(rails[0], rails[2])


def test_measured_rails_beside_the_scenario(write: Write, tmp_path: Path) -> None:
    places = np.arange(0.0, 6001.0, 0.5)
    rows = [f"{s:.2f},{2.0 * np.sin(s / 5.0):.6f}" for s in places]
    (tmp_path / "car.csv").write_text("\n".join(["position_m,longitudinal_level_mm", *rows]), encoding="utf-8")
    path = write('[track.irregularities]\nfile = "car.csv"\n')
    rough = track_of(load_scenario(path)).irregularities
    assert rough is not None
    assert rough.values_m[2000, 0] == pytest.approx(0.002 * np.sin(1000.0 / 5.0), abs=1e-8)
    (tmp_path / "car.csv").write_text("\n".join(["position_m,longitudinal_level_mm", *rows[:900]]), encoding="utf-8")
    assert f"{path}: track.irregularities.file = {tmp_path / 'car.csv'}: measured from 0 to" in refusal(path)


def test_the_line_is_drawn_with_its_irregularities(truth: Truth, tmp_path: Path) -> None:
    values = np.zeros((8000, 4))
    values[:, 0] = 1e-3 * np.sin(np.arange(8000) / 20.0)
    values[:, 3] = 5e-4
    balises: Any = BaliseReadings(t_s=[5.0], position_m=[150.0])
    with figure_style():
        smooth, rough = draw_line(truth, balises), draw_line(truth, balises, Irregularities(0.0, 0.25, values))
        write_png(rough, tmp_path / "line.png")
    assert len(rough.axes) == len(smooth.axes) + 2
    assert smooth.axes[-1].get_xlabel() == rough.axes[-1].get_xlabel() == "position  m"
    mean, difference = rough.axes[-2:]
    assert mean.get_legend_handles_labels()[1][:2] == ["longitudinal level", "alignment"]
    assert difference.get_legend_handles_labels()[1][:2] == ["cross level", "gauge"]
    level, _ = (line.get_ydata() for line in mean.get_lines()[:2])
    assert np.ptp(level) == pytest.approx(2.0, abs=0.01)  # mm
    inside = truth.motion.position_m
    places = np.asarray(mean.get_lines()[0].get_xdata())
    assert places.min() >= inside.min()
    assert places.max() <= inside.max()
