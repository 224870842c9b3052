"""The reference speed: follows the fastest axle, not wheels that slide together, and recovers when one grips."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from wsp.reference_speed import ReferenceSpeedParameters, reference_after

P = ReferenceSpeedParameters()
LIMITS = (P.fall_limit_mps2, P.jerk_decline_mps3, P.jerk_gain_ps2, P.rise_limit_mps2)
WIDE = (P.fall_margin_mps2, P.jerk_limit_mps3)
NARROW = (P.fall_margin_at_work_mps2, P.jerk_limit_at_work_mps3)


def follow(fastest_mps: np.ndarray, start: tuple[float, float], limits: tuple[float, float]) -> np.ndarray:
    speed, deceleration = start
    out = []
    for v in fastest_mps:
        speed, deceleration = reference_after(speed, deceleration, v, 0.01, *limits, LIMITS)
        out.append((speed, deceleration))
    return np.array(out)


def test_a_full_service_application_on_dry_rail_is_followed() -> None:
    t = np.arange(0.0, 20.0, 0.01)
    deceleration = np.minimum(0.25 * t, 1.0)
    speed = 33.3 - np.cumsum(deceleration) * 0.01
    found = follow(speed, (33.3, 0.0), WIDE)
    assert np.abs(found[:, 0] - speed).max() < 0.05
    assert found[-1, 1] == pytest.approx(1.0, abs=0.1)


def test_wheels_that_slide_together_do_not_take_it_down() -> None:
    """Four wheels fall at 3 m/s2 for 2 s while the train brakes at 0.6: a fixed limit of 1.8 would lose 2.4 m/s."""
    t = np.arange(0.01, 2.0, 0.01)
    found = follow(20.0 - 3.0 * t, (20.0, 0.6), NARROW)
    error = found[-1, 0] - (20.0 - 0.6 * t[-1])
    assert -0.25 < error < 0.0


def test_an_axle_that_grips_puts_it_right() -> None:
    low = follow(np.full(50, 19.0), (18.0, 0.8), NARROW)
    np.testing.assert_array_less(18.99, low[30:, 0])
    assert low[-1, 1] < 0.8


def test_a_wild_pulse_moves_it_by_the_rise_limit_only() -> None:
    speed, _ = reference_after(20.0, 0.0, 60.0, 0.01, *WIDE, LIMITS)
    assert speed == pytest.approx(20.0 + 0.01 * P.rise_limit_mps2)


def test_without_an_axle_it_is_dead_reckoning() -> None:
    found = follow(np.full(100, np.nan), (20.0, 0.5), NARROW)
    assert found[-1] == pytest.approx((19.5, 0.5))


@given(st.floats(0.0, 80.0), st.floats(-1.8, 1.8), st.floats(0.0, 80.0))
def test_limits_hold_for_any_speed(speed: float, deceleration: float, fastest: float) -> None:
    for limits in (WIDE, NARROW):
        after, learned = reference_after(speed, deceleration, fastest, 0.01, *limits, LIMITS)
        assert after >= 0.0
        assert abs(learned) <= P.fall_limit_mps2
        predicted = speed - 0.01 * deceleration
        assert max(0.0, predicted - 0.01 * limits[0]) - 1e-12 <= after <= max(0.0, predicted + 0.01 * P.rise_limit_mps2)


def test_parameters_are_checked() -> None:
    with pytest.raises(ValidationError, match="fall_limit_mps2"):
        ReferenceSpeedParameters(fall_limit_mps2=-1.0)
