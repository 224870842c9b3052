"""The validation table: computed, shown on the terminal, written as JSON and as a page of the documentation."""

import json
import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from scenarios.errors import BadInput, Fault
from scenarios.verification.case import Case, Outcome

PAGE = "VALIDATION.md"
COMMAND = "railslide verify --write-docs docs"
ROUNDING = 1e-14
_NUMBERS = ("expected", "obtained", "error", "tolerance")
_STYLES = {"pass": "green", "known deviation": "yellow", "MISS": "bold red"}


def verify(cases: Sequence[Case], on_case: Callable[[int, Case], None]) -> list[Outcome]:
    """Obtain the figure of every case; `on_case(k, case)` is told before each.

    A case that raises is a row that misses: one broken part of the program must not hide the state of the others.
    """
    outcomes = []
    for k, case in enumerate(cases):
        on_case(k, case)
        try:
            outcome = Outcome(case, case.obtain())
        except Exception as error:
            outcome = Outcome(case, math.nan, f"{type(error).__name__}: {error}")
        outcomes.append(outcome)
    return outcomes


def missed(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """The rows that miss their tolerance and are no known deviations."""
    return [outcome for outcome in outcomes if outcome.result == "MISS"]


def verdict(outcomes: Sequence[Outcome]) -> str:
    """One sentence on the whole table."""
    count = {result: sum(o.result == result for o in outcomes) for result in ("pass", "known deviation", "MISS")}
    return (
        f"{len(outcomes)} figures: {count['pass']} within their tolerance, {count['known deviation']} known "
        f"deviations, {count['MISS']} missed"
    )


def terminal_tables(outcomes: Sequence[Outcome]) -> Iterator[Table]:
    """A table for each group, their columns alike; the title names the source of all rows that do not name another."""
    texts = {row.case.id: _numbers(row) for row in outcomes}
    widths = [max(len(heading), *(len(text[k]) for text in texts.values())) for k, heading in enumerate(_NUMBERS)]
    for group, rows in _groups(outcomes):
        usual = Counter(row.case.source for row in rows).most_common(1)[0][0]
        table = Table(
            title=f"{group} ({usual})", title_justify="left", title_style="bold", expand=True, box=SIMPLE_HEAD
        )
        table.add_column("quantity  unit", ratio=1)
        for heading, width in zip(_NUMBERS, widths, strict=True):
            table.add_column(heading, justify="right", no_wrap=True, width=width)
        table.add_column("result", width=9)
        for row in rows:
            source = f" ({row.case.source})" if row.case.source != usual else ""
            result = Text(row.result, _STYLES[row.result])
            table.add_row(Text(f"{row.case.quantity}{source}  {row.case.unit}"), *texts[row.case.id], result)
        yield table


def deviations(outcomes: Sequence[Outcome]) -> list[str]:
    """A line on every known deviation: which, and why."""
    return [
        f"{row.case.group}, {row.case.quantity}: {row.case.known_deviation}"
        for row in outcomes
        if row.result == "known deviation"
    ]


def failures(outcomes: Sequence[Outcome]) -> list[str]:
    """A line on every case that raised instead of giving a figure."""
    return [f"{row.case.group}, {row.case.quantity}: {row.failure}" for row in outcomes if row.failure is not None]


def write_json(path: Path, outcomes: Sequence[Outcome]) -> None:
    """JSON: id -> all that the table shows; null where a figure is not finite. Raises BadInput if it cannot be."""
    content = {row.case.id: _record(row) for row in outcomes}
    _write(path, json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def write_page(folder: Path, outcomes: Sequence[Outcome], pictures: Sequence[tuple[str, str]]) -> Path:
    """Write VALIDATION.md into `folder`: all rows, known deviations, `pictures` (file name, caption) lying beside it.

    Raises BadInput if it cannot be written.
    """
    lines = [
        "# Validation",
        "",
        f"Written by `{COMMAND}`, which computes every figure anew; `make test` checks the same cases.",
        "Do not edit this page.",
        "",
        verdict(outcomes) + ".",
    ]
    headings = ("quantity", "source", "unit", *_NUMBERS, "result")
    for group, rows in _groups(outcomes):
        lines += ["", f"## {group}", "", f"| {' | '.join(headings)} |"]
        lines.append("| --- | --- | --- | ---: | ---: | ---: | ---: | --- |")
        for row in rows:
            case = row.case
            cells = (case.quantity, case.source, case.unit, *_numbers(row), row.result)
            lines.append(f"| {' | '.join(cells)} |")
    known = deviations(outcomes)
    if known:
        lines += ["", "## Known deviations", "", *(f"- {line}." for line in known)]
    failed = failures(outcomes)
    if failed:
        lines += ["", "## Failures", "", *(f"- {line}" for line in failed)]
    lines += ["", "## Pictures"] if pictures else []
    for name, caption in pictures:
        lines += ["", caption, "", f"![{caption}]({name})"]
    page = folder / PAGE
    _write(page, "\n".join(lines) + "\n")
    return page


def expected_text(case: Case) -> str:
    """The expected figure or its bounds, without the unit."""
    if isinstance(case.expected, tuple):
        return " .. ".join(map(_number, case.expected))
    return _number(case.expected)


def _numbers(row: Outcome) -> tuple[str, str, str, str]:
    """Expected, obtained, error and tolerance: the latter two in per cent where relative, else in the case's unit."""
    case = row.case
    error = "0" if abs(row.error) < ROUNDING else f"{row.error:+.2g}"
    tolerance = "bounds" if isinstance(case.expected, tuple) else f"{case.tolerance:g}"
    if case.relative:
        error, tolerance = f"{100.0 * row.error:+.2g} %", f"{100.0 * case.tolerance:.3g} %"
    return expected_text(case), _number(row.obtained), error, tolerance


def _record(row: Outcome) -> dict[str, Any]:
    case = row.case
    return {
        "group": case.group,
        "quantity": case.quantity,
        "source": case.source,
        "expected": case.expected,
        "obtained": row.obtained if math.isfinite(row.obtained) else None,
        "unit": case.unit,
        "error": row.error if math.isfinite(row.error) else None,
        "tolerance": case.tolerance,
        "relative": case.relative,
        "result": row.result,
        "known_deviation": case.known_deviation,
        "failure": row.failure,
    }


def _groups(outcomes: Sequence[Outcome]) -> Iterator[tuple[str, list[Outcome]]]:
    for group, rows in groupby(outcomes, key=lambda row: row.case.group):
        yield group, list(rows)


def _number(value: float) -> str:
    """Five digits, one more than most published figures have; what is zero but for rounding is shown as such."""
    return "0" if abs(value) < ROUNDING else f"{value:.5g}"


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise BadInput(Fault(str(path), "", f"cannot be written: {error.strerror}")) from None
