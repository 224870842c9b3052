"""The line against closed forms: clothoids, circles, vertical curves, cant."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from wheel_rail import Track, TrackParameters
from wheel_rail.lanes import LANES
from wheel_rail.track_frame import FRAME_ROWS, track_frame, track_frames

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


def test_the_frames_of_a_coach_are_those_of_each_of_its_places() -> None:
    """In transitions, curves and gradients, on the line and beyond its ends; further lanes follow the last place."""
    rng = np.random.default_rng(4)
    frames = np.empty((FRAME_ROWS, LANES))
    for centre in (-60.0, 5.0, 340.0, 600.0, 1210.0, 2490.0, 2600.0):
        places = centre + rng.uniform(-12.0, 12.0, LANES)
        track_frames(places, 5, TRACK.origin_m, TRACK.table, frames)
        alone = np.array([frame_at(TRACK, s) for s in places[[0, 1, 2, 3, 4, 4, 4, 4]]])
        each = frames.T
        assert each == pytest.approx(alone, rel=1e-13, abs=1e-13)


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


def with_curve(**values: object) -> dict:
    usual = {"start_m": 100.0, "transition_m": 60.0, "length_m": 100.0, "radius_m": 600.0, "cant_mm": 60.0}
    curve = {key: value for key, value in {**usual, **values}.items() if value is not None}
    return {"length_m": 1000.0, "curves": [curve]}


def with_gradients(*changes: dict) -> dict:
    return {"length_m": 1000.0, "gradients": list(changes)}


BAD = [
    ({"length_m": -1.0}, "greater than 0"),
    ({"length_m": float("nan")}, "finite"),
    ({"length_m": 200.0, "gradient": 3}, "Extra inputs"),
    (with_curve(radius_m=-79.0), "radius_m = -79.0: the tightest curve allowed is 80 m"),
    (with_curve(cant_mm=-201.0), "cant_mm = -201.0: at most 200 mm"),
    (with_curve(length_m=None), "length_m: either it .* or end_m"),
    (with_curve(end_m=400.0), "length_m: either it .* or end_m"),
    (with_curve(length_m=None, end_m=210.0), r"end_m = 210.0: the transitions, 60 \+ 60 m, are longer than the curve"),
    (with_curve(transition_m=None), "transition_m: it, or both"),
    (with_curve(transition_m=None, transition_in_m=50.0), "transition_m: it, or both"),
    (with_curve(transition_in_m=50.0), "transition_m"),
    (with_curve(transition_m=0.0), "greater than 0"),
    (with_curve(transition_kind="wiener"), "'clothoid', 'bloss' or 'cosine'"),
    (with_curve(transition_m=20.0, cant_mm=150.0), r"cant_mm = 150.0: its ramp in, 20 m, is too steep: 7.50 mm/m"),
    (with_curve(cant_mm=180.0, cant_ramp_out_m=30.0), "its ramp out, 30 m, is too steep"),
    (with_curve(transition_kind="cosine", cant_mm=200.0), "its ramp in, 60 m, is too steep: 5.24 mm/m"),
    (with_curve(start_m=10.0, cant_ramp_in_m=80.0), "begins at -10 and overlaps the begin of the line"),
    (with_curve(start_m=800.0), "curves: reach to 1020.0 m, beyond length_m = 1000.0"),
    (
        {
            "length_m": 1000.0,
            "curves": [
                {"start_m": 0, "transition_m": 50, "length_m": 100, "radius_m": 600},
                {"start_m": 150, "transition_m": 50, "length_m": 100, "radius_m": -600},
            ],
        },
        r"curves.1.start_m = 150.0: .* overlaps the curve before, which ends at 200",
    ),
    (with_gradients({"from_m": 10.0, "gradient_permille": 5.0, "rounding_m": 100.0}), "from_m = 10.0: .*overlaps"),
    (with_gradients({"from_m": 500.0, "gradient_permille": 101.0}), "less than or equal to 100"),
    (
        with_gradients({"from_m": 500.0, "gradient_permille": 30.0, "rounding_m": 8.0}),
        "gradients.0.rounding_m = 8: too short for a change of 30 per mille: its radius is 267 m, at least 300",
    ),
    (
        with_gradients({"from_m": 500.0, "gradient_permille": 30.0, "vertical_radius_m": 200.0}),
        "greater than or equal to 300",
    ),
    (
        with_gradients({"from_m": 500.0, "gradient_permille": 3.0, "vertical_radius_m": 900.0, "rounding_m": 5.0}),
        "rounding_m: either it or vertical_radius_m",
    ),
    (
        with_gradients(
            {"from_m": 500.0, "gradient_permille": 5.0, "rounding_m": 100.0},
            {"from_m": 560.0, "gradient_permille": 0.0, "rounding_m": 50.0},
        ),
        "gradients.1.from_m = 560.0: its vertical curve overlaps the one before",
    ),
    (with_gradients({"from_m": 990.0, "gradient_permille": 5.0}), "gradients: reach to 1015.0 m, beyond"),
]


@pytest.mark.parametrize(("values", "message"), BAD)
def test_bad_lines_are_refused_with_the_reason(values: dict, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        TrackParameters.model_validate(values)


CURVES_CSV = """\
# measured in the spring
start_m,end_m,radius_m,transition_in_m,transition_out_m,transition_kind,cant_mm

