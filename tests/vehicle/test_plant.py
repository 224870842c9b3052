"""Compiled work between the steps of a run."""

from typing import Any, NoReturn

import numba
import numpy as np
import pytest

from tests.vehicle.conftest import MakeBench
from vehicle import Actuation, CoachState, Plant
from wheel_rail.compiled import address_of, array_at

STEP_S, PERIOD_S, TICK_S = 0.001, 0.002, 0.01
ENOUGH = 40


def _noted(address: int, t_s: float) -> int:
    """Count the calls, add up their times, and refuse to go on after so many."""
    numbers = array_at(address, (3,))
    numbers[0] += 1.0
    numbers[1] += t_s
    return 7 if numbers[0] > numbers[2] else 0


@pytest.fixture(scope="module")
def noted() -> Any:
    return numba.cfunc(numba.int64(numba.int64, numba.float64))(_noted)


class Refused(Exception):
    pass


def refuse(t_s: float, answer: int) -> NoReturn:
    raise Refused(f"{t_s:.3f} {answer}")


def test_it_works_at_its_own_period_and_ends_the_run_when_it_refuses(make_bench: MakeBench, noted: Any) -> None:
    bench = make_bench()
    for most in (1000.0, ENOUGH):
        numbers = np.array([0.0, 0.0, most])
        ticks: list[tuple[float, float]] = []

        def on_tick(t_s: float, _state: CoachState, numbers: np.ndarray = numbers, ticks: Any = ticks) -> Actuation:
            ticks.append((t_s, numbers[0]))
            return Actuation()

        plant = Plant(noted.address, address_of(numbers), PERIOD_S, refuse)

        def run(plant: Plant = plant, on_tick: Any = on_tick) -> None:
            bench.coach.run(STEP_S, 0.1, 100.0, 20.0, on_tick, TICK_S, plant=plant)

        if most == ENOUGH:
            with pytest.raises(Refused, match=r"^0.080 7$"):
                run()
            assert numbers[0] == ENOUGH + 1
        else:
            run()
            assert numbers[0] == 50
            assert numbers[1] == pytest.approx(PERIOD_S * sum(range(50)))
        # at a tick it works after the callback
        assert ticks == [(pytest.approx(TICK_S * k), 5 * k) for k in range(len(ticks))]


def test_its_period_is_a_whole_number_of_steps(make_bench: MakeBench, noted: Any) -> None:
    with pytest.raises(ValueError, match="period_s = 0.0015"):
        make_bench().coach.run(
            STEP_S, 0.1, 100.0, 20.0, lambda *_: Actuation(), TICK_S, plant=Plant(noted.address, 0, 0.0015, refuse)
        )
