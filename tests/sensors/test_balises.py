"""Balises: where, when, and how wrong."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from sensors import BaliseParameters, Balises


def test_each_balise_is_passed_once_at_its_place_and_told_within_its_accuracy() -> None:
    t_s = 0.005 * np.arange(40_001)
    position_m = -200.0 + 30.0 * t_s
    passed = Balises(BaliseParameters(spacing_m=1000.0, first_m=500.0), 1).passed(t_s, position_m)
    places = 500.0 + 1000.0 * np.arange(6)
    np.testing.assert_allclose(passed.t_s, (places[places < position_m[-1]] + 200.0) / 30.0, atol=1e-9)
    assert np.all(np.abs(passed.position_m - places[: len(passed)]) <= 5.0)


def test_the_error_is_uniform_over_lines() -> None:
    t_s, position_m = np.array([0.0, 1.0]), np.array([990.0, 1010.0])
    parameters = BaliseParameters(first_m=0.0)
    told = np.array([Balises(parameters, seed).passed(t_s, position_m).position_m[0] for seed in range(400)]) - 1000.0
    assert np.max(np.abs(told)) <= 5.0
    assert np.std(told) == pytest.approx(5.0 / math.sqrt(3.0), rel=0.1)


def test_there_and_back_reads_the_same_balises_in_turn() -> None:
    t_s = np.arange(0.0, 200.0, 0.1)
    position_m = 100.0 + 3000.0 * np.sin(math.pi * t_s / 200.0)
    passed = Balises(BaliseParameters(), 3).passed(t_s, position_m)
    assert len(passed) == 6
    np.testing.assert_array_equal(passed.position_m, passed.position_m[::-1])


def test_none_before_the_first_and_none_at_standstill() -> None:
    balises = Balises(BaliseParameters(first_m=0.0), 3)
    assert len(balises.passed([0.0, 1.0], [-2500.0, -400.0])) == 0
    assert len(balises.passed([0.0, 1.0, 2.0], [10.0, 10.0, 10.0])) == 0


@pytest.mark.parametrize("wrong", [{"spacing_m": 0.0}, {"accuracy_m": -1.0}, {"first_m": math.nan}, {"space_m": 1.0}])
def test_wrong_parameters_are_refused_by_name(wrong: dict[str, float]) -> None:
    with pytest.raises(ValidationError, match=next(iter(wrong))):
        BaliseParameters(**wrong)  # type: ignore[arg-type]
