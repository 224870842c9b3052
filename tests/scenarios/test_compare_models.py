"""`railslide compare-models`: the coach and the reduced model side by side."""

import pytest
from typer.testing import CliRunner

from scenarios.cli import app
from scenarios.compare_models import compare_models
from scenarios.scenario_file import load_scenario

SHORT = (
    "track.curves=[]",
    "track.gradients=[{from_m=200.0, gradient_permille=4.0, rounding_m=100.0}]",
    'adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]',
    'driver.phases=[{from_m=0.0, action="hold", speed_kmh=75.0, acceleration_mps2=0.4}, '
    '{from_m=300.0, action="coast"}, {from_m=450.0, action="brake", demand=1.0, until_kmh=45.0}, '
    '{from_m=640.0, action="brake", demand=0.7}]',
    "simulation.initial_speed_kmh=60",
    "brake.release_time_s=5",
)


def test_both_drive_the_same_profile() -> None:
    """Acceleration, coasting uphill, braking to a speed, stop on dry rail: within 1 km/h at every place on the way."""
    comparison = compare_models(load_scenario("low-adhesion-stop", SHORT), "point-mass", lambda *_: None, lambda: False)
    ways = [run.position_m[-1] - run.position_m[0] for run in (comparison.coach, comparison.point_mass)]
    assert ways[1] == pytest.approx(ways[0], rel=0.01)
    assert comparison.point_mass.t_s[-1] == pytest.approx(comparison.coach.t_s[-1], rel=0.01)
    on_the_way = comparison.difference.position_m < comparison.coach.position_m[-1] - 20.0
    assert abs(comparison.difference.speed_kmh[on_the_way]).max() < 1.0


def test_command_shows_both_and_knows_its_models() -> None:
    settings = [part for setting in SHORT for part in ("--set", setting)]
    result = CliRunner().invoke(app, ["compare-models", "low-adhesion-stop", *settings])
    assert result.exit_code == 0
    assert "speed at the same place, rms of the difference" in result.stdout
    refused = CliRunner().invoke(app, ["compare-models", "low-adhesion-stop", "--model", "point"])
    assert refused.exit_code == 2
    assert "point-mass-as-printed" in refused.stderr
