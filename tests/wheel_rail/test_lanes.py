"""Eight lanes at once do what eight floats do."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wheel_rail.compiled import compiled
from wheel_rail.lane_arrays import lanes_at, of_pairs, of_wheels, of_wheelsets, put_four, put_lanes, put_wheelsets
from wheel_rail.lane_functions import cube_root, over_root
from wheel_rail.lanes import (
    LANES,
    doubled,
    every,
    greater,
    joined,
    lane,
    lanes_of,
    lesser,
    some,
    swapped,
    total,
    where,
)

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


@given(st.floats(-0.04, 0.04))
def test_over_root_is_as_right_as_it_says(y: float) -> None:
    allowed = 4e-16 if abs(y) <= 0.004 else 3e-15 if abs(y) <= 0.01 else 5e-11
    assert over_root(y) == pytest.approx(1.0 / math.sqrt(1.0 + y), rel=allowed, abs=0.0)


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
    put_lanes(out, 24, of_pairs(rows, 1, 5))
    value = lanes_at(rows, 8)
    put_lanes(out, 32, swapped(value))
    put_lanes(out, 40, joined(value, lanes_at(rows, 0)))
    put_lanes(out, 48, doubled(value))
    put_four(out, 56, value)
    out[7, 7] = total(value)
    return float(lane(lanes_at(rows, 3), 2))


def test_lanes_come_from_arrays_and_go_back() -> None:
    rows = np.arange(24.0).reshape(LANES, 3)
    out = np.zeros((8, LANES))
    assert _moved(rows, out) == 5.0
    assert out[0].tolist() == rows[:, 1].tolist()
    assert out[1].tolist() == [2.0, 2.0, 5.0, 5.0, 8.0, 8.0, 11.0, 11.0]
    assert out[2].tolist() == [3.0, 0.0, 7.0, 0.0, 11.0, 0.0, 15.0, 0.0]
    assert out[3].tolist() == [1.0, 2.0, 6.0, 7.0, 11.0, 12.0, 16.0, 17.0]
    assert out[4].tolist() == [12.0, 13.0, 14.0, 15.0, 8.0, 9.0, 10.0, 11.0]
    assert out[5].tolist() == [8.0, 9.0, 10.0, 11.0, 0.0, 1.0, 2.0, 3.0]
    assert out[6].tolist() == [8.0, 8.0, 9.0, 9.0, 10.0, 10.0, 11.0, 11.0]
    assert out[7].tolist() == [8.0, 9.0, 10.0, 11.0, 0.0, 0.0, 0.0, 92.0]