250,900,1200,100,80,bloss,100
1000, 1500, -800, 60, 60, , 80
"""
GRADIENTS_CSV = "from_m,gradient_permille,rounding_m,vertical_radius_m\n1200,-5,100,\n1700,2,,9000\n"


def test_a_line_from_files_is_the_same_line(tmp_path: Path) -> None:
    (tmp_path / "curves.csv").write_text(CURVES_CSV, encoding="utf-8")
    (tmp_path / "gradients.csv").write_text(GRADIENTS_CSV, encoding="utf-8-sig")
    files = {"curves_file": str(tmp_path / "curves.csv"), "gradients_file": str(tmp_path / "gradients.csv")}
    written = {
        "curves": [
            {"start_m": 250.0, "end_m": 900.0, "radius_m": 1200.0, "transition_in_m": 100.0, "transition_out_m": 80.0,
             "transition_kind": "bloss", "cant_mm": 100.0},
            {"start_m": 1000.0, "end_m": 1500.0, "radius_m": -800.0, "transition_in_m": 60.0,
             "transition_out_m": 60.0, "cant_mm": 80.0},
        ],
        "gradients": [
            {"from_m": 1200.0, "gradient_permille": -5.0, "rounding_m": 100.0},
            {"from_m": 1700.0, "gradient_permille": 2.0, "vertical_radius_m": 9000.0},
        ],
    }  # fmt: skip
    read = TrackParameters.model_validate({"length_m": 2500.0, **files})
    assert read == TrackParameters.model_validate({"length_m": 2500.0, **written})
    assert read.curves_file is None  # what was read stands for itself
    assert TrackParameters.model_validate_json(read.model_dump_json(), strict=True) == read


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty; its first line must name the columns"),
        ("start_m,radius\n", "unknown column 'radius'; known here: start_m, "),
        ("start_m,start_m\n", "a column stands there twice"),
        (CURVES_CSV.replace("1200,100", "1200"), "line 4: 6 cells, 7 columns"),
        (CURVES_CSV.replace("1200", "twelve"), "line 4: radius_m = 'twelve': Input should be a valid number"),
        (CURVES_CSV.replace("1200", "60"), "line 4: radius_m = 60.0: the tightest curve allowed is 80 m"),
        (CURVES_CSV.replace("-800", "nan"), "line 5: radius_m = 'nan': .*finite"),
        (CURVES_CSV.replace("250,", ","), "line 4: start_m: Field required"),
        (CURVES_CSV.replace("1000,", "800,"), "curves.1.start_m = 800.0: .* overlaps the curve before"),
    ],
)
def test_bad_files_are_refused_with_file_and_line(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "bad.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValidationError, match=message) as refusal:
        TrackParameters.model_validate({"length_m": 2500.0, "curves_file": str(file)})
    assert f"curves_file = {file}" in str(refusal.value)


def test_a_file_in_vain_or_besides_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValidationError, match=r"gradients_file = .*none.csv: cannot be read"):
        TrackParameters.model_validate({"length_m": 100.0, "gradients_file": str(tmp_path / "none.csv")})
    with pytest.raises(ValidationError, match="leave out curves .*, or the file"):
        TrackParameters.model_validate({"curves_file": "line.csv", **with_curve()})
