"""Tachometers that fail in the run: what the front end then says, and how it comes back."""

import math

import numpy as np
import pytest

from sensors import TachometerParameters, Tachometers

RADIUS_M = 0.46
EXACT = TachometerParameters(pitch_error_share=0.0, eccentricity_share=0.0, hysteresis_share=0.0)
RATES = np.array([40.0, 41.0, 42.0, 43.0])


class Rolling:
    """Four wheels that slow down at 4 rad/s2, and their tachometers."""

    def __init__(self) -> None:
        self.tachometers = Tachometers(EXACT, np.random.default_rng(1))
        self.ticks = 0

    def on(self, ticks: int) -> None:
        """So many ticks on."""
        for _ in range(ticks):
            t = 0.01 * self.ticks
            self.tachometers.advance(t, RATES * t - 2.0 * t * t, RATES - 4.0 * t)
            self.ticks += 1

    @property
    def true_mps(self) -> np.ndarray:
        return RADIUS_M * (RATES - 0.04 * (self.ticks - 1))


def test_a_lost_tachometer_is_not_valid_and_gives_no_edges_until_it_is_back() -> None:
    wheels = Rolling()
    wheels.on(50)
    wheels.tachometers.lose(1)
    wheels.on(50)
    speeds, valid = wheels.tachometers.axle_speed_mps, wheels.tachometers.valid
    assert valid.tolist() == [True, False, True, True]
    assert speeds[1] == 0.0
    assert speeds[[0, 2, 3]] == pytest.approx(wheels.true_mps[[0, 2, 3]], abs=0.02)
    wheels.tachometers.restore(1)

    wheels.on(3)
    assert wheels.tachometers.valid.all()
    assert wheels.tachometers.axle_speed_mps == pytest.approx(wheels.true_mps, abs=0.02)
    readings = wheels.tachometers.readings()
    silent = (readings.wheelset == 2) & (readings.t_s > 0.495) & (readings.t_s < 0.985)
    assert not silent.any()
    assert ((readings.wheelset == 1) & (readings.t_s > 0.5) & (readings.t_s < 0.99)).sum() > 200


def test_a_frozen_tachometer_repeats_itself_as_valid() -> None:
    wheels = Rolling()
    wheels.on(50)
    before = wheels.tachometers.axle_speed_mps.copy()
    wheels.tachometers.freeze(0)
    wheels.on(60)
    assert wheels.tachometers.valid.all()
    assert wheels.tachometers.axle_speed_mps[0] == before[0]
    assert wheels.tachometers.axle_speed_mps[1] < before[1] - 0.5
    wheels.tachometers.restore(0)
    wheels.on(4)
    assert wheels.tachometers.valid.all()
    assert wheels.tachometers.axle_speed_mps == pytest.approx(wheels.true_mps, abs=0.02)


@pytest.mark.parametrize(("belief", "factor"), [({"teeth": 80}, 100.0 / 80.0), ({"radius_m": 0.425}, 0.425 / RADIUS_M)])
def test_a_wrong_belief_scales_the_speed(belief: dict[str, float], factor: float) -> None:
    wheels = Rolling()
    wheels.on(50)
    wheels.tachometers.believe(2, **belief)  # type: ignore[arg-type]
    wheels.on(50)
    expected = wheels.true_mps * np.array([1.0, 1.0, factor, 1.0])
    assert wheels.tachometers.axle_speed_mps == pytest.approx(expected, abs=0.03)
    wheels.tachometers.believe(2)
    wheels.on(2)
    assert wheels.tachometers.axle_speed_mps == pytest.approx(wheels.true_mps, abs=0.02)


def test_edges_of_the_other_wheels_do_not_know_of_the_fault() -> None:
    sound, failing = Rolling(), Rolling()
    for wheels in (sound, failing):
        wheels.on(30)
    failing.tachometers.lose(3)
    for wheels in (sound, failing):
        wheels.on(30)
    edges = [wheels.tachometers.readings() for wheels in (sound, failing)]
    for wheelset in (1, 2, 3):
        both = [readings.t_s[readings.wheelset == wheelset] for readings in edges]
        np.testing.assert_array_equal(both[0], both[1])
    assert math.isclose(edges[1].t_s[edges[1].wheelset == 4].max(), 0.29, abs_tol=0.01)


def test_a_slow_wheel_that_is_back_does_not_read_as_locked() -> None:
    """At 2 m/s edges come rarely: no valid zero before the first of them."""
    tachometers = Tachometers(EXACT, np.random.default_rng(1))
    rate = np.full(4, 2.0 / RADIUS_M)
    read = []
    for k in range(300):
        if k == 100:
            tachometers.lose(0)
        if k == 200:
            tachometers.restore(0)
        tachometers.advance(0.01 * k, 0.01 * k * rate, rate)
        read.append((tachometers.valid[0], tachometers.axle_speed_mps[0]))
    back = read[200:]
    assert all(speed == pytest.approx(2.0, abs=0.05) for valid, speed in back if valid)
    assert back[-1][0]
