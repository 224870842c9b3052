"""Eight lanes at once do what eight floats do."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wheel_rail.compiled import compiled
from wheel_rail.lane_arrays import lanes_at, of_wheels, of_wheelsets, put_lanes, put_wheelsets
from wheel_rail.lane_functions import cube_root
from wheel_rail.lanes import LANES, every, greater, lane, lanes_of, lesser, some, where

eights = st.lists(st.floats(-1e3, 1e3), min_size=LANES, max_size=LANES).map(np.array)


@compiled
def _both_kinds(x: Any, y: Any) -> Any:
    """Something of everything, for floats as for lanes."""
    chosen = where((x < y) | ((x >= 2.0) & (y <= 0.5)), x - 2.0 * y, -x / (1.0 + abs(y)))
    return chosen + math.sqrt(abs(x)) + greater(x, y) * 3.0 - lesser(y, 1.0)


@compiled
def _in_lanes(x: np.ndarray, y: np.ndarray, out: np.ndarray) -> None:
    put_lanes(out, 0, _both_kinds(lanes_at(x, 0), lanes_at(y, 0)))


@given(eights, eights)
@settings(deadline=None)
def test_arithmetic_is_that_of_floats_to_the_bit(x: np.ndarray, y: np.ndarray) -> None:
    out = np.empty(LANES)
    _in_lanes(x, y, out)
    assert out.tolist() == [_both_kinds(a, b) for a, b in zip(x.tolist(), y.tolist(), strict=True)]


@compiled
def _functions(x: np.ndarray, out: np.ndarray) -> None:
    value = lanes_at(x, 0)
    put_lanes(out, 0, math.exp(value))
    put_lanes(out, 8, math.atan(value))
    put_lanes(out, 16, cube_root(abs(value) + 1e-6))


@given(eights, st.floats(-9.0, 0.0))
@settings(deadline=None, max_examples=300)
def test_functions_are_right_to_the_last_places(x: np.ndarray, power: float) -> None:
    x = np.clip(x * 10.0**power, -690.0, 690.0)
    out = np.empty(3 * LANES)
    _functions(x, out)
    right = np.concatenate([np.exp(x), np.arctan(x), np.cbrt(np.abs(x) + 1e-6)])
    assert out == pytest.approx(right, rel=4.0 * np.finfo(float).eps, abs=0.0)


def test_functions_at_the_ends() -> None:
    x = np.array([0.0, -0.0, 1e9, -1e9, math.inf, -math.inf, math.nan, -800.0])
    out = np.empty(3 * LANES)
    _functions(x, out)
    assert out[[0, 1]].tolist() == [1.0, 1.0]
    assert out[7] < 1e-303
    assert out[8:14] == pytest.approx(np.arctan(x[:6]), rel=1e-15)
    assert np.isnan(out[[6, 14]]).all()


@compiled
def _tests(x: np.ndarray) -> tuple[bool, bool]:
    positive = lanes_at(x, 0) > 0.0
    return every(positive), some(positive)


@given(st.lists(st.sampled_from([-1.0, 0.0, 1.0, math.nan]), min_size=LANES, max_size=LANES))
@settings(deadline=None)
def test_every_and_some(x: list[float]) -> None:
    assert _tests(np.array(x)) == (all(value > 0.0 for value in x), any(value > 0.0 for value in x))


@compiled
def _moved(rows: np.ndarray, out: np.ndarray) -> float:
    put_lanes(out, 0, of_wheels(rows, 1, 3))
    put_lanes(out, 8, of_wheelsets(rows, 2, 3))
    put_wheelsets(out, 16, 2, lanes_of((1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)))
    return float(lane(lanes_at(rows, 3), 2))


def test_lanes_come_from_arrays_and_go_back() -> None:
    rows = np.arange(24.0).reshape(LANES, 3)
    out = np.zeros((3, LANES))
    assert _moved(rows, out) == 5.0
    assert out[0].tolist() == rows[:, 1].tolist()
    assert out[1].tolist() == [2.0, 2.0, 5.0, 5.0, 8.0, 8.0, 11.0, 11.0]
    assert out[2].tolist() == [3.0, 0.0, 7.0, 0.0, 11.0, 0.0, 15.0, 0.0]
