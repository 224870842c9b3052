"""SCMT: exact while wheels roll, the min/max rule while one slides, blind where both slide alike."""

import numpy as np
import pytest
from numpy.typing import NDArray

from estimators import Initial, Sample, Scmt, ScmtParameters
from estimators.interface import Estimate
from tests.estimators.synthetic_run import alike, drive, etcs_speed_limit_mps, low_adhesion_stop, observe

Array = NDArray[np.float64]


def run_on(first: Array, fourth: Array, initial_mps: float) -> list[Estimate]:
    scmt = Scmt(ScmtParameters())
    scmt.reset(Initial(speed_mps=initial_mps))
    return [
        scmt.step(Sample(0.1 * (k + 1), np.array([a, 0.0, 0.0, b]), np.ones(4, bool), np.zeros(3), np.zeros(3)))
        for k, (a, b) in enumerate(zip(first, fourth, strict=True))
    ]


def test_exact_while_the_wheels_roll() -> None:
    speed = 30.0 - 0.08 * np.arange(300)
    estimates = run_on(speed, speed, 30.0)
    np.testing.assert_allclose([e.speed_mps for e in estimates], speed, rtol=1e-12)
    distance = np.concatenate([[0.1 * 30.0], 3.0 + np.cumsum(0.05 * (speed[1:] + speed[:-1]))])
    np.testing.assert_allclose([e.position_m for e in estimates], distance, rtol=1e-9)


def test_one_sliding_wheel_while_braking_leaves_the_faster_one() -> None:
    good = 30.0 - 0.1 * np.arange(60)
    bad = np.where(np.arange(60) > 20, 0.8 * good, good)
    estimates = run_on(bad, good, 30.0)
    np.testing.assert_allclose([e.speed_mps for e in estimates[22:]], good[22:], rtol=1e-9)


def test_one_spinning_wheel_while_accelerating_leaves_the_slower_one() -> None:
    good = 10.0 + 0.05 * np.arange(60)
    bad = np.where(np.arange(60) > 20, 1.3 * good, good)
    estimates = run_on(bad, good, 10.0)
    np.testing.assert_allclose([e.speed_mps for e in estimates[22:]], good[22:], rtol=1e-9)


def test_both_locking_integrates_the_constant_deceleration_while_it_sees_them_brake() -> None:
    """Wheels that fall by 3 m/s2 exceed da: the speed goes down by 1.2 m/s2; the bounds keep the onset speed."""
    rolling = np.full(31, 30.0) - 0.05 * np.arange(31)
    wheels = np.concatenate([rolling, rolling[-1] - 0.3 * np.arange(1, 31)])
    estimates = run_on(wheels, wheels, 30.0)
    speed = np.array([e.speed_mps for e in estimates])
    np.testing.assert_allclose(np.diff(speed[31:]), -0.12, atol=1e-9)
    assert estimates[-1].speed_upper_mps >= rolling[-1]
    assert estimates[-1].speed_lower_mps <= wheels[-1]


def test_blind_where_all_wheels_slide_alike() -> None:
    run = low_adhesion_stop(alike(62.0, 0.2))
    estimate = run.estimate(Scmt(ScmtParameters()))
    truth = run.at(run.speed_mps, estimate.t_s)
    outside = np.abs(estimate.speed_mps - truth) > etcs_speed_limit_mps(truth)
    assert np.mean(outside[(estimate.t_s > 63.0) & (truth > 5.0)]) > 0.5
    assert not np.any(outside[estimate.t_s < 60.0])


def test_balises_set_the_position() -> None:
    run = observe(drive(80.0, 30.0, lambda t: 0.0), rolling_radius_m=0.455)  # the train believes 0.46 m: 1.1 % too far
    estimate = run.estimate(Scmt(ScmtParameters()))
    error = estimate.position_m - run.at(run.position_m, estimate.t_s)
    assert np.max(error[estimate.t_s < 16.0]) == pytest.approx(0.011 * 480.0, abs=0.7)
    assert np.max(np.abs(error)) < 5.0 + 0.0112 * 1000.0


def test_two_different_wheelsets_are_asked_for() -> None:
    for wrong in ((2, 2), (0, 4), (1, 5)):
        with pytest.raises(ValueError, match="wheelsets"):
            ScmtParameters(wheelsets=wrong)
