"""Published and closed-form figures, case by case, and the command that makes a table of them."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from scenarios.cli import app
from scenarios.figures.contact_geometry import draw_contact_geometry
from scenarios.figures.creep_laws import CreepSheet, draw_creep_laws
from scenarios.verification import Case, Outcome, all_cases, brake, contact_mechanics, profiles
from scenarios.verification.report import expected_text
from wheel_rail.creep_laws import CREEP_LAWS

CASES = all_cases()
QUICK_CASES = all_cases(without=["convergence", "paths"])
"""A short stop is in test_convergence, and one of the test paths is run in test_test_paths."""
PAGE = Path(__file__).parents[2] / "docs" / "VALIDATION.md"


@pytest.mark.parametrize("case", QUICK_CASES, ids=lambda case: case.id)
def test_figure(case: Case) -> None:
    """Within its tolerance, or known to deviate: such a mark must go when the figure is reached."""
    outcome = Outcome(case, case.obtain())
    print(
        f"{case.group}, {case.quantity}: {outcome.obtained:.6g} {case.unit}, expected {case.expected} ({case.source}), "
        f"error {outcome.error:+.3g}, tolerance {case.tolerance:g}{' of it' if case.relative else ''}"
    )
    assert outcome.result == ("pass" if case.known_deviation is None else "known deviation")


def test_contact_figure_shows_the_table_over_displacement() -> None:
    pair = profiles.geometry("s1002", "uic60", 1 / 40, 1.435)
    figure = draw_contact_geometry(pair, 0.46, "test", 0.008, [(1.0, -9.0)])
    wheel, difference, *_ = figure.axes
    assert {axes.get_ylabel().rpartition("  ")[2] for axes in figure.axes} == {"mm", "mrad", "deg", "-"}
    assert {"left wheel", "right wheel", "CONTACT, left wheel"} == set(wheel.get_legend_handles_labels()[1])
    y_mm, found = difference.get_lines()[0].get_data()
    assert (y_mm[0], y_mm[-1]) == pytest.approx((-8.0, 8.0))
    at = pair.table(np.array([0.003])).rolling_radius_difference_m[0, 0]
    assert np.interp(3.0, y_mm, found) == pytest.approx(1e3 * at, rel=1e-6)


def test_creep_sheet_shows_every_law_and_the_published_points() -> None:
    laws = {name: entry.in_force() for name, entry in CREEP_LAWS.items()}
    rail = np.array([0.3, 1.0, 0.0, 1.0, 1.0])
    patch = contact_mechanics.tractcurv_patch()
    sheet = CreepSheet(1e5, patch, 82e9, 10.0, rail, rail, {"points": {0.1: 3e4}}, {"fall": {0.2: 3e4}})
    along, falling, across, _ = draw_creep_laws(laws, sheet).axes
    assert set(along.get_legend_handles_labels()[1]) == {*laws, "points"}
    assert set(falling.get_legend_handles_labels()[1]) == {*laws, "fall"}
    assert set(across.get_legend_handles_labels()[1]) == set(laws)
    for line in along.get_lines():
        creep, adhesion = line.get_data()
        assert np.interp(0.1, creep, adhesion) == pytest.approx(0.3, rel=0.02)  # all slide there


def test_cases_are_told_apart() -> None:
    for key in ("id", "quantity"):
        names = [(case.group if key == "quantity" else "", getattr(case, key)) for case in CASES]
        assert len(set(names)) == len(names)


def test_the_page_shows_the_cases_of_this_program() -> None:
    """Stale when cases come, go or change: `railslide verify --write-docs docs` renews it."""
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    rows = [line for line in lines if line.startswith("| ") and not line.startswith(("| quantity", "| ---"))]
    assert len(rows) == len(CASES)
    for row, case in zip(rows, CASES, strict=True):
        assert row.startswith(f"| {case.quantity} | {case.source} | {case.unit} | {expected_text(case)} |")
        assert f"{case.known_deviation}." in "\n".join(lines) or case.known_deviation is None


def case(
    expected: float | tuple[float, float], obtained: float, tolerance: float = 0.0, relative: bool = False,
    known: str | None = None,
) -> Case:  # fmt: skip
    return Case(
        f"{expected}-{obtained}", "group", f"quantity {expected} {obtained}", "source", expected, "mm",
        lambda: obtained, tolerance, relative, known,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("row", "error", "result"),
    [
        (case(2.0, 2.1, 0.11), 0.1, "pass"),
        (case(2.0, 2.1, 0.09), 0.1, "MISS"),
        (case(-2.0, -2.1, 0.051, relative=True), -0.05, "pass"),
        (case(-2.0, -2.2, 0.05, relative=True), -0.1, "MISS"),
        (case((1.0, 3.0), 3.0), 0.0, "pass"),
        (case((1.0, 3.0), 3.5), 0.5, "MISS"),
        (case((1.0, 3.0), 0.5), -0.5, "MISS"),
        (case(2.0, 3.0, 0.1, known="why"), 1.0, "known deviation"),
        (case(2.0, 2.0, 0.1, known="why"), 0.0, "pass"),
        (case(2.0, math.nan, 0.1), math.nan, "MISS"),
        (case(2.0, math.inf, 0.1, known="why"), math.inf, "MISS"),
        (case((1.0, 3.0), math.nan), math.nan, "MISS"),
    ],
)
def test_error_and_result(row: Case, error: float, result: str) -> None:
    outcome = Outcome(row, row.obtain())
    assert outcome.error == pytest.approx(error, nan_ok=True, abs=1e-12)
    assert outcome.result == result


def run(monkeypatch: pytest.MonkeyPatch, rows: tuple[Case, ...], *arguments: str) -> tuple[int, str]:
    monkeypatch.setattr("scenarios.verification.command.all_cases", lambda without: rows)
    result = CliRunner().invoke(app, ["verify", *arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.stdout + result.stderr


def test_only_a_row_that_misses_fails_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    good, known, bad = case(1.0, 1.0), case(1.0, 2.0, known="the reason why"), case(1.0, 3.0)
    code, output = run(monkeypatch, (good, known))
    assert code == 0
    assert "the reason why" in " ".join(output.split())
    assert "2 figures: 1 within their tolerance, 1 known deviations, 0 missed" in output
    code, output = run(monkeypatch, (good, known, bad))
    assert code == 1
    assert "MISS" in output


def test_a_case_that_raises_is_a_row_that_misses(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def broken() -> float:
        raise ZeroDivisionError("no [wheels] left")

    file = tmp_path / "table.json"
    rows = (Case("broken", "group", "a quantity", "source", 1.0, "mm", broken), case(1.0, 1.0))
    code, output = run(monkeypatch, rows, "--json", str(file), "--write-docs", str(tmp_path))
    assert code == 1
    assert "failed: group, a quantity: ZeroDivisionError: no [wheels] left" in " ".join(output.split())
    assert "2 figures: 1 within their tolerance, 0 known deviations, 1 missed" in output
    first, second = json.loads(file.read_text()).values()
    assert (first["result"], first["failure"]) == ("MISS", "ZeroDivisionError: no [wheels] left")
    assert (second["result"], second["failure"]) == ("pass", None)
    assert "no [wheels] left" in (tmp_path / "VALIDATION.md").read_text(encoding="utf-8")


def test_json_holds_every_row_and_no_word_that_is_not_json(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    file = tmp_path / "table.json"
    code, _ = run(monkeypatch, (case(1.0, 1.0), case((0.0, 2.0), math.nan)), "--json", str(file))
    assert code == 1
    first, second = json.loads(file.read_text(), parse_constant=pytest.fail).values()
    assert (first["expected"], first["obtained"], first["result"]) == (1.0, 1.0, "pass")
    assert (second["expected"], second["obtained"], second["result"]) == ([0.0, 2.0], None, "MISS")


def test_docs_are_the_table_and_its_pictures(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    code, _ = run(monkeypatch, (case(1.0, 1.0), case(1.0, 2.0, known="why")), "--write-docs", str(tmp_path))
    assert code == 0
    page = (tmp_path / "VALIDATION.md").read_text(encoding="utf-8")
    assert "| quantity 1.0 2.0 | source | mm | 1 | 2 | +1 | 0 | known deviation |" in page
    pictures = [line.partition("](")[2].rstrip(")") for line in page.splitlines() if line.startswith("![")]
    assert len(pictures) >= 2
    for name in pictures:
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("option", ["--json", "--write-docs"])
def test_places_that_cannot_be_written_are_refused_before_the_work(
    option: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def never() -> float:
        raise AssertionError("computed")

    row = Case("id", "group", "quantity", "source", 1.0, "mm", never)
    code, output = run(monkeypatch, (row,), option, str(tmp_path / "gone" / "place"))
    assert code == 2
    assert output.startswith("error: ")


def test_areas_are_left_out_by_name() -> None:
    without = {case.id for case in all_cases(without=["paths", "brake"])}
    assert without == {case.id for case in CASES if not case.id.startswith("path-")} - {case.id for case in brake.CASES}
    result = CliRunner().invoke(app, ["verify", "--without", "brakes"])
    assert result.exit_code == 2
    assert "'brakes'" in result.stderr
    assert "point_mass" in result.stderr


def test_the_test_paths_are_run_before_their_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[int] = []

    def run_all(workers: int, interruption: object) -> list[int]:
        told.append(workers)
        return []

    monkeypatch.setattr("scenarios.verification.command.run_all", run_all)
    row = Case("path-00-length", "Test path 0", "a quantity", "source", 1.0, "km", lambda: 1.0)
    assert run(monkeypatch, (row,))[0] == 0
    assert len(told) == 1
    assert run(monkeypatch, (case(1.0, 1.0),))[0] == 0
    assert len(told) == 1
