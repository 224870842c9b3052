"""What every controller keeps to, and the rule table's own rules, on made-up axle speeds."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from wsp import CONTROLLERS, FILL, HOLD, VENT, ControllerOutput
from wsp.controllers.interface import OUTPUT

ALL_VALID = np.ones(4, np.bool_)


DECIDING = [name for name in CONTROLLERS if name != "replay"]  # that one needs a record, see test_replay.py


def build(name: str, **parameters: Any) -> Any:
    controller = CONTROLLERS[name](CONTROLLERS[name].Parameters(**parameters))
    controller.reset(0.0, 1)
    return controller


def drive(
    controller: Any, speeds: np.ndarray, demand: float = 1.0, direction: int = 1, outside: float = np.nan
) -> np.ndarray:
    """Commands (n, 4) and reference (n, 1) of a controller fed with axle speeds (n, 4)."""
    rows = []
    for k, row in enumerate(speeds):
        output = controller.step(0.01 * k, row, ALL_VALID, demand, direction, outside)
        rows.append((*output.valve, output.reference_speed_mps))
    return np.array(rows)


def falling(from_mps: float, seconds: float, deceleration_mps2: float = 0.0) -> np.ndarray:
    return np.tile((from_mps - deceleration_mps2 * np.arange(0.0, seconds, 0.01))[:, None], (1, 4))


@pytest.mark.parametrize("name", DECIDING)
def test_ticks_are_10_ms_and_output_is_well_formed(name: str) -> None:
    controller = build(name)
    output = controller.step(0.0, np.full(4, 20.0), ALL_VALID, 1.0, 1, np.nan)
    assert controller.period_s == 0.01
    assert output.valve.dtype == np.int8
    assert output.valve.shape == output.sand.shape == (4,)
    assert output.track_brake is False


def test_an_output_stands_in_its_record_however_it_is_written() -> None:
    record = np.zeros(1, OUTPUT)
    output = ControllerOutput(record)
    assert output.address == record.ctypes.data
    assert np.isnan(record["reference_speed_mps"][0])
    output.valve = np.array([FILL, HOLD, VENT, HOLD])  # as a whole, by another type
    output.sand[2] = True  # in place
    output.track_brake, output.reference_speed_mps = True, 12.5
    assert (record["reference_speed_mps"][0], record["track_brake"][0]) == (12.5, 1)
    assert record["valve"][0].tolist() == [FILL, HOLD, VENT, HOLD]
    assert record["sand"][0].tolist() == [0, 0, 1, 0]
    output.sand = np.array([True, False, False, True])
    record["valve"][0, 0] = VENT
    assert output.sand.tolist() == [True, False, False, True]
    assert output.valve.tolist() == [VENT, HOLD, VENT, HOLD]
    output.withdraw()
    assert not record["valve"].any()
    assert not record["sand"].any()
    assert not record["track_brake"].any()


SPEEDS = st.lists(st.lists(st.floats(-90.0, 90.0), min_size=4, max_size=4), min_size=1, max_size=40)


@pytest.mark.parametrize("name", DECIDING)
@settings(deadline=None, max_examples=50)
@given(SPEEDS, st.lists(st.booleans(), min_size=4, max_size=4), st.floats(0.0, 1.0), st.sampled_from([-1, 1]))
def test_any_speeds_give_valve_codes_and_the_same_ones_again(
    name: str, speeds: list[list[float]], valid: list[bool], demand: float, direction: int
) -> None:
    controller = build(name)
    runs = []
    for _ in range(2):
        controller.reset(0.0, direction)
        seen = []
        for k, row in enumerate(speeds):
            output = controller.step(0.01 * k, np.array(row), np.array(valid), demand, direction, np.nan)
            assert np.isin(output.valve, (FILL, HOLD, VENT)).all()
            assert np.isnan(output.reference_speed_mps) or output.reference_speed_mps >= 0.0
            seen.append((output.valve.tobytes(), np.float64(output.reference_speed_mps).tobytes()))
        runs.append(seen)
    assert runs[0] == runs[1]


def test_none_keeps_the_brakes_filled() -> None:
    speeds = falling(30.0, 2.0)
    speeds[:, 2] = 0.0
    out = drive(build("none"), speeds)
    assert (out[:, :4] == FILL).all()
    assert np.isnan(out[:, 4]).all()


def test_dry_braking_is_left_alone() -> None:
    out = drive(build("rule-table"), np.vstack([falling(33.0, 2.0), falling(33.0, 30.0, 0.95)]))
    assert (out[:, :4] == FILL).all()


def sliding_axle(axle: int = 1) -> np.ndarray:
    """One axle slides away at 8 m/s2 after a second, from 20 m/s, down to 12 m/s, and stays there."""
    speeds = falling(20.0, 3.0)
    speeds[100:, axle] = np.maximum(12.0, 20.0 - 8.0 * np.arange(200) * 0.01)
    return speeds


@pytest.mark.parametrize("direction", [1, -1])
def test_a_sliding_axle_and_no_other_is_vented_within_a_tenth_of_a_second(direction: int) -> None:
    out = drive(build("rule-table"), direction * sliding_axle(), direction=direction)
    assert (out[:100, :4] == FILL).all()
    assert (out[:, [0, 2, 3]] == FILL).all()
    assert VENT in out[100:110, 1]
    np.testing.assert_allclose(out[:, 4], 20.0, atol=0.01)


def test_a_recovering_axle_is_not_vented_and_a_recovered_one_is_filled_in_pulses() -> None:
    speeds = np.vstack([sliding_axle(), falling(20.0, 3.0)])
    speeds[300:400, 1] = 12.0 + 0.08 * np.arange(100)
    out = drive(build("rule-table"), speeds)[:, 1]
    assert (out[310:400] != VENT).all()
    refill = out[420:580]
    assert (refill == FILL).any()
    assert (refill == HOLD).any()
    assert out[-1] == FILL  # quiet again


def test_brakes_fill_below_the_cut_off_without_demand_and_without_a_valid_speed() -> None:
    slow = 0.06 * sliding_axle()
    assert (drive(build("rule-table"), slow)[:, :4] == FILL).all()
    assert (drive(build("rule-table"), sliding_axle(), demand=0.0)[:, :4] == FILL).all()
    controller = build("rule-table")
    valid = np.array([True, False, True, True])
    for k, row in enumerate(sliding_axle()):
        output = controller.step(0.01 * k, row, valid, 1.0, 1, np.nan)
        assert (output.valve == FILL).all()


def test_watchdog_ends_venting_and_fills_for_its_time() -> None:
    speeds = falling(30.0, 30.0)
    speeds[100:, 3] = 0.0  # locked for good
    out = drive(build("rule-table", watchdog_s=4.0, watchdog_refill_s=0.5), speeds)[:, 3]
    filled = np.flatnonzero(out[110:] == FILL) + 110
    first_vent = np.flatnonzero(out == VENT)[0]
    assert filled[0] - first_vent <= 400
    unfilled = np.split(out[first_vent:], np.flatnonzero(np.diff(out[first_vent:] == FILL)) + 1)
    for run in unfilled:
        assert len(run) <= (50 if run[0] == FILL else 400)
    assert len(unfilled[1]) == 50


def test_wheels_of_unequal_diameter_do_not_look_like_sliding_ones() -> None:
    worn = np.array([1.01, 0.99, 1.0, 0.98])
    controller = build("rule-table")
    drive(controller, falling(33.0, 2.0) * worn, demand=0.0)
    out = drive(controller, falling(33.0, 20.0, 0.95) * worn)
    assert (out[:, :4] == FILL).all()
    # The deceleration jumps here, which no train's does: the reference is too high until its own has grown.
    np.testing.assert_allclose(out[:, 4], falling(33.0, 20.0, 0.95)[:, 0] * worn.mean(), atol=0.15)


def test_an_outside_reference_replaces_the_controllers_own() -> None:
    """All four slide away together, which the outside reference shows from the first tick."""
    controller = build("rule-table")
    out = np.array([
        (*controller.step(0.01 * k, np.full(4, 18.5), ALL_VALID, 1.0, 1, 20.0).valve, 0) for k in range(30)
    ])  # fmt: skip
    assert controller.step(0.3, np.full(4, 18.5), ALL_VALID, 1.0, 1, 20.0).reference_speed_mps == 20.0
    assert (drive(build("rule-table"), np.full((30, 4), 18.5))[:, :4] == FILL).all()
    falls = 20.0 - 4.0 * np.arange(0.0, 0.5, 0.01)
    controller = build("rule-table")
    out = drive(controller, np.tile(falls[:, None], (1, 4)), outside=20.0)
    assert (out[25:, :4] == VENT).any(axis=0).all()


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("table", ("HHfHf", "VvHHH", "VVvvH", "VVVHX")),
        ("table", ("HHfHf", "VvHHH", "VVvvH", "VVVH")),
        ("slip_offset_mps", (0.5, 0.15, 0.75)),
        ("acceleration_mps2", (-0.75, -2.0, 0.75, 3.5)),
        ("watchdog_s", float("nan")),
        ("fill_pulse", 0.02),
    ],
)
def test_faulty_parameters_are_refused_by_name(key: str, value: Any) -> None:
    with pytest.raises(ValidationError, match=key):
        CONTROLLERS["rule-table"].Parameters(**{key: value})


NONSENSE = [[0.0] * 4, [20.0, -20.0, 20.0, -20.0], [20.0, 20.0, float("nan"), 20.0], [0.0, 20.0, 20.0, 20.0]]


@pytest.mark.parametrize("speeds", NONSENSE)
def test_coasting_learns_nothing_from_speeds_that_no_worn_wheels_have(speeds: list[float]) -> None:
    """One tick of nonsense while coasting: no error, and the reference afterwards is that of the wheels."""
    rule_table = CONTROLLERS["rule-table"]
    controller = rule_table(rule_table.Parameters())
    controller.reset(0.0, 1)
    valid = np.ones(4, dtype=np.bool_)
    rolling = np.full(4, 20.0)
    for k in range(200):
        controller.step(0.01 * k, rolling, valid, 0.0, 1, np.nan)
    controller.step(2.0, np.array(speeds), valid, 0.0, 1, np.nan)
    for k in range(201, 600):
        reference = controller.step(0.01 * k, rolling, valid, 0.0, 1, np.nan).reference_speed_mps
    assert reference == pytest.approx(20.0, abs=0.02)
