"""Axles that grip correct the reference of the controllers with slip set-points, where it has gone wrong unseen."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from wsp import CONTROLLERS, BrakeParameters

SLIP_LAWS = ("slip-tracking", "adaptive")


def build(name: str) -> Any:
    return CONTROLLERS[name](CONTROLLERS[name].Parameters())


def reference_errors_mps(stop: Any) -> np.ndarray:
    """Reference less speed from the moment when the brakes are on, above 10 km/h."""
    rows = stop.ticks[(stop.ticks[:, 0] > 5.0) & (stop.ticks[:, 2] > 10.0 / 3.6)]
    return rows[:, 7] - rows[:, 2]


@pytest.mark.parametrize("name", SLIP_LAWS)
def test_reference_comes_down_with_the_train_where_dry_rail_returns(
    name: str, coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    """Patches that slide all axles for a second, dry rail between them: full braking there is 1 m/s2 in a second."""

    def peak(position_m: float) -> float:
        return 0.03 if position_m > 150.0 and position_m % 120.0 < 40.0 else 0.3

    stop = slide_bench(build(name), coach_brake, peak, speed_kmh=160.0, step_s=0.005)
    table = slide_bench(build("rule-table"), coach_brake, peak, speed_kmh=160.0, step_s=0.005)
    errors = reference_errors_mps(stop)
    print(f"{name}: reference {errors.min():+.2f} .. {errors.max():+.2f} m/s, {stop.distance_m:.0f} m, "
          f"rule-table {table.distance_m:.0f} m")  # fmt: skip
    assert errors.max() < 0.7
    assert errors.min() > -1.0
    assert stop.longest_lock_s < 0.4
    assert stop.distance_m < 1.01 * table.distance_m


@pytest.mark.parametrize("name", SLIP_LAWS)
@pytest.mark.parametrize("before", [-0.03, 0.03])
def test_reference_follows_a_change_of_gradient(
    name: str, before: float, coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    """All axles slide, and the train's deceleration changes by 0.3 m/s2 within a second though no force does."""

    def gradient(position_m: float) -> float:
        return before * float(np.clip((400.0 - position_m) / 30.0, 0.0, 1.0))

    stop = slide_bench(build(name), coach_brake, lambda _: 0.05, step_s=0.005, gradient=gradient)
    errors = reference_errors_mps(stop)
    print(f"{name}, {1000 * before:+.0f} per mille: reference {errors.min():+.2f} .. {errors.max():+.2f} m/s")
    assert np.abs(errors).max() < 1.2
    late = errors[len(errors) // 2 :]
    assert np.sqrt(np.mean(late**2)) < 0.3
    assert stop.utilisation > 0.93
