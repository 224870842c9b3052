"""The check of running stability tells quiet running from hunting."""

import pytest

from scenarios.verification.stability import guiding_limit_n, kinked, running
from scenarios.verification.vehicle import coach


def test_limit_of_a_usual_coach() -> None:
    """EN 14363: half of 10 kN and a third of the axle load of 137.3 kN."""
    assert guiding_limit_n(coach()) == pytest.approx(0.5 * (10e3 + 137_340.0 / 3.0))


def test_far_beyond_the_critical_speed_the_coach_hunts() -> None:
    """On the same faults: quiet at 200 km/h, above the limit at 430 km/h, where linear theory has swings that grow."""
    faults = [kinked(600.0)]
    slow, fast = (running("malvezzi-2014", speed_kmh, 600.0, faults) for speed_kmh in (200.0, 430.0))
    print(f"share of the limit {slow.share:.2f} and {fast.share:.2f}")
    assert slow.share < 0.3
    assert fast.share > 1.0
    assert fast.displacement_rms_m[0] > 3.0 * slow.displacement_rms_m[0]
