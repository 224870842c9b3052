"""The command as a user meets it: exit codes, messages, and what is left on the disk."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from scenarios.catalogue import catalogue_table
from scenarios.cli import app
from scenarios.names import TABLES

BUILT_IN = "low-adhesion-stop"


def invoke(*arguments: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, list(arguments))
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.stdout, result.stderr


def test_help_imports_nothing_heavy() -> None:
    program = (
        "import sys\n"
        "from scenarios.cli import app\n"
        "from typer.testing import CliRunner\n"
        "assert CliRunner().invoke(app, ['--help']).exit_code == 0\n"
        "heavy = {'numpy', 'numba', 'scipy', 'matplotlib', 'exudyn', 'pyarrow', 'pydantic', 'filterpy', 'rich'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_version() -> None:
    code, output, _ = invoke("--version")
    assert code == 0
    assert output.startswith("railslide ")


def test_list_names_everything_that_a_file_may_use() -> None:
    code, output, _ = invoke("list")
    assert code == 0
    for name in (BUILT_IN, "rule-table", "none", "scmt", "orientation", "ins-odo", "malvezzi-2014", "bmi055"):
        assert name in output
    for name in ("polach", "modified-fastsim", "s1002", "uic60", "en15302-a", "low-recovering", "allotta-2014"):
        assert name in output


def test_list_says_of_every_entry_what_it_is() -> None:
    rows = zip(*(column.cells for column in catalogue_table().columns), strict=True)
    known = {(kind, name) for kind, read_table in TABLES.items() for name in read_table()}
    for kind, name, what in rows:
        known.remove((kind, name))
        assert len(str(what).split()) >= 3, f"{kind} {name}: {what}"
        assert not str(what).endswith((",", " with", " the", " of", " between")), what
    assert known == set()


def test_check_takes_a_good_file_without_running_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.toml").write_text(f'[scenario]\nextends = "{BUILT_IN}"\n')
    code, output, _ = invoke("check", "my.toml")
    assert code == 0
    assert "valid" in output
    assert os.listdir(tmp_path) == ["my.toml"]


BAD_FILES = {
    "unknown key": "[simulation]\nspeed = 3.0\n",
    "wrong unit": "[simulation]\ninitial_speed_mph = 75.0\n",
    "negative mass": "[coach.body]\nmass_kg = -1.0\n",
    "adhesion over 1": "[[adhesion.stretches]]\nfrom_m = 0.0\nsurface = 'dry'\npeak_adhesion = 1.01\n",
    "not a number": "[coach.body]\nmass_kg = nan\n",
    "unknown controller": "[wsp]\ncontroller = 'abs'\n",
    "invalid TOML": "[simulation\n",
}


@pytest.mark.parametrize("verb", ["run", "check"])
@pytest.mark.parametrize("text", BAD_FILES.values(), ids=BAD_FILES.keys())
def test_bad_files_end_in_one_message_and_nothing_else(
    verb: str, text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.toml").write_text(f'[scenario]\nextends = "{BUILT_IN}"\n{text}')
    code, output, errors = invoke(verb, "my.toml")
    assert code == 2
    assert output == ""
    assert len(errors.splitlines()) == 1
    assert errors.startswith("error: my.toml: ")
    assert os.listdir(tmp_path) == ["my.toml"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "gone.toml"],
        ["run", "."],
        ["run", "no-such-scenario"],
        ["run", BUILT_IN, "--set", "wsp.controller=abs"],
        ["run", BUILT_IN, "--set", "nonsense"],
        ["run", BUILT_IN, "--set", "coach.body.mass_kg=nan"],
        ["run", BUILT_IN, "--out", "file"],
        ["run", BUILT_IN, "--out", "file/runs"],
        ["run", BUILT_IN, "--out", "/proc/no/such"],
        ["run", BUILT_IN, "--out", "taken"],
    ],
)
def test_bad_arguments_end_in_one_message_and_nothing_else(
    arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    (tmp_path / "taken" / BUILT_IN).mkdir(parents=True)
    code, output, errors = invoke(*arguments)
    assert code == 2
    assert output == ""
    assert len(errors.splitlines()) == 1
    assert errors.startswith("error: ")
    assert sorted(os.listdir(tmp_path)) == ["file", "taken"]
    assert os.listdir(tmp_path / "taken") == [BUILT_IN]


def test_several_faults_are_listed_below_each_other() -> None:
    code, _, errors = invoke("check", BUILT_IN, "--set", "wsp.controller=abs", "--set", "track.length_m=-1")
    assert code == 2
    assert errors.splitlines()[0] == "error: 2 faults in the input"
    assert len(errors.splitlines()) == 3


@pytest.mark.parametrize("arguments", [["walk"], ["run"], ["run", BUILT_IN, "--speed", "3"]])
def test_unknown_verbs_and_options(arguments: list[str]) -> None:
    code, _, errors = invoke(*arguments)
    assert code == 2
    assert "Traceback" not in errors
