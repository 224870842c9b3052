"""The figures of a scenario's contact against closed forms, and the command as a user meets it."""

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from scenarios.cli import app
from scenarios.contact_sheet import contact_sheet
from scenarios.cosimulation.line import Line
from scenarios.figures.contact_geometry import draw_tabulated_geometry
from scenarios.scenario_file import load_scenario

BUILT_IN = "low-adhesion-stop"
CONICAL = "coach.contact.geometry=conical"


def invoke(*arguments: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, list(arguments))
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.stdout, result.stderr


def test_cones_have_their_conicity_at_any_amplitude_and_hertz_pressure() -> None:
    scenario = load_scenario(BUILT_IN, [CONICAL, "coach.contact.conical.conicity=0.1"])
    centred = contact_sheet(scenario, Line(scenario)).centred
    assert centred.conicity == pytest.approx([0.1] * 6, rel=1e-6)
    assert math.tan(centred.angle_rad) == pytest.approx(0.1)
    assert centred.spin_1pm == pytest.approx(math.sin(math.atan(0.1)) / 0.46)
    assert centred.flange_play_m == pytest.approx(0.007)
    # Hertz: the load is two thirds of the peak pressure over the ellipse
    area_m2 = math.pi * centred.semi_axis_a_m * centred.semi_axis_b_m
    assert 2.0 / 3.0 * centred.pressure_pa * area_m2 == pytest.approx(centred.load_n)
    # softer than the track alone
    assert 0.8 * 1.1e8 < centred.stiffness_npm < 1.1e8


def test_cylinders_do_not_steer() -> None:
    scenario = load_scenario(BUILT_IN, [CONICAL, "coach.contact.conical.conicity=0.0"])
    line = Line(scenario)
    assert contact_sheet(scenario, line).centred.conicity == (None,) * 6
    draw_tabulated_geometry(line.contact, "cylinders")


def test_the_standards_pair_has_its_conicities() -> None:
    """EN 15302, case E1: wheel A on rail A at a gauge of 1435.16 mm, as published."""
    pair = (
        'coach.contact.profiles={wheel_profile="en15302-a",rail_profile="en15302-a",rail_inclination=0.0,'
        "gauge_m=1.43516,back_to_back_m=1.36}"
    )
    scenario = load_scenario(BUILT_IN, [pair])
    found = contact_sheet(scenario, Line(scenario)).centred.conicity
    assert found == pytest.approx([0.125, 0.155, 0.188, 0.216, 0.254, 0.303], abs=0.005)


def test_rails_have_the_peaks_of_the_scenario() -> None:
    scenario = load_scenario(BUILT_IN)
    dry, low = contact_sheet(scenario, Line(scenario)).rails
    assert (dry.name, dry.from_m, dry.recovered) == ("dry", 0.0, None)
    assert (dry.peak_low, dry.peak_high) == pytest.approx((0.3, 0.3))
    assert low.from_m == 1300.0
    assert 0.06 <= low.peak_low < low.peak_high <= 0.08
    assert low.recovered is not None
    assert low.recovered[0] == pytest.approx(0.0941)
    assert low.peak_high < low.recovered[0]


def test_the_command_shows_tables_and_leaves_a_whole_folder(tmp_path: Path) -> None:
    out = str(tmp_path / "runs")
    for law in ("polach", "fastsim"):  # the second one replaces the first
        code, output, _ = invoke("contact", BUILT_IN, "--out", out, "--set", f"creep_law.name={law}")
        assert code == 0
        assert "equivalent conicity" in output
        assert law in output
    (folder,) = (tmp_path / "runs").iterdir()
    assert folder.name == f"{BUILT_IN}.contact"
    assert sorted(os.listdir(folder)) == ["contact-geometry.png", "contact.json", "creep-laws.png", "scenario.toml"]
    for picture in folder.glob("*.png"):
        assert picture.read_bytes().startswith(b"\x89PNG")
    tree = json.loads((folder / "contact.json").read_text())
    assert tree["creep_law"]["name"] == "fastsim"
    assert np.isfinite(tree["centred"]["conicity"]).all()


def test_what_is_not_a_contact_folder_is_left_alone(tmp_path: Path) -> None:
    place = tmp_path / f"{BUILT_IN}.contact"
    place.mkdir()
    (place / "diary.txt").write_text("mine")
    code, output, errors = invoke("contact", BUILT_IN, "--out", str(tmp_path))
    assert code == 2
    assert output == ""
    assert len(errors.splitlines()) == 1
    assert "diary.txt" in errors
    assert os.listdir(place) == ["diary.txt"]


def test_a_bad_profile_is_one_message(tmp_path: Path) -> None:
    setting = "coach.contact.profiles.wheel_profile=s1003"
    code, output, errors = invoke("contact", BUILT_IN, "--out", str(tmp_path), "--set", setting)
    assert code == 2
    assert output == ""
    assert len(errors.splitlines()) == 1
    assert "s1003" in errors
    assert os.listdir(tmp_path) == []
