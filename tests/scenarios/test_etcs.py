"""The limits against the figures of Subset-041 as the reference page gives them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.etcs import distance_limit_m, speed_limit_kmh


@pytest.mark.parametrize(
    ("speed_kmh", "limit_kmh"), [(0, 2.0), (30, 2.0), (100, 3.49), (160, 4.77), (300, 7.74), (500, 12.0)]
)
def test_speed_limit_at_published_speeds(speed_kmh: float, limit_kmh: float) -> None:
    assert float(speed_limit_kmh(speed_kmh)) == pytest.approx(limit_kmh, abs=0.005)


def test_distance_limit_is_5_m_and_5_percent() -> None:
    assert distance_limit_m([0.0, 100.0, 1000.0]) == pytest.approx([5.0, 10.0, 55.0])


@given(st.floats(-600, 600), st.floats(-600, 600))
def test_speed_limit_never_falls_with_speed_and_ignores_direction(one: float, other: float) -> None:
    slower, faster = sorted((abs(one), abs(other)))
    assert speed_limit_kmh(slower) <= speed_limit_kmh(faster)
    assert np.array_equal(speed_limit_kmh(one), speed_limit_kmh(-one))
