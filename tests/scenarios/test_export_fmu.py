"""The verb `export-fmu`: what lies in the file, and what it says when it cannot be made."""

import importlib.util
import os
import shutil
import zipfile
from pathlib import Path

import pytest
from typer.testing import CliRunner

from scenarios.cli import app
from scenarios.coach_fmu import native
from scenarios.coach_fmu.export import export_fmu
from scenarios.scenario_file import load_scenario

BUILT_IN = "low-adhesion-stop"


def invoke(*arguments: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, ["export-fmu", *arguments])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.stdout, result.stderr


@pytest.mark.parametrize(("fmi", "platform"), [("2", "linux64"), ("3", "x86_64-linux")])
def test_the_file_holds_what_the_standard_wants(
    fmi: str, platform: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, output, _ = invoke(BUILT_IN, "--fmi", fmi)
    assert code == 0
    assert "coach.fmu" in output
    assert os.listdir(tmp_path) == ["coach.fmu"]
    with zipfile.ZipFile("coach.fmu") as archive:
        assert archive.namelist() == [
            "modelDescription.xml",
            f"binaries/{platform}/railslide_coach.so",
            "resources/python.txt",
            "resources/scenario.toml",
        ]
        assert archive.read(f"binaries/{platform}/railslide_coach.so").startswith(b"\x7fELF")


def test_the_same_scenario_gives_the_same_file(tmp_path: Path) -> None:
    for name in ("a.fmu", "b.fmu"):
        export_fmu(load_scenario(BUILT_IN), tmp_path / name, 2)
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()


def test_files_of_the_scenario_go_along(tmp_path: Path) -> None:
    """A creep law of the user's own: gone at home, still there in the FMU."""
    home = tmp_path / "home"
    home.mkdir()
    shutil.copy(Path(__file__).parents[1] / "wheel_rail" / "user_laws.py", home / "law.py")
    (home / "my.toml").write_text(f'[scenario]\nextends = "{BUILT_IN}"\n[creep_law]\nname = "law.py:circular"\n')
    loaded = load_scenario(home / "my.toml")
    export_fmu(loaded, tmp_path / "coach.fmu", 2)
    shutil.rmtree(home)
    with zipfile.ZipFile(tmp_path / "coach.fmu") as archive:
        archive.extractall(tmp_path / "there")
    inside = load_scenario(tmp_path / "there" / "resources" / "scenario.toml")
    file, colon, name = inside.creep_law.name.rpartition(":")
    assert (file, colon + name) == (str(tmp_path / "there" / "resources" / "files" / "0-law.py"), ":circular")
    assert Path(file).is_file()
    kept = {"scenario", "coach", "track", "adhesion", "driver", "brake", "tachometers", "imu"}
    assert inside.model_dump(include=kept) == loaded.model_dump(include=kept)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no-such-scenario"], "no-such-scenario"),
        ([BUILT_IN, "--set", "wsp.controller=abs"], "wsp.controller"),
        ([BUILT_IN, "--set", "simulation.record_period_s=0.005"], "simulation.record_period_s = 0.005: must be 0.01"),
        ([BUILT_IN, "--out", "folder"], "is a folder"),
        ([BUILT_IN, "--out", "gone/coach.fmu"], "cannot be written"),
        ([BUILT_IN, "--out", "file/coach.fmu"], "cannot be written"),
    ],
)
def test_bad_input_ends_in_one_message_and_nothing_else(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    code, output, errors = invoke(*arguments)
    assert (code, output, len(errors.splitlines())) == (2, "", 1)
    assert errors.startswith("error: ")
    assert message in errors
    assert sorted(os.listdir(tmp_path)) == ["file", "folder"]


@pytest.mark.parametrize("missing", ["fmpy", "ziglang"])
def test_a_missing_package_names_the_extra(missing: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.find_spec
    monkeypatch.setattr(native, "find_spec", lambda name: None if name == missing else found(name))
    code, _, errors = invoke(BUILT_IN, "--out", str(tmp_path / "coach.fmu"))
    assert code == 2
    assert missing in errors
    assert "railslide[fmu]" in errors
    assert os.listdir(tmp_path) == []


def test_a_compiled_library_is_kept_and_found_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "user_cache_folder", lambda: tmp_path)
    monkeypatch.setattr(native, "_compiled", lambda *_: b"compiled")
    assert native.shared_library() == b"compiled"
    monkeypatch.setattr(native, "_compiled", lambda *_: pytest.fail("compiled again"))
    assert native.shared_library() == b"compiled"
    monkeypatch.setattr(native, "_compiled", lambda *_: b"anew")
    monkeypatch.setattr(native, "variables_header", lambda: "other variables")
    assert native.shared_library() == b"anew"


def test_a_cache_that_cannot_be_written_does_no_harm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "railslide").write_text("a file where a folder is wanted")
    monkeypatch.setattr(native, "user_cache_folder", lambda: tmp_path)
    monkeypatch.setattr(native, "_compiled", lambda *_: b"compiled")
    assert native.shared_library() == b"compiled"
