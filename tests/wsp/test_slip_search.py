"""The search for the best slip: what is learnt from trials, and which levels follow from it."""

from typing import Any

import numpy as np
import pytest
from numba import njit
from pydantic import ValidationError

from wsp import CONTROLLERS
from wsp.controllers.records import record_of
from wsp.controllers.slip_search import _choose_levels, _learn, slip_search_constants, slip_search_state
from wsp.controllers.slip_search_parameters import LEVELS, SlipSearchParameters

P = SlipSearchParameters()


@njit
def _choose(state: Any, constants: Any) -> Any:
    return _choose_levels(state[0], constants[0])


@njit
def _take_in(state: Any, constants: Any) -> None:
    _learn(state[0], constants[0])


@pytest.fixture
def state() -> np.ndarray:
    return record_of(slip_search_state(P, 0.01))


@pytest.fixture
def constants() -> np.ndarray:
    return record_of(slip_search_constants(P, 0.01))


def measured(state: np.ndarray, own: list[float], cleaned: list[float]) -> None:
    state["own"][0], state["cleaned"][0], state["times"][0] = own, cleaned, np.ones(LEVELS)


def test_rail_that_slip_does_not_clean_is_braked_at_its_peak(state: np.ndarray, constants: np.ndarray) -> None:
    measured(state, [0.0, -0.02, -0.1, -0.2, -0.3], [0.0] * LEVELS)
    assert not _choose(state, constants)
    assert state["level"][0].tolist() == [0, 0, 0, 0]


def test_leading_axles_clean_for_those_behind(state: np.ndarray, constants: np.ndarray) -> None:
    """Level 3 costs an axle 12 % and gives the next one 6 %: worth it with three axles behind, not with fewer."""
    measured(state, [0.0, -0.02, -0.05, -0.12, -0.3], [0.0, 0.005, 0.02, 0.06, 0.07])
    assert _choose(state, constants)
    assert state["level"][0].tolist() == [3, 0, 0, 0]


def test_a_level_that_was_never_tried_is_never_taken(state: np.ndarray, constants: np.ndarray) -> None:
    measured(state, [0.0, 0.5, 0.0, 0.0, 0.0], [0.0] * LEVELS)
    state["times"][0] = [0.0, 0.0, 0.0, 0.0, 0.0]
    assert not _choose(state, constants)


def test_a_trial_is_judged_against_before_and_after(state: np.ndarray, constants: np.ndarray) -> None:
    """A drift of the ratios, the same before and after the trial, cancels."""
    state["trial"] = 2
    state["third"][0], state["fourth"][0] = [1.0, 0.945, 1.1], [1.0, 1.155, 1.1]
    _take_in(state, constants)
    assert state["own"][0, 2] == pytest.approx(0.9 - 1.0)
    assert state["cleaned"][0, 2] == pytest.approx(1.1 - 1.0)
    state["third"][0] = [1.0, 1.0, 1.0]  # the second measurement counts half
    _take_in(state, constants)
    assert state["own"][0, 2] == pytest.approx(-0.05)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("slip_share", (0.02, 0.01, 0.05, 0.1, 0.15)),
        ("axle_position_m", (0.0, 2.42, 2.0, 19.0)),
        ("scout_level", 5),
        ("margin", float("nan")),
    ],
)
def test_faulty_parameters_are_refused_by_name(key: str, value: Any) -> None:
    with pytest.raises(ValidationError, match=key):
        CONTROLLERS["adaptive"].Parameters(search={key: value})
