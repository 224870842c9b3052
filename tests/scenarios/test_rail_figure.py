"""The rail before and after the train: computed from the states of the rails, and drawn."""

from typing import Any

import numpy as np
import pytest

from scenarios.cosimulation.line import Line
from scenarios.figures.rail import draw_rail
from scenarios.figures.style import with_extremes
from scenarios.rail_adhesion import RailAdhesion, adhesion_along_rail
from scenarios.scenario_file import load_scenario
from scenarios.schema import Scenario
from scenarios.truth import Truth, rail_stream
from wheel_rail import RailState


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    stretches = 'adhesion.stretches=[{from_m=0.0,recovery="low-recovering",peak_adhesion=0.06}]'
    return load_scenario("low-adhesion-stop", [stretches, "track.length_m=2000.0"])


@pytest.fixture
def run(truth: Truth, changed: Any) -> Truth:
    """The stop from 300 m on, on a line of 2000 m, with a kilojoule per metre left on the right rail from 500 m on."""
    before, after = RailState(2000.0), RailState(2000.0)
    after.energy_jpm[1, 5000:] = 1000.0
    return changed(truth, rail_before=rail_stream(before.table), rail=rail_stream(after.table))


def test_the_rail_offers_its_peak_before_and_gains_where_energy_lies(scenario: Scenario, run: Truth) -> None:
    found = adhesion_along_rail(scenario, run)
    assert found.recovers
    assert found.before == pytest.approx(0.06, rel=1e-3)  # as the scenario's file gives it
    untouched = found.position_m < 499.0
    assert found.after[0] == pytest.approx(found.before[0], rel=1e-12)
    assert found.after[1, untouched] == pytest.approx(0.06, rel=1e-3)
    # tau 5e-4 m/J: 1 - exp(-0.5) of the way to the recovered curve, whose peak at this speed is 0.089; the peak of a
    # blend lies no higher than the blend of the peaks
    gained = found.after[1, found.position_m > 501.0]
    ceiling = 0.06 + (1.0 - np.exp(-0.5)) * (Line(scenario).adhesion.curves[0, 5] - 0.06)
    assert np.all(gained > 0.065)
    assert np.all(gained < ceiling)


def test_places_reach_from_the_brake_demand_to_the_stop_and_beyond(scenario: Scenario, run: Truth) -> None:
    found = adhesion_along_rail(scenario, run)
    assert 230.0 < found.position_m[0] < 300.0 - 9.0
    assert 900.0 + 9.0 < found.position_m[-1] < 970.0
    assert np.diff(found.position_m).max() <= 2.0


def test_panels_show_the_rails_their_energy_and_sand_if_there_is_any(
    scenario: Scenario, run: Truth, changed: Any
) -> None:
    adhesion = adhesion_along_rail(scenario, run)
    figure = draw_rail(run, adhesion)
    left, right, met, energy = figure.axes
    lines = {line.get_label(): line for line in right.get_lines()}
    assert lines["after it"].get_ydata().max() == pytest.approx(adhesion.after[1].max())
    assert [text.get_text() for text in left.texts] == ["left as it was found"]
    assert not right.texts
    assert {f"axle {k}" for k in range(1, 5)} <= set(met.get_legend_handles_labels()[1])
    assert energy.get_yscale() == "log"
    sanded = RailState(2000.0)
    sanded.sand_gpm[:] = 2.0
    figure = draw_rail(changed(run, rail=rail_stream(sanded.table)), adhesion)
    assert len(figure.axes) == 5
    assert figure.axes[-1].get_ylabel().endswith("g/m")


def test_a_rail_that_does_not_recover_says_so(run: Truth) -> None:
    peak = np.full((2, 400), 0.3)
    figure = draw_rail(run, RailAdhesion(np.linspace(250.0, 950.0, 400), peak, peak.copy(), recovers=False))
    assert "nothing here recovers" in figure.axes[0].texts[0].get_text()


def test_thinning_keeps_extremes_ends_and_gaps() -> None:
    values = np.sin(np.linspace(0.0, 50.0, 10_000))
    values[1234], values[5678] = 7.0, -9.0
    values[8000:] = np.nan
    rows = with_extremes(values, 100)
    assert len(rows) < 320
    assert rows[0] == 0
    assert rows[-1] == 9_999
    assert np.all(np.diff(rows) > 0)
    assert {1234, 5678} <= set(rows)
    assert np.isnan(values[rows[rows >= 8000]]).all()
    assert with_extremes(values[:150], 100).tolist() == list(range(150))
