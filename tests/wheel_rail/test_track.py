"""The line against closed forms: clothoids, circles, vertical curves, cant."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from wheel_rail import Track, TrackParameters
from wheel_rail.track import track_frame

CURVED = TrackParameters.model_validate(
    {
        "length_m": 2500.0,
        "curves": [{"start_m": 300.0, "transition_m": 100.0, "length_m": 400.0, "radius_m": 1200.0, "cant_mm": 100.0}],
        "gradients": [{"from_m": 1200.0, "gradient_permille": -5.0, "rounding_m": 100.0}],
    }
)
TRACK = Track(CURVED)


def frame_at(track: Track, s_m: float) -> np.ndarray:
    frame = np.empty(14)
    track_frame(s_m, track.origin_m, track.table, frame)
    return frame


def test_transition_moves_the_track_by_its_closed_form() -> None:
    """A clothoid of length L to radius R: lateral offset L^2/(6 R) (1 - L^2/(56 R^2) ..), heading L/(2 R)."""
    length, radius = 100.0, 1200.0
    end = frame_at(TRACK, 400.0)
    assert end[1] == pytest.approx(length**2 / (6 * radius) * (1 - length**2 / (56 * radius**2)), rel=1e-6)
    assert end[0] == pytest.approx(400.0 - length**3 / (40 * radius**2), abs=1e-5)
    assert np.arctan2(end[4], end[3]) == pytest.approx(length / (2 * radius), rel=1e-9)


def test_heading_after_the_curve_is_the_integral_of_curvature() -> None:
    after = frame_at(TRACK, 950.0)
    assert np.arctan2(after[4], after[3]) == pytest.approx((100.0 + 400.0) / 1200.0, rel=1e-10)


def test_height_after_the_vertical_curve() -> None:
    slope = np.sin(np.arctan(0.005))
    assert frame_at(TRACK, 1250.0)[2] - frame_at(TRACK, 2000.0)[2] == pytest.approx(750.0 * slope, rel=1e-9)
    assert frame_at(TRACK, 1150.0)[2] == pytest.approx(0.0, abs=1e-9)
    assert TRACK.gradient_permille(np.array([1100.0, 1200.0, 1300.0])) == pytest.approx([0.0, -2.5, -5.0])


def test_cant_raises_the_right_rail_in_a_left_curve() -> None:
    middle = frame_at(TRACK, 600.0)
    left = middle[6:9]
    assert left[2] == pytest.approx(-0.1 / 1.5, rel=1e-9)  # the left rail lies lower
    assert TRACK.cant_mm(np.array([600.0, 350.0])) == pytest.approx([100.0, 50.0], rel=1e-3)
    assert TRACK.curvature_radpm(np.array([600.0]))[0] == pytest.approx(1 / 1200.0)


@settings(max_examples=200, deadline=None)
@given(st.floats(-20.0, 2520.0))
def test_frame_is_a_right_handed_frame_along_the_line(s_m: float) -> None:
    frame = frame_at(TRACK, s_m)
    axes = frame[3:12].reshape(3, 3)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    step = 1e-3
    moved = (frame_at(TRACK, s_m + step) - frame_at(TRACK, s_m - step))[:3] / (2 * step)
    assert moved == pytest.approx(axes[0], abs=2e-6)


def test_sixty_kilometres_lose_no_precision() -> None:
    """A long line of curves to either side in turn: the heading comes back to zero, and s is arc length."""
    curves = [
        {"start_m": 100.0 + 1000.0 * k, "transition_m": 80.0, "length_m": 300.0, "radius_m": (-1.0) ** k * 900.0}
        for k in range(58)
    ]
    track = Track(TrackParameters.model_validate({"length_m": 60_000.0, "curves": curves}))
    end = frame_at(track, 59_900.0)
    assert end[3:6] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    chord = np.diff(track.table[:, :3], axis=0)
    assert np.linalg.norm(chord, axis=1) == pytest.approx(np.ones(len(chord)), abs=1e-6)


BAD = [
    ({"length_m": -1.0}, "greater than 0"),
    ({"length_m": float("nan")}, "finite"),
    ({"length_m": 1000.0, "curves": [{"start_m": 0, "transition_m": 50, "length_m": 100, "radius_m": 60}]}, "80 m"),
    (
        {
            "length_m": 1000.0,
            "curves": [{"start_m": 0, "transition_m": 50, "length_m": 100, "radius_m": 600, "cant_mm": 210}],
        },
        "200 mm",
    ),
    (
        {
            "length_m": 1000.0,
            "curves": [
                {"start_m": 0, "transition_m": 50, "length_m": 100, "radius_m": 600},
                {"start_m": 150, "transition_m": 50, "length_m": 100, "radius_m": -600},
            ],
        },
        "overlaps",
    ),
    ({"length_m": 1000.0, "gradients": [{"from_m": 10.0, "gradient_permille": 5.0, "rounding_m": 100.0}]}, "overlaps"),
    ({"length_m": 200.0, "curves": [{"start_m": 100, "transition_m": 50, "length_m": 100, "radius_m": 600}]}, "beyond"),
    ({"length_m": 200.0, "gradient": 3}, "Extra inputs"),
]


@pytest.mark.parametrize(("values", "message"), BAD)
def test_bad_lines_are_refused_with_the_reason(values: dict, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        TrackParameters.model_validate(values)
