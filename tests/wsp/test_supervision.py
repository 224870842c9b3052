"""What controllers believe of their axles and what they ask for besides: made-up axle speeds."""

from typing import Any

import numpy as np
import pytest

from wsp import CONTROLLERS, FILL, VENT, ControllerOutput
from wsp.axle_speed import compare_wheels

ALL_VALID = np.ones(4, np.bool_)
WORKING = sorted(set(CONTROLLERS) - {"none", "replay"})


class Bench:
    """A controller and the time; `roll` gives it the same speeds, with a little noise, for some seconds."""

    def __init__(self, name: str, **parameters: Any) -> None:
        self.controller = CONTROLLERS[name](CONTROLLERS[name].Parameters(**parameters))
        self.controller.reset(0.0, 1)
        self.ticks = 0
        self.noise = np.random.default_rng(1)
        self.valves: list[np.ndarray] = []

    def step(
        self, speeds: np.ndarray, demand: float = 1.0, valid: np.ndarray = ALL_VALID, outside: float = np.nan
    ) -> ControllerOutput:
        output: ControllerOutput = self.controller.step(0.01 * self.ticks, speeds, valid, demand, 1, outside)
        self.valves.append(output.valve.copy())
        self.ticks += 1
        return output

    def roll(self, speeds: Any, seconds: float, demand: float = 0.0) -> ControllerOutput:
        for _ in range(round(100 * seconds)):
            output = self.step(np.asarray(speeds) + 0.003 * self.noise.standard_normal(4), demand)
        return output

    def brake(self, from_mps: float, seconds: float, wheels: np.ndarray) -> ControllerOutput:
        """Full service on dry rail: 0.25 m/s3 up to 0.95 m/s2."""
        speed = from_mps
        for k in range(round(100 * seconds)):
            speed -= 0.01 * min(0.0025 * k, 0.95)
            output = self.step(speed * wheels + 0.003 * self.noise.standard_normal(4))
        return output


@pytest.mark.parametrize("name", WORKING)
def test_a_frozen_reading_does_not_hold_the_reference_up(name: str) -> None:
    """One axle goes on reading 30 m/s while the train brakes: no brake is lost to it."""
    bench = Bench(name)
    bench.roll([30.0] * 4, 2.0)
    frozen = 30.0
    speed = 30.0
    for k in range(1500):
        speed -= 0.01 * min(0.0025 * k, 0.95)
        speeds = speed + 0.003 * bench.noise.standard_normal(4)
        speeds[1] = frozen
        output = bench.step(speeds)
    assert output.reference_speed_mps == pytest.approx(speed, abs=0.2)
    assert (np.array(bench.valves)[-1000:] == FILL).mean() > 0.95


@pytest.mark.parametrize("name", WORKING)
@pytest.mark.parametrize("factor", [1.25, 0.8])
def test_a_wrong_tooth_count_is_found_while_rolling(name: str, factor: float) -> None:
    """It is left out after a second and does no harm to a stop; put right, it is believed again."""
    wrong = np.array([1.0, 1.0, factor, 1.0])
    bench = Bench(name)
    assert bench.roll(25.0 * wrong, 2.0).reference_speed_mps == pytest.approx(25.0, abs=0.1)
    bench.brake(25.0, 6.0, wrong)
    assert (np.array(bench.valves) == FILL).all()
    right = Bench(name)
    right.roll(25.0 * wrong, 2.0)
    right.roll([25.0] * 4, 2.0)
    for one, vented in ((bench, False), (right, True)):  # now the third axle slides away at 8 m/s2
        start = 25.0 if one is right else 21.1
        codes = []
        for k in range(50):
            speeds = start - np.array([0.0, 0.0, 0.08 * k, 0.0]) + 0.003 * one.noise.standard_normal(4)
            codes.append(one.step(speeds).valve[2])
        assert (VENT in codes) == vented


