"""Peak adhesion read from a file: both rails, linear in between, and every refusal with its line."""

from pathlib import Path

import pytest

from tests.wheel_rail.rail_kinds import adhesion, condition_at, parameters, peak
from wheel_rail.adhesion_state import RailState


def test_fields_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "rail.csv"
    file.write_text("position_m,left,right\n0,0.30,0.20\n400,0.10,0.20\n1000.0,0.10,0.05\n", encoding="utf-8")
    rail = adhesion(parameters({"surface": "dry", "file": str(file)}))
    tables = rail.tables(RailState(1000.0))
    for s_m, left, right in ((0.0, 0.3, 0.2), (200.0, 0.2, 0.2), (400.0, 0.1, 0.2), (700.0, 0.1, 0.125)):
        assert peak(condition_at(tables, s_m)) == pytest.approx(left, rel=2e-4)
        assert peak(condition_at(tables, s_m, side=1)) == pytest.approx(right, rel=2e-4)
    with pytest.raises(ValueError, match=r"rail.csv: position_m reaches from 0 to 1000, but must cover 0 to 2000"):
        adhesion(parameters({"surface": "dry", "file": str(file)}), 2000.0)


BAD_FILES = [
    ("", "line 1: the header must be position_m,left,right, here nothing"),
    ("position_m;left;right\n0;0.1;0.1\n", "line 1: the header must be"),
    ("position_km,left,right\n0,0.1,0.1\n1,0.1,0.1\n", "line 1: the header must be"),
    ("position_m,left,right\n0,0.1,0.1\n", "at least two rows below the header, here 1"),
    ("position_m,left,right\n0,0.1,0.1\n1000,0.1\n", "line 3: must have 3 values, here 2"),
    ("position_m,left,right\n0,0.1,0.1\n1000,0.1,\n", "line 3: right = nothing: must be a finite number"),
    ("position_m,left,right\n0,0.1,0.1\n1000,nan,0.1\n", "line 3: left = nan: must be a finite number"),
    (
        "position_m,left,right\n0,0.1,0.1\n500,0.1,0.1\n400,0.1,0.1\n1000,1,1\n",
        "line 4: position_m = 400: must lie",
    ),
    ("position_m,left,right\n0,0.1,0.1\n1000,-0.1,0.1\n", "line 3: left = -0.1: peak adhesion is a share of the load"),
    ("position_m,left,right\n0,7.0,7.0\n1000,6.5,7.0\n", "line 2: left = 7: .*this looks like per cent"),
    ("position_m,left,right\n0,0.1,0.1\n1.0,0.1,0.1\n", "must cover 0 to 1000; this looks like kilometres"),
    ("position_m,left,right\n5,0.1,0.1\n1000,0.1,0.1\n", "reaches from 5 to 1000, but must cover 0 to 1000"),
]


@pytest.mark.parametrize(("text", "message"), BAD_FILES)
def test_bad_files_are_refused_with_the_line(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "rail.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=message) as refusal:
        adhesion(parameters({"surface": "dry", "file": str(file)}))
    assert str(refusal.value).startswith(f"adhesion.stretches.0.file = {file}: ")
