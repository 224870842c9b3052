"""Controllers that work with slip set-points, on the slide bench: what they make of rails, brakes and faults."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from wsp import CONTROLLERS, BrakeParameters, ControllerOutput

SLIP_LAWS = ("slip-tracking", "adaptive")
WORKING = sorted(set(CONTROLLERS) - {"none", "replay"})


def build(name: str, **parameters: Any) -> Any:
    return CONTROLLERS[name](CONTROLLERS[name].Parameters(**parameters))


def even(peak: float) -> Callable[[float], float]:
    return lambda _: peak


class Onlooker:
    """A controller that sees `seen(t, speeds)` in place of the speeds, going backward if asked; keeps its wishes."""

    period_s = 0.01

    def __init__(self, controller: Any, seen: Callable[..., Any] | None = None, backward: bool = False) -> None:
        self.controller = controller
        self.seen = seen or (lambda _, speeds: speeds)
        self.sign = -1 if backward else 1
        self.sand: list[bool] = []
        self.track_brake: list[bool] = []

    def reset(self, t_s: float, direction: int) -> None:
        self.controller.reset(t_s, self.sign * direction)

    def step(
        self, t_s: float, speeds: np.ndarray, valid: np.ndarray, demand: float, direction: int, outside: float
    ) -> ControllerOutput:
        seen = self.seen(t_s, speeds.copy())
        output: ControllerOutput = self.controller.step(
            t_s, self.sign * seen, valid & ~np.isnan(seen), demand, self.sign * direction, outside
        )
        self.sand.append(bool(output.sand.all()))
        self.track_brake.append(output.track_brake)
        return output


@pytest.mark.parametrize("name", SLIP_LAWS)
@pytest.mark.parametrize("peak", [0.03, 0.06])
def test_nearly_all_of_the_adhesion_is_used(
    name: str, peak: float, coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    """On rail that grips best at 0.7 % slip, by tachometers rougher than the preset's; half of rule-table's air."""
    stop = slide_bench(build(name), coach_brake, even(peak), step_s=0.005)
    table = slide_bench(build("rule-table"), coach_brake, even(peak), step_s=0.005)
    print(f"{name} on {peak}: {stop.utilisation:.3f}, {stop.air_nl:.0f} Nl against {table.utilisation:.3f}")
    assert stop.utilisation > 0.96
    assert stop.longest_lock_s == 0.0
    assert stop.reference_rms_mps < 0.25
    assert stop.distance_m < table.distance_m
    assert stop.air_nl < 0.5 * table.air_nl


BRAKES = {
    "slow valves": {"valve_dead_time_s": 0.04},
    "quick valves": {"valve_dead_time_s": 0.02},
    "large cylinders": {"cylinder_volume_dm3": 3.5},
    "small cylinders": {"cylinder_volume_dm3": 1.8},
    "soft pads": {"pad_friction": 0.28},
    "hard pads": {"pad_friction": 0.42},
}


@pytest.mark.parametrize("brake", BRAKES)
def test_another_brake_than_supposed_costs_little(
    brake: str, coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    plant = coach_brake.model_copy(update=BRAKES[brake])
    stop = slide_bench(build("adaptive"), plant, even(0.05), step_s=0.005)
    assert stop.utilisation > 0.95
    assert stop.longest_lock_s == 0.0


@pytest.mark.parametrize("name", WORKING)
def test_backward_as_well_as_forward(name: str, coach_brake: BrakeParameters, slide_bench: Callable[..., Any]) -> None:
    forward = slide_bench(build(name), coach_brake, even(0.06), step_s=0.005)
    backward = slide_bench(Onlooker(build(name), backward=True), coach_brake, even(0.06), step_s=0.005)
    if name == "adaptive":  # compares other axles
        assert backward.distance_m == pytest.approx(forward.distance_m, rel=0.01)
    else:
        assert np.array_equal(backward.ticks, forward.ticks)


def test_slip_is_held_where_it_is_wanted(coach_brake: BrakeParameters, slide_bench: Callable[..., Any]) -> None:
    """15 %, where this rail's adhesion falls with slip and only the controller keeps the axles from locking; and the
    reference is not lost though all axles slide alike: now and then one is relieved."""
    controller = build("slip-tracking", slip_offset_mps=0.2, slip_share=(0.15,) * 4)
    stop = slide_bench(controller, coach_brake, even(0.05), step_s=0.005)
    rows = stop.ticks[(stop.ticks[:, 0] > 8.0) & (stop.ticks[:, 2] > 6.0)]
    slip = 1.0 - rows[:, 3:7] / rows[:, 2:3]
    assert np.median(slip) == pytest.approx(0.157, abs=0.02)
    assert stop.longest_lock_s == 0.0
    assert stop.reference_rms_mps < 0.5
    assert (slip.min(axis=0) < 0.02).all()  # each has been relieved


def lost(t_s: float, speeds: np.ndarray) -> np.ndarray:
    if t_s > 8.0:
        speeds[3] = np.nan
    return speeds


def wheel_too_small(t_s: float, speeds: np.ndarray) -> np.ndarray:
    if t_s > 8.0:
        speeds[1] *= 1.25
    return speeds


@pytest.mark.parametrize("name", WORKING)
@pytest.mark.parametrize("fault", [lost, wheel_too_small])
def test_a_faulty_tachometer_costs_no_more_than_its_own_axle(
    name: str, fault: Callable[..., Any], coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    """It happens while braking; three axles of four stop the coach in 4/3 of the distance, and no axle stays locked."""
    sound = slide_bench(build(name), coach_brake, even(0.05), step_s=0.005)
    faulty = slide_bench(Onlooker(build(name), fault), coach_brake, even(0.05), step_s=0.005)
    assert faulty.distance_m < 1.34 * sound.distance_m
    assert faulty.longest_lock_s < 15.0


@pytest.mark.parametrize("name", WORKING)
def test_sand_is_asked_for_where_the_rail_gives_little(
    name: str, coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    """At 0.03 of adhesion soon and for the rest of the stop, at 0.08 hardly ever; no track brake."""
    low, fair = Onlooker(build(name)), Onlooker(build(name))
    slide_bench(low, coach_brake, even(0.03), step_s=0.005)
    slide_bench(fair, coach_brake, even(0.08), step_s=0.005)
    assert not any(low.sand[:200])
    assert np.mean(low.sand[800:-400]) > 0.95
    assert not any(low.sand[-50:])  # nearly at rest
    assert np.mean(fair.sand) < 0.2
    assert not any(low.track_brake)


def test_what_is_asked_for_follows_the_parameters(
    coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    onlooker = Onlooker(build("rule-table", sand_below_mps2=0.0, track_brake_below_mps2=0.5))
    slide_bench(onlooker, coach_brake, even(0.03), step_s=0.005)
    assert not any(onlooker.sand)
    assert np.mean(onlooker.track_brake[800:-400]) > 0.95
