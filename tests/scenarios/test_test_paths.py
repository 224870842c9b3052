"""The ten test paths: their files, and one of them run whole against its row of the published tables."""

from typing import Any

import numpy as np
import pytest

from scenarios.cosimulation.line import Line
from scenarios.scenario_file import load_scenario
from scenarios.verification import Case, Outcome
from scenarios.verification.paths import PUBLISHED, first_met_kmh, path_cases

RUN = 3
"""The shortest path, with curves and slopes."""


@pytest.mark.parametrize("case", path_cases((RUN,)), ids=lambda case: case.id)
def test_cell_of_the_tables(case: Case) -> None:
    outcome = Outcome(case, case.obtain())
    print(f"{case.quantity}: {outcome.obtained:.6g} {case.unit}, expected {case.expected}, error {outcome.error:+.3g}")
    assert outcome.result == "pass"


@pytest.mark.parametrize("number", PUBLISHED)
def test_file_has_the_character_of_its_row(number: int) -> None:
    scenario = load_scenario(f"path-{number:02d}", ())
    track, stretches = scenario.track, scenario.adhesion.stretches
    slopes = {abs(change.gradient_permille) for change in track.gradients} - {0.0}
    radii = {abs(curve.radius_m) for curve in track.curves}
    curved, sloping = number in (2, 3, 4, 5, 6, 10), number != 2
    assert radii == ({1800.0, 10_000.0} if number == 10 else {1800.0} if curved else set())
    expected = {4: {10.0, 20.0, 30.0}, 5: {10.0, 20.0, 30.0}, 8: {10.0, 30.0}, 6: {20.0}}
    assert slopes == (expected.get(number, {30.0}) if sloping else set())
    if number in (7, 8, 9):
        assert track.gradients[0].gradient_permille == (10.0 if number == 8 else 30.0)
    if number == 10:
        assert track.curves[0].radius_m == 10_000.0
    peaks = [stretch.peak_adhesion for stretch in stretches]
    assert set(peaks) == {0.1, 0.3}
    assert len(peaks) == 8
    assert scenario.wsp.controller == "rule-table"
    assert scenario.traction.anti_skid
    assert scenario.simulation.step_s == 0.005
    # as long as the published path, and room to stop
    assert 0.0 < track.length_m - 1000.0 * PUBLISHED[number][0] < 1000.0


def test_curves_of_path_5_are_taken_at_balance_speed() -> None:
    """The cant that makes the lateral acceleration zero at the speed that the driver holds there."""
    scenario = load_scenario("path-05", ())
    line = Line(scenario)
    holds = [(phase.from_m, phase.speed_kmh) for phase in scenario.driver.phases if phase.action == "hold"]
    speeds = {speed for _, speed in holds}
    for curve in scenario.track.curves:
        middle = np.array([curve.start_m + curve.transition_m + 0.5 * curve.length_m])
        cant = np.arcsin(line.track.cant_mm(middle)[0] / 1500.0)
        balance_kmh = 3.6 * np.sqrt(9.80665 * np.tan(cant) / line.track.curvature_radpm(middle)[0])
        assert min(abs(balance_kmh - speed) for speed in speeds) < 1.0


def test_where_the_first_slope_begins_and_the_first_curve_ends(make_truth: Any, changed: Any) -> None:
    """At 40 m/s less 1 m/s2 from 0 s on: slope from 5 s, curves from 8 to 12 s and from 20 s."""
    motion = make_truth(initial_speed_mps=40.0, deceleration_mps2=1.0, brake_at_s=0.0).motion
    t_s, zero = motion.t_s, np.zeros(len(motion))
    assert first_met_kmh(changed(motion, gradient_permille=zero, curvature_radpm=zero)) == (-np.inf, -np.inf)
    curvature = np.where(((t_s > 8.0) & (t_s < 12.0)) | (t_s > 20.0), 1e-3, 0.0)
    met = first_met_kmh(changed(motion, gradient_permille=np.where(t_s > 5.0, 10.0, 0.0), curvature_radpm=curvature))
    assert met == pytest.approx((3.6 * 35.0, 3.6 * 28.0), abs=0.05)
