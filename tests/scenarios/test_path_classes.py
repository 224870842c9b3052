"""Shares of a path's classes against closed forms."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from scenarios.path_classes import class_shares, path_figures
from scenarios.truth import Truth

MakeTruth = Callable[..., Truth]
Changed = Callable[..., Any]


def test_shares_of_a_ramp() -> None:
    """|x| over -1..3, evenly: a quarter below 0.5, 3/8 up to 1.5 and 3/8 above; any weight counts."""
    x = np.linspace(-1.0, 3.0, 40_001)
    assert class_shares(x, (0.5, 1.5), np.ones_like(x)) == pytest.approx((25.0, 37.5, 37.5), abs=0.01)
    weight = np.where(x > 1.5, 1.0, 0.0)
    assert class_shares(x, (0.5, 1.5), weight) == (0.0, 0.0, 100.0)
    assert sum(class_shares(x, (0.5, 1.5), np.abs(np.sin(x)))) == pytest.approx(100.0)


def test_what_stands_on_a_border_is_of_the_class_between() -> None:
    assert class_shares(np.array([50.0, 150.0, 49.9, 150.1]), (50.0, 150.0), np.ones(4)) == (25.0, 50.0, 25.0)


def test_speed_classes_of_a_stop_by_time_and_by_distance(make_truth: MakeTruth) -> None:
    """From 50 m/s with 0.5 m/s2 after 10 s, standing for a second at the end."""
    v, a, held = 50.0, 0.5, 10.0
    figures = path_figures(make_truth(initial_speed_mps=v, deceleration_mps2=a, brake_at_s=held))
    low, high = 50.0 / 3.6, 150.0 / 3.6
    time = held + v / a + 1.0
    way = v * held + v * v / (2.0 * a)
    assert figures.length_km == pytest.approx(way / 1000.0, rel=1e-4)
    by_time = ((low / a + 1.0) / time, (high - low) / a / time, (held + (v - high) / a) / time)
    assert figures.by_time.speed == pytest.approx([100.0 * share for share in by_time], abs=0.02)
    below, up_to = low * low / (2.0 * a) / way, high * high / (2.0 * a) / way
    assert figures.by_distance.speed == pytest.approx(
        [100.0 * below, 100.0 * (up_to - below), 100.0 * (1.0 - up_to)], abs=0.02
    )


def test_yaw_rate_slope_and_adhesion_of_their_places(make_truth: MakeTruth, changed: Changed) -> None:
    """Half the time at constant speed turns and climbs; the last third of the rows is slippery."""
    truth = make_truth(initial_speed_mps=20.0, deceleration_mps2=20.0, brake_at_s=100.0)
    motion, wheelsets = truth.motion, truth.wheelsets
    rows = len(motion)
    rate = np.zeros((rows, 3))
    rate[: rows // 2, 2] = -0.011  # to the right counts like to the left
    rate[rows // 2 : 3 * rows // 4, 2] = 0.001
    gradient = np.where(np.arange(rows) < rows // 4, -30.0, np.where(np.arange(rows) < rows // 2, 10.0, 0.0))
    peak = np.full((rows, 4), 0.3)
    peak[2 * rows // 3 :] = 0.1
    truth = changed(
        truth,
        motion=changed(motion, angular_rate_radps=rate, gradient_permille=gradient),
        wheelsets=changed(wheelsets, peak_adhesion=peak),
    )
    figures = path_figures(truth)
    assert figures.by_time.yaw_rate == pytest.approx((25.0, 25.0, 50.0), abs=0.1)
    assert figures.by_time.slope == pytest.approx((50.0, 25.0, 25.0), abs=0.1)
    assert figures.by_time.degraded == pytest.approx(100.0 / 3.0, abs=0.1)
    # the last two seconds are braking and standstill
    way = motion.position_m[-1]
    assert figures.by_distance.degraded == pytest.approx(
        100.0 * (way - motion.position_m[2 * rows // 3]) / way, abs=0.1
    )
    assert figures.by_distance.degraded < 33.0


def test_degraded_phases_and_how_far_they_slide(make_truth: MakeTruth, changed: Changed) -> None:
    """Driven from 2 to 8 s with 8 % of spin, braked from 10 s on with 12 % at the third axle; 0.08 is offered."""
    slip = np.array([0.01, 0.02, 0.12, 0.03])
    truth = make_truth(initial_speed_mps=30.0, brake_at_s=10.0, slip=slip)
    t_s = truth.motion.t_s
    driven = (t_s >= 2.0) & (t_s < 8.0)
    wheelsets = changed(
        truth.wheelsets,
        drive_torque_nm=np.where(driven[:, None], 1000.0, 0.0) * np.ones(4),
        slip=truth.wheelsets.slip - np.where(driven[:, None], 0.08, 0.0),
    )
    traction, braking = path_figures(changed(truth, wheelsets=wheelsets)).phases
    assert (traction.kind, braking.kind) == ("traction", "braking")
    assert (traction.from_s, traction.to_s) == pytest.approx((2.0, 8.0), abs=0.02)
    assert traction.largest_slip == pytest.approx([0.08] * 4)
    assert braking.from_m == pytest.approx(300.0, abs=0.5)
    assert braking.largest_slip == pytest.approx(slip)
    good = changed(wheelsets, peak_adhesion=np.full_like(wheelsets.peak_adhesion, 0.3))
    assert path_figures(changed(truth, wheelsets=good)).phases == ()


def test_slip_below_ten_kmh_does_not_count(make_truth: MakeTruth, changed: Changed) -> None:
    truth = make_truth(slip=0.02)
    slow = truth.motion.speed_mps < 2.5
    slip = np.where(slow[:, None], 1.0, truth.wheelsets.slip)
    (braking,) = path_figures(changed(truth, wheelsets=changed(truth.wheelsets, slip=slip))).phases
    assert braking.largest_slip == pytest.approx([0.02] * 4)
