"""Every controller, fed with anything: legal commands, limits that no input can pass, both directions alike."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsp import CONTROLLERS, FILL, HOLD, VENT

ALL_VALID = np.ones(4, np.bool_)
DECIDING = sorted(set(CONTROLLERS) - {"replay"})  # replay does what a file says
WORKING = sorted(set(DECIDING) - {"none"})

READING = st.one_of(st.floats(-90.0, 90.0), st.sampled_from([0.0, float("nan"), float("inf"), -float("inf")]))
FOUR_READINGS = st.tuples(READING, READING, READING, READING)
TICK = st.tuples(
    FOUR_READINGS,
    st.tuples(*[st.booleans()] * 4),
    st.floats(0.0, 1.0),
    st.one_of(st.just(float("nan")), st.floats(0.0, 90.0)),
)
SPEEDS = st.tuples(*[st.sampled_from([0.0, 3.0, 19.0, 19.7, 20.0])] * 4)


def build(name: str, **parameters: Any) -> Any:
    controller = CONTROLLERS[name](CONTROLLERS[name].Parameters(**parameters))
    controller.reset(0.0, 1)
    return controller


def drive(
    controller: Any, speeds: np.ndarray, demand: float = 1.0, direction: int = 1, outside: float = np.nan
) -> np.ndarray:
    """Valve codes (n, 4) of a controller fed with axle speeds (n, 4)."""
    return np.array([
        controller.step(0.01 * k, row, ALL_VALID, demand, direction, outside).valve.copy()
        for k, row in enumerate(speeds)
    ])  # fmt: skip


def slid(seed: int, seconds: float = 8.0) -> np.ndarray:
    """Axles that slide away from a braking train one by one and grip again, with some noise; (n, 4) m/s."""
    rng = np.random.default_rng(seed)
    ticks = round(100 * seconds)
    train = 25.0 - 0.006 * np.arange(ticks)
    slip = np.abs(np.sin(0.02 * np.arange(ticks)[:, None] + rng.uniform(0.0, 3.0, 4)) - 0.3) * rng.uniform(0, 4, 4)
    return train[:, None] - slip + 0.01 * rng.standard_normal((ticks, 4))


@pytest.mark.parametrize("name", DECIDING)
@settings(deadline=None, max_examples=40)
@given(st.lists(TICK, min_size=1, max_size=30), st.sampled_from([-1, 1]), st.integers(1, 20))
def test_any_input_gives_legal_output(name: str, inputs: list[Any], direction: int, repeats: int) -> None:
    controller = build(name)
    controller.reset(0.0, direction)
    for k, (speeds, valid, demand, outside) in enumerate(inputs * repeats):
        output = controller.step(0.01 * k, np.array(speeds), np.array(valid), demand, direction, outside)
        assert np.isin(output.valve, (FILL, HOLD, VENT)).all()
        assert output.valve.dtype == np.int8
        assert output.sand.dtype == np.bool_
        assert isinstance(output.track_brake, bool)
        reference = output.reference_speed_mps
        assert np.isnan(reference) or 0.0 <= reference < 1e3


@pytest.mark.parametrize("name", WORKING)
@settings(deadline=None, max_examples=25)
@given(st.lists(SPEEDS, min_size=1, max_size=8))
def test_no_axle_goes_unfilled_longer_than_the_watchdog_allows(
    name: str, speeds: list[tuple[float, float, float, float]]
) -> None:
    """Speeds stand for 2 s each, while an outside reference says 20 m/s: locked axles and sliding ones, for long."""
    controller = build(name, watchdog_s=1.0, watchdog_refill_s=0.2)
    unfilled = np.zeros(4, int)
    vented = False
    for row in speeds:
        for _ in range(200):
            valve = controller.step(0.0, np.array(row), ALL_VALID, 1.0, 1, 20.0).valve
            unfilled = np.where(valve == FILL, 0, unfilled + 1)
            vented = vented or (valve == VENT).any()
            assert unfilled.max() <= 100
    assert vented or min(map(min, speeds)) > 10.0


@pytest.mark.parametrize("name", WORKING)
def test_the_watchdog_stays_below_the_brakes_own_timer(name: str) -> None:
    """One axle locked for good, as an outside reference says, default limits: filled after 9 s, for a second."""
    speeds = np.full((3000, 4), 30.0)
    speeds[100:, 3] = 0.0
    valve = drive(build(name), speeds, outside=30.0)[:, 3]
    runs = np.split(valve, np.flatnonzero(np.diff(valve == FILL)) + 1)
    unfilled = [len(run) for run in runs if run[0] != FILL]
    assert 800 < max(unfilled) <= 900
    assert all(len(run) == 100 for run in runs[2:-1:2])


@pytest.mark.parametrize("name", DECIDING)
@settings(deadline=None, max_examples=25)
@given(st.lists(SPEEDS, min_size=1, max_size=40), st.booleans())
def test_brakes_fill_without_demand_and_below_the_cut_off(
    name: str, speeds: list[tuple[float, float, float, float]], slow: bool
) -> None:
    rows = (0.06 if slow else 1.0) * np.repeat(np.array(speeds), 10, axis=0)
    assert (drive(build(name), rows, demand=1.0 if slow else 0.0) == FILL).all()


@pytest.mark.parametrize("name", WORKING)
@pytest.mark.parametrize("seed", range(3))
def test_both_directions_are_alike(name: str, seed: int) -> None:
    speeds = slid(seed)
    forward = drive(build(name), speeds)
    backward = drive(build(name), -speeds, direction=-1)
    assert VENT in forward
    assert np.array_equal(forward, backward)


@pytest.mark.parametrize("name", WORKING)
def test_a_train_the_other_way_round_brakes_alike(name: str) -> None:
    """Axle 4 leads: what the first axle was told before, it is told now (no axle released, which goes by number)."""
    speeds = slid(5)
    parameters = {"reference": {"source": "fastest-axle"}}
    forward = drive(build(name, **parameters), speeds)
    backward = drive(build(name, **parameters), -speeds[:, ::-1], direction=-1)
    assert VENT in forward
    assert np.array_equal(forward, backward[:, ::-1])


@pytest.mark.parametrize("name", WORKING)
def test_a_reset_forgets_everything(name: str) -> None:
    controller = build(name)
    first = drive(controller, slid(1))
    assert not np.array_equal(first, drive(controller, slid(1)))
    controller.reset(0.0, 1)
    assert np.array_equal(first, drive(controller, slid(1)))
