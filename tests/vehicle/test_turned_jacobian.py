"""In a curve the Jacobian of a while ago is turned with the coach."""

import numpy as np
import pytest

from tests.vehicle.conftest import Bench, MakeBench
from vehicle.forces import coach_force
from vehicle.jacobian import coach_jacobian
from vehicle.layout import SPIN
from vehicle.start import start_state
from vehicle.stepping import turn_jacobian
from wheel_rail.compiled import address_of

RADIUS_M = 1000.0
CURVE = {"start_m": 100.0, "transition_m": 50.0, "length_m": 400.0, "radius_m": RADIUS_M, "cant_mm": 0.0}


def sliding_at(bench: Bench, s_m: float) -> tuple[np.ndarray, np.ndarray]:
    """The coach's record at a place of the arc, its wheels sliding, and its Jacobian."""
    record, q, v = start_state(bench.parameters, bench.contact, bench.track, bench.rail, s_m, 20.0)
    v[SPIN : SPIN + 4] *= 0.99
    coach_force(q, v, np.empty(len(q)), record, bench.track.table, bench.rail)
    jacobian = np.empty((len(q), len(q)))
    coach_jacobian(q, v, 2e-5, 6.6e-3, record, jacobian)
    return record, jacobian


@pytest.mark.parametrize("ahead_m", [0.5, 15.0])
def test_the_turned_jacobian_is_that_of_the_new_heading(make_bench: MakeBench, ahead_m: float) -> None:
    """On a level arc all places are alike but for the heading: up to 15 mrad of it."""
    bench = make_bench(curves=[CURVE])
    before, old = sliding_at(bench, 250.0)
    record, new = sliding_at(bench, 250.0 + ahead_m)
    coach = record[0]
    coach["old_heading"] = before[0]["old_heading"]
    columns = np.ascontiguousarray(old.T)
    coach["jacobian_columns_at"] = address_of(columns)
    correction = np.random.default_rng(1).normal(size=len(old))
    coach["correction"][: len(old)] = correction
    force = np.zeros(len(old))
    turn_jacobian(coach, force)
    expected = (old - new) @ correction
    print(np.abs(expected).max(), np.abs(force - expected).max())
    assert np.abs(expected).max() > 10.0 * ahead_m / 15.0
    assert force == pytest.approx(expected, abs=0.01 * np.abs(expected).max())
