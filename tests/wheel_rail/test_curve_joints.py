"""Curves that join the one before, as given: what does not fit together is refused, and CSV files."""

import re
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from wheel_rail import Track, TrackParameters


def line(length_m: float, curves: list[dict]) -> TrackParameters:
    return TrackParameters.model_validate({"length_m": length_m, "curves": curves})


COMPOUND = [
    {"start_m": 100.0, "transition_in_m": 80.0, "length_m": 150.5, "radius_m": 600.0, "cant_mm": 120.0},
    {"start_m": 330.5, "joins_previous": True, "transition_m": 60.0, "length_m": 100.0, "radius_m": 400.0,
     "cant_mm": 150.0},
]  # fmt: skip


def changed(first: dict | None = None, second: dict | None = None) -> list[dict]:
    curves = [{**c, **(values or {})} for c, values in zip(COMPOUND, (first, second), strict=True)]
    return [{key: value for key, value in c.items() if value is not None} for c in curves]


BAD = [
    (changed({"joins_previous": True}), r"curves.0.joins_previous = true: there is no curve before the first"),
    (changed(second={"joins_previous": False}), "curves.0.transition_m: it, or both .* alone where the next curve has"),
    (COMPOUND[:1], "curves.0.transition_m: it, or both"),
    (
        changed({"transition_out_m": 70.0}),
        "curves.1.joins_previous = true: the curve before has a transition out, 70 m long",
    ),
    (changed({"transition_in_m": None, "transition_m": 80.0}), "curves.1.joins_previous = true: .* out, 80 m long"),
    (changed({"cant_ramp_out_m": 90.0}), "curves.1.joins_previous = true: .* has cant_ramp_out_m = 90.0; leave it out"),
    (
        changed(second={"start_m": 340.5}),
        "curves.1.start_m = 340.5: a gap of 10 m; .* must begin where the circular part of that ends, at 330.5$",
    ),
    (changed(second={"start_m": 330.25}), "curves.1.start_m = 330.25: overlaps by 0.25 m; .* at 330.5$"),
    (
        changed(second={"radius_m": -400.0, "cant_mm": -190.0}),
        "curves.1.cant_mm = -190.0: its ramp in from the 120 mm before, 60 m, is too steep: 5.17 mm/m",
    ),
    (changed(second={"transition_kind": "cosine", "cant_mm": -80.0}), "curves.1.cant_mm = -80.0: .* 5.24 mm/m"),
    (changed(second={"cant_ramp_out_m": 20.0}), "curves.1 .*cant_mm = 150.0: its ramp out, 20 m, is too steep"),
    (changed(second={"cant_mm": 210.0}), "cant_mm = 210.0: at most 200 mm"),
    (
        changed(second={"cant_ramp_in_m": 211.0}),
        "curves.1.cant_ramp_in_m = 211.0: begins at 179.5, where the curve before .*; at most 210.5",
    ),
    (changed(second={"joins_previous": "maybe"}), "joins_previous"),
    (changed(second={"transition_m": None, "transition_out_m": 60.0}), "transition_m: it, or both"),
    (changed(second={"transition_m": None, "transition_in_m": 60.0}), "curves.1.transition_m: it, or both"),
    (changed(second={"length_m": 500.0}), "curves: reach to 950.5 m, beyond length_m = 900"),
]


@pytest.mark.parametrize(("curves", "message"), BAD)
def test_bad_joints_are_refused_with_the_reason(curves: list[dict], message: str) -> None:
    with pytest.raises(ValidationError) as refusal:
        line(900.0, curves)
    (told,) = refusal.value.errors()
    assert re.search(message, f"{'.'.join(map(str, told['loc']))} {told['msg']}")


CSV = """\
start_m,joins_previous,transition_in_m,length_m,transition_out_m,radius_m,cant_mm
100,,80,150.5,,600,120
330.5,true,60,100,60,400,150
"""


def test_joined_curves_from_a_file_are_the_same_line(tmp_path: Path) -> None:
    file = tmp_path / "curves.csv"
    file.write_text(CSV, encoding="utf-8")
    read = TrackParameters.model_validate({"length_m": 900.0, "curves_file": str(file)})
    written = line(900.0, changed(second={"transition_m": None, "transition_in_m": 60.0, "transition_out_m": 60.0}))
    assert read == written
    assert [c.joins_previous for c in read.curves] == [False, True]
    assert np.array_equal(Track(read).table, Track(line(900.0, COMPOUND)).table)
    assert TrackParameters.model_validate_json(read.model_dump_json(), strict=True) == read


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (CSV.replace("true", "perhaps"), ", line 3: joins_previous = 'perhaps': Input should be a valid boolean"),
        (CSV.replace("true", ""), ": curves.0.transition_m: it, or both"),
        (CSV.replace("330.5", "331"), ": curves.1.start_m = 331.0: a gap of 0.5 m"),
        (CSV.replace("100,,", "100,true,"), ": curves.0.joins_previous = true: there is no curve before"),
        (CSV.replace("400,150", "-400,-190"), ": curves.1.cant_mm = -190.0: its ramp in"),
    ],
)
def test_bad_joints_in_a_file_are_refused_with_its_name(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "curves.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValidationError) as refusal:
        TrackParameters.model_validate({"length_m": 900.0, "curves_file": str(file)})
    assert f"curves_file = {file}{message}" in str(refusal.value)