@pytest.mark.parametrize("name", ["slip-tracking", "adaptive"])
def test_wheels_that_roll_without_their_brake_show_who_lies(name: str) -> None:
    """While braking the fourth axle starts to read a quarter too much: the others empty, roll on, and are believed."""
    bench = Bench(name)
    bench.roll([25.0] * 4, 2.0)
    bench.roll([25.0, 25.0, 25.0, 23.0], 0.3, demand=1.0)  # comes under control
    bench.roll([25.0] * 4, 1.0, demand=1.0)
    output = bench.roll([25.0, 25.0, 25.0, 31.25], 4.0, demand=1.0)
    assert output.reference_speed_mps == pytest.approx(25.0, abs=0.3)
    assert VENT in np.array(bench.valves)[-400:-300, :3]
    output = bench.roll([25.0, 25.0, 25.0, 31.25], 4.0, demand=1.0)
    assert (np.array(bench.valves)[-200:, :3] == FILL).mean() > 0.5


@pytest.mark.parametrize("name", WORKING)
def test_a_blind_axle_is_vented_with_its_neighbour_and_filled_less(name: str) -> None:
    bench = Bench(name)
    bench.roll([20.0] * 4, 1.0)
    valid = np.array([True, True, True, False])
    fills = np.zeros(2)
    for k in range(1500):
        slip = 3.0 * max(0.0, np.sin(0.05 * k))
        output = bench.step(np.array([20.0, 20.0, 20.0 - slip, 0.0]), valid=valid)
        if output.valve[2] == VENT:
            assert output.valve[3] == VENT
        fills += output.valve[2:] == FILL
        assert (output.valve[:2] == FILL).all()
    assert 0.2 < fills[1] / fills[0] < 0.65


def test_wheels_left_out_do_not_count_in_the_comparison() -> None:
    ratio = np.ones(4)
    speeds = np.array([20.2, 19.8, 20.0, 31.0])
    compare_wheels(ratio, speeds, np.array([True, True, True, False]), 1.0, 0.04)
    assert ratio == pytest.approx([1.01, 0.99, 1.0, 1.0])
    compare_wheels(ratio, speeds, ALL_VALID, 1.0, 0.04)  # one differs by more than wear: nothing is learnt
    assert ratio == pytest.approx([1.01, 0.99, 1.0, 1.0])


@pytest.mark.parametrize("name", WORKING)
@pytest.mark.parametrize(("source", "expected"), [("mean-of-axles", 19.5), ("fastest-axle", 20.0)])
def test_the_reference_goes_by_what_its_source_says(name: str, source: str, expected: float) -> None:
    """Unbraked and new to it all, three axles at 20 m/s and one that drags at 18."""
    bench = Bench(name, reference={"source": source})
    speeds = np.array([20.0, 18.0, 20.0, 20.0])
    assert bench.step(speeds).reference_speed_mps == pytest.approx(expected)


def test_only_axle_release_relieves_an_axle() -> None:
    """All axles slide alike, 5 % below where they should be: one after the other is vented to see, or none is."""
    vents = {}
    for source in ("fastest-axle", "axle-release"):
        bench = Bench("rule-table", reference={"source": source})
        bench.roll([20.0] * 4, 1.0)
        for k in range(1500):  # the first slides away for good, the others a little, and evenly
            speed = 20.0 - 0.001 * min(k, 400) - 0.003 * k
            speeds = np.array([speed - min(0.06 * k, 6.0), speed, speed, speed])
            bench.step(speeds + 0.003 * bench.noise.standard_normal(4))
        vents[source] = (np.array(bench.valves)[:, 1:] == VENT).any(axis=0)
    assert not vents["fastest-axle"].any()
    assert vents["axle-release"].any()


@pytest.mark.parametrize("name", WORKING)
def test_a_sliding_axle_is_relieved_while_the_brakes_release(name: str) -> None:
    """The demand is gone, the pressure not yet: 15..20 s; later a slow axle is none of the brake's business."""
    bench = Bench(name)
    bench.roll(np.full(4, 30.0), 6.0)
    bench.roll(np.full(4, 30.0), 1.0, demand=1.0)
    seen = len(bench.valves)
    bench.roll([30.0, 30.0, 22.0, 30.0], 1.0)
    assert (np.array(bench.valves[seen:])[:, 2] == VENT).any()
    bench.roll(np.full(4, 30.0), 25.0)
    seen = len(bench.valves)
    bench.roll([30.0, 30.0, 22.0, 30.0], 1.0)
    assert (np.array(bench.valves[seen:]) == FILL).all()
