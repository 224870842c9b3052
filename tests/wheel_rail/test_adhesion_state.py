"""What the rail keeps: energy conserved whatever the way, saved and loaded, bad states refused; friction memory."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from tests.wheel_rail.rail_kinds import adhesion, condition_at, force, fresh, parameters
from wheel_rail.adhesion_memory import FrictionMemoryParameters, recall_friction, remember_friction
from wheel_rail.adhesion_state import ENERGY_KEPT, STATE_CELL_M, RailState, deposit
from wheel_rail.lanes import LANES
from wheel_rail.recovery import DEGRADED, ENERGY, RECOVERED

RECOVERING = parameters({"recovery": "low-recovering", "peak_adhesion": 0.07})
ADHESION = adhesion(RECOVERING, 50.0)
places = st.floats(-1.0, 52.0)
deposit(ADHESION.tables(RailState(50.0)), 1.0, 2.0, 1.0, 0.0)  # compiled before hypothesis looks at the time


energies = st.floats(0.0, 1e6)


@given(st.lists(st.tuples(places, places, energies, energies), min_size=1, max_size=20))
def test_what_is_deposited_is_what_lies_on_the_rail(ways: list[tuple[float, float, float, float]]) -> None:
    state = RailState(50.0)
    rail = ADHESION.tables(state)
    for way in ways:
        deposit(rail, *way)
    for side in (0, 1):
        given_j = sum(way[2 + side] for way in ways)
        assert np.sum(state.energy_jpm[side]) * STATE_CELL_M == pytest.approx(given_j, rel=1e-9)
    assert np.all(state.energy_jpm >= 0.0)
    assert np.all(state.sand_gpm == 0.0)


@given(st.floats(0.0, 50.0), st.floats(-3.0, 3.0))
def test_energy_lies_evenly_where_the_wheel_went(s0: float, way: float) -> None:
    s1 = min(max(s0 + way, 0.0), 50.0)
    if abs(s1 - s0) < 1e-6:
        return
    state = RailState(50.0)
    deposit(ADHESION.tables(state), s0, s1, 0.0, 1000.0)
    edges = np.arange(state.energy_jpm.shape[1] + 1) * STATE_CELL_M
    low, high = min(s0, s1), max(s0, s1)
    swept = np.clip(np.minimum(edges[1:], high) - np.maximum(edges[:-1], low), 0.0, None)
    assert state.energy_jpm[1] * STATE_CELL_M == pytest.approx(1000.0 * swept / swept.sum(), abs=1e-3)


def test_a_wheel_that_spins_on_the_spot_heats_one_cell() -> None:
    state = RailState(50.0)
    rail = ADHESION.tables(state)
    for _ in range(10):
        deposit(rail, 20.05, 20.05, 7.0, 0.0)
    assert np.flatnonzero(state.energy_jpm[0]).tolist() == [200]
    assert state.energy_jpm[0, 200] == pytest.approx(700.0)


def test_wheels_behind_find_what_wheels_in_front_have_cleaned() -> None:
    """Work of a wheel, deposited step by step, is what the condition behind it holds: f N e per metre."""
    state = RailState(50.0)
    rail = ADHESION.tables(state)
    s, speed, creep, step = 10.0, 20.0, 0.15, 0.005
    work = 0.0
    while s < 40.0:
        work = -force(condition_at(rail, s, speed), creep, speed)[0] * creep
        deposit(rail, s, s + speed * step, work * speed * step, 0.0)
        s += speed * step
    behind = condition_at(rail, 30.0, speed)
    assert behind[ENERGY] == pytest.approx(work, rel=1e-9)
    assert condition_at(rail, 30.0, speed, side=1)[ENERGY] == 0.0
    assert -force(behind, creep, speed)[0] * creep > 1.02 * work


@pytest.mark.parametrize("length_m", [50.0, 33.33, 0.1, 1234.5])
def test_a_state_saved_and_loaded_is_the_same(length_m: float) -> None:
    state = RailState(length_m)
    state.table[:] = np.random.default_rng(1).uniform(0.0, 100.0, state.table.shape)
    again = RailState.from_arrays(length_m, state.as_arrays())
    assert np.array_equal(again.table, state.table)


def test_states_that_do_not_belong_here_are_refused() -> None:
    arrays = RailState(50.0).as_arrays()
    with pytest.raises(ValueError, match=r"the state of another line; this one is 60 m long"):
        RailState.from_arrays(60.0, arrays)
    with pytest.raises(ValueError, match=r"position_m: cells must be 0.1 m long, here the first is 0.2 m"):
        RailState.from_arrays(50.0, arrays | {"position_m": 2.0 * arrays["position_m"]})
    with pytest.raises(ValueError, match=r"energy_right_jpm = -1 at 3.0 m: must be finite and not negative"):
        RailState.from_arrays(50.0, arrays | {"energy_right_jpm": np.where(np.arange(502) == 30, -1.0, 0.0)})
    with pytest.raises(ValueError, match=r"sand_left_gpm = nan at 0.0 m"):
        RailState.from_arrays(50.0, arrays | {"sand_left_gpm": np.full(502, np.nan)})
    with pytest.raises(ValueError, match=r"energy_left_jpm: must have 502 values"):
        RailState.from_arrays(50.0, arrays | {"energy_left_jpm": np.zeros(3)})
    arrays.pop("sand_right_gpm")
    with pytest.raises(ValueError, match=r"sand_right_gpm: the column is missing"):
        RailState.from_arrays(50.0, arrays)
    with pytest.raises(ValueError, match=r"belongs to a line of 60.0 m, this one has 50.0 m"):
        ADHESION.tables(RailState(60.0))


def of_wheels(condition: np.ndarray) -> np.ndarray:
    """Eight wheels on the same rail."""
    return np.repeat(condition[:, None], LANES, axis=1)


def test_friction_follows_the_slip_speed_over_its_distance() -> None:
    """dmu/dt = -(s/d_c)(mu - mu_s) at constant slip speed, in any number of steps."""
    found = condition_at(fresh(RECOVERING, 50.0), 5.0)
    slip, distance = 2.0, 1e-3
    for steps in (1, 7):
        memory = np.ones((2, LANES))
        for _ in range(steps):
            remember_friction(of_wheels(found), memory, np.full(LANES, slip), 1e-3 / steps, distance, 1e-3)
        for k, at in enumerate((DEGRADED, RECOVERED)):
            steady = (1.0 - found[at + 1]) * np.exp(-found[at + 2] * slip) + found[at + 1]
            assert memory[k] == pytest.approx(steady + (1.0 - steady) * np.exp(-2.0), rel=1e-12)


def test_each_wheel_remembers_its_own_friction() -> None:
    found = condition_at(fresh(RECOVERING, 50.0), 5.0)
    slips = np.linspace(0.0, 7.0, LANES)
    memory = np.ones((2, LANES))
    remember_friction(of_wheels(found), memory, slips, 1e-3, 2e-3, 1e-3)
    for w, slip in enumerate(slips):
        alone = np.ones((2, LANES))
        remember_friction(of_wheels(found), alone, np.full(LANES, slip), 1e-3, 2e-3, 1e-3)
        assert memory[:, w] == pytest.approx(alone[:, 0], rel=1e-14)
    assert np.all(np.diff(memory[0]) < 0.0)


def test_remembered_friction_is_the_laws_own_once_it_has_followed() -> None:
    found = condition_at(fresh(RECOVERING, 50.0), 5.0)
    plain = force(found, 0.2, 20.0)
    memory = np.ones((2, LANES))
    remember_friction(of_wheels(found), memory, np.full(LANES, 4.0), 1.0, 1e-5, 1e-3)
    recalled = of_wheels(found)
    recall_friction(recalled, memory)
    fx, _, tangent, secant = force(recalled[:, 3].copy(), 0.2, 20.0)
    assert (fx, secant) == pytest.approx((plain[0], plain[3]), rel=1e-12)
    assert tangent > 0.0 > plain[2]  # what is remembered does not fall as the slip grows
    recalled = of_wheels(found)
    recall_friction(recalled, np.ones((2, LANES)))  # a wheel that has just begun to slide
    assert -force(recalled[:, 3].copy(), 0.2, 20.0)[0] > 1.2 * -plain[0]


def test_a_wheel_at_rest_forgets_at_the_lowest_slip() -> None:
    found = condition_at(fresh(RECOVERING, 50.0), 5.0)
    memory = np.full((2, LANES), 0.5)
    remember_friction(of_wheels(found), memory, np.zeros(LANES), 1.0, 1e-3, 1e-3)
    assert memory == pytest.approx(np.full((2, LANES), 1.0 - 0.5 * np.exp(-1.0)))


def test_tables_tell_of_the_memory() -> None:
    assert fresh(RECOVERING).memory_distance_m == 0.0
    memory = FrictionMemoryParameters(distance_m=2e-5, lowest_slip_mps=1e-3)
    rail = fresh(RECOVERING.model_copy(update={"memory": memory}))
    assert (rail.memory_distance_m, rail.memory_lowest_slip_mps) == (2e-5, 1e-3)
    with pytest.raises(ValidationError, match="greater than 0"):
        FrictionMemoryParameters(distance_m=-1e-6)
    assert rail.state[:, :, ENERGY_KEPT].sum() == 0.0
