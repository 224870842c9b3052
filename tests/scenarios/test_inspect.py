"""The command `inspect`: its tables, files and refusals."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from scenarios.cli import app
from scenarios.coach_file import load_coach
from scenarios.errors import BadInput
from scenarios.inspect_report import PICTURES
from vehicle import COACH_PRESETS


def run(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["inspect", *arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.stdout + result.stderr


def test_a_file_of_the_users_own_is_shown_in_tables_and_pictures(tmp_path: Path) -> None:
    file = tmp_path / "heavy.toml"
    file.write_text(COACH_PRESETS["malvezzi-2014"].read_text(encoding="utf-8"), encoding="utf-8")
    arguments = [str(file), "--set", "body.mass_kg=48800", "--speed", "160", "--out", str(tmp_path / "out")]
    code, output = run(*arguments)
    assert code == 0, output
    assert "64.00 t in all" in output
    for words in ("78.48", "body bounce", "klingel", "secondary-lateral-stop", "swings at 160 km/h"):
        assert words in output
    folder = tmp_path / "out" / "heavy.coach"
    assert {entry.name for entry in folder.iterdir()} == {"inspect.json", *PICTURES}
    for name in PICTURES:
        assert (folder / name).read_bytes().startswith(b"\x89PNG")
    content = json.loads((folder / "inspect.json").read_text(encoding="utf-8"), parse_constant=pytest.fail)
    assert content["wheel_load_n"] == pytest.approx([64_000.0 * 9.81 / 8.0] * 8, rel=1e-6)
    by_name = {mode["name"]: mode for mode in content["modes"]}
    assert by_name["body bounce"]["frequency_hz"] == pytest.approx(0.827 * (40.8 / 48.8) ** 0.5, rel=0.01)
    level, deficient = content["curve"]
    assert sum(deficient["wheel_load_n"][1::2]) > sum(level["wheel_load_n"][1::2])
    assert 0.1 < deficient["flexibility"] < 0.4
    steep = [row["speed_kmh"] for row in content["hunting"] if row["on"] == "cones"]
    assert steep[0] is None or steep[0] > steep[-1]
    # a second time it replaces its own folder, but no other
    (folder / "mine.txt").touch()
    code, output = run(*arguments)
    assert code == 2
    assert "mine.txt" in output


BAD = [
    (["malvezi-2014"], "malvezzi-2014"),
    (["gone.toml"], "there is no such file"),
    (["malvezzi-2014", "--set", "body.mass_kg=-1"], "coach.body.mass_kg = -1"),
    (["malvezzi-2014", "--set", "body.mas_kg=1"], "did you mean 'mass_kg'"),
    (["malvezzi-2014", "--set", "preset=manchester"], "argument of the command"),
    (["malvezzi-2014", "--set", "contact.profiles.wheel_profile=square"], "coach.contact.profiles.wheel_profile"),
    (["malvezzi-2014", "--speed", "0"], "--speed"),
]


@pytest.mark.parametrize(("arguments", "words"), BAD)
def test_bad_input_is_one_message(arguments: list[str], words: str, tmp_path: Path) -> None:
    code, output = run(*arguments, "--out", str(tmp_path))
    assert code == 2
    assert words in output
    assert "Traceback" not in output
    assert not list(tmp_path.iterdir())


def test_settings_may_name_the_section_or_not() -> None:
    one = load_coach("malvezzi-2014", ["body.mass_kg=41000"])
    two = load_coach("malvezzi-2014", ["coach.body.mass_kg=41000"])
    assert one == two
    assert one.body.mass_kg == 41000.0


def test_every_fault_is_told() -> None:
    with pytest.raises(BadInput) as caught:
        load_coach("malvezzi-2014", ["body.mass_kg=-1", "bogie.mass_kg=true"])
    assert len(caught.value.faults) == 2
