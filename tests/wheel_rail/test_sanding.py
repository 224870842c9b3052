"""Sanding: flow after its delay, sand where the nozzle was, friction that rises with it, wheels that crush it."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from tests.wheel_rail.rail_kinds import adhesion, condition_at, fresh, parameters, peak
from wheel_rail.adhesion_state import SAND_KEPT, STATE_CELL_M, RailState, crush_sand
from wheel_rail.recovery import ENERGY, SAND
from wheel_rail.sanding import FLOW, SandEffect, SanderParameters, Sanders, SandingParameters, lay_sand

LOW = {"surface": "low", "peak_adhesion": 0.05}
EFFECT = SandEffect(sanded_adhesion=0.15, effective_gpm=3.0, left_share=0.5)


def sanded_peak(stretch: dict[str, object], sand_gpm: float) -> float:
    rail = fresh(parameters(stretch), 100.0, EFFECT)
    rail.state[:, :, SAND_KEPT] = sand_gpm
    return peak(condition_at(rail, 50.0))


def test_sand_raises_the_peak_and_saturates() -> None:
    grams = np.array([0.0, 0.5, 1.0, 3.0, 10.0, 1000.0])
    peaks = np.array([sanded_peak(LOW, g) for g in grams])
    assert peaks[0] == pytest.approx(0.05, rel=1e-6)
    assert peaks[-1] == pytest.approx(0.15, rel=1e-6)
    assert np.all(np.diff(peaks) > 0.0)
    # peak over mu0 hardly depends on mu0
    assert peaks == pytest.approx(0.05 + 0.10 * (1.0 - np.exp(-grams / 3.0)), rel=0.02)


def test_sand_does_not_spoil_good_rail() -> None:
    assert sanded_peak({"surface": "dry", "peak_adhesion": 0.3}, 1000.0) == pytest.approx(0.3, rel=1e-6)


def test_sand_acts_on_the_recovered_curve_as_well() -> None:
    rail = fresh(parameters({"recovery": "low-recovering", "peak_adhesion": 0.07}), 100.0, EFFECT)
    rail.state[:, :, SAND_KEPT] = 1000.0
    found = condition_at(rail, 50.0)
    for energy_jpm in (0.0, 1e9):
        found[ENERGY] = energy_jpm
        assert peak(found) == pytest.approx(0.15, rel=1e-6)


@given(st.integers(0, 3), st.floats(0.0, 90.0), st.floats(0.0, 5.0), st.floats(0.01, 100.0))
def test_all_sand_lies_on_the_rails(wheelset: int, s0: float, way: float, flow_gps: float) -> None:
    """What a sander lays in half a second, on either rail."""
    state = RailState(100.0)
    before, after = np.full(4, s0), np.full(4, s0 + way)
    lay_sand(ADHESION.tables(state), np.array([[float(wheelset), 2.0, flow_gps]]), before, after, 0.5)
    assert state.sand_gpm.sum(axis=1) * STATE_CELL_M == pytest.approx(np.full(2, 0.5 * flow_gps), rel=1e-9)
    assert np.all(state.energy_jpm == 0.0)


ADHESION = adhesion(parameters(LOW), 100.0, sand=EFFECT)
lay_sand(
    ADHESION.tables(RailState(100.0)), np.zeros((1, 3)), np.zeros(4), np.ones(4), 0.5
)  # compiled before hypothesis looks at the time


@pytest.mark.parametrize(("s0", "s1"), [(10.05, 30.05), (30.05, 10.05)])
def test_a_wheel_crushes_the_sand_that_it_passes_once(s0: float, s1: float) -> None:
    """In any number of steps, and whichever way it rolls."""
    for steps in (1, 333):
        state = RailState(100.0)
        state.sand_gpm[:] = 4.0
        rail = ADHESION.tables(state)
        way = np.linspace(s0, s1, steps + 1)
        for one, other in pairwise(way):
            crush_sand(rail, 0, one, other)
        assert np.all(state.sand_gpm[1] == 4.0)
        assert (state.sand_gpm[0] == 2.0).sum() == 200
        assert (state.sand_gpm[0] == 4.0).sum() == state.sand_gpm.shape[1] - 200
        # the cell in which it still stands is not passed
        assert state.sand_gpm[0, int(s1 / STATE_CELL_M)] == 4.0


def sanding(**sander: float) -> SandingParameters:
    return SandingParameters.model_validate({"sanders": [{"wheelset": 2, **sander}]})


def test_sand_flows_after_its_delay_and_stops_after_it() -> None:
    sanders = Sanders(sanding(delay_s=0.3, rate_gps=20.0), 0.01)
    flow = []
    for k in range(200):
        sanders.step(np.array([False, 20 <= k < 80, False, False]))
        flow.append(sanders.rows[0, FLOW])
    assert np.flatnonzero(flow).tolist() == list(range(50, 110))
    assert max(flow) == 20.0


def test_another_wheelsets_command_is_not_obeyed() -> None:
    sanders = Sanders(sanding(delay_s=0.0), 0.01)
    sanders.step([True, False, True, True])
    assert sanders.rows[0, FLOW] == 0.0
    sanders.step([False, True, False, False])
    assert sanders.rows[0, FLOW] == 30.0


def test_sanders_of_different_delays() -> None:
    parameters_ = SandingParameters.model_validate(
        {"sanders": [{"wheelset": 1, "delay_s": 0.1}, {"wheelset": 3, "delay_s": 0.4, "rate_gps": 10.0}]}
    )
    sanders = Sanders(parameters_, 0.1)
    flows = []
    for _ in range(6):
        sanders.step([True] * 4)
        flows.append(sanders.rows[:, FLOW].copy())
    assert np.array(flows).T.tolist() == [[0, 30, 30, 30, 30, 30], [0, 0, 0, 0, 10, 10]]


def test_no_sanders_no_sand() -> None:
    sanders = Sanders(SandingParameters(), 0.01)
    sanders.step([True] * 4)
    state = RailState(100.0)
    lay_sand(ADHESION.tables(state), sanders.rows, np.zeros(4), np.ones(4), 0.01)
    assert state.table.sum() == 0.0


def test_sand_lies_behind_its_wheelset_at_rate_over_speed() -> None:
    state = RailState(100.0)
    rail = ADHESION.tables(state)
    sanders = Sanders(sanding(delay_s=0.0, rate_gps=30.0, offset_m=-0.6), 0.01)
    sanders.step([False, True, False, False])
    s, speed_mps = np.array([60.0, 50.0, 40.0, 30.0]), 10.0
    while s[1] < 80.0 - 1e-9:
        lay_sand(rail, sanders.rows, s, s + speed_mps * 0.01, 0.01)
        s += speed_mps * 0.01
    position_m = state.as_arrays()["position_m"]
    laid = state.sand_gpm > 1e-9
    assert position_m[laid[0]].min() == pytest.approx(49.4, abs=0.1)
    assert position_m[laid[0]].max() == pytest.approx(79.3, abs=0.1)
    assert np.array_equal(state.sand_gpm[0], state.sand_gpm[1])
    assert state.sand_gpm[0, 600] == pytest.approx(30.0 / speed_mps, rel=1e-9)
    # the third wheelset finds it, the second has not
    assert condition_at(rail, 70.0, speed_mps)[SAND] == pytest.approx(3.0, rel=1e-9)
    assert condition_at(rail, float(s[1]), speed_mps)[SAND] == 0.0


BAD = [
    ({"sanders": [{"wheelset": 5}]}, "less than or equal to 4"),
    ({"sanders": [{"wheelset": 1, "rate_gps": -1.0}]}, "greater than 0"),
    ({"sanders": [{"wheelset": 1, "delay_s": -1.0}]}, "greater than or equal to 0"),
    ({"sanders": [{"wheelset": 1}, {"wheelset": 1}]}, "sanders.1.offset_m = -0.6: there is a sander at this place"),
    ({"effect": {"left_share": 1.5}}, "less than or equal to 1"),
    ({"effect": {"sanded_adhesion": 15.0}}, "less than or equal to 0.5"),
    ({"effect": {"effective_gpm": 0.0}}, "greater than 0"),
]


@pytest.mark.parametrize(("tree", "message"), BAD)
def test_bad_sanding_is_refused(tree: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        SandingParameters.model_validate(tree)


def test_one_sander_may_lay_ahead_and_behind() -> None:
    one = SanderParameters(wheelset=1, offset_m=0.6)
    SandingParameters(sanders=(one, SanderParameters(wheelset=1)))
