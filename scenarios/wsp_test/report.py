"""The scorecard as terminal table, JSON and CSV."""

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import fmean
from typing import Any

from rich.table import Table

from scenarios.errors import BadInput, Fault
from scenarios.run_folder import PROGRAM
from scenarios.wsp_test.limits import Beyond, Limit
from scenarios.wsp_test.programme import Programme
from scenarios.wsp_test.results import METRICS, Result

BEYOND_STYLE = "bold red"


@dataclass(frozen=True)
class Scorecard:
    """All that came of a programme: scored stops, what of each lies beyond its limits, and stops that broke down."""

    programme: Programme
    controller: str
    limits: tuple[Limit, ...]
    results: tuple[Result, ...]
    beyond: Mapping[str, list[Beyond]]
    failures: Mapping[str, str]

    @property
    def count_beyond(self) -> int:
        """Stops with anything beyond a limit."""
        return sum(bool(found) for found in self.beyond.values())

    def of_group(self, group: str) -> list[Result]:
        return [result for result in self.results if result.stop.group == group]


@dataclass(frozen=True)
class Column:
    """A column of the table: its heading, the metric, and how it is written and summed up over a group."""

    heading: str
    metric: str
    form: str
    scale: float
    over_group: Callable[[Sequence[float]], float]

    def text(self, value: float | None) -> str:
        return "-" if value is None else self.form.format(self.scale * value)


COLUMNS = (
    Column("distance\nm", "distance_m", "{:.0f}", 1.0, fmean),
    Column("over\ndry", "distance_over_dry", "{:.2f}", 1.0, fmean),
    Column("over\nshortest", "distance_over_shortest", "{:.3f}", 1.0, fmean),
    Column("adhesion\nused %", "adhesion_utilisation", "{:.1f}", 100.0, fmean),
    Column("slip\nerror %", "slip_error", "{:.1f}", 100.0, fmean),
    Column("longest\nlock s", "longest_lock_s", "{:.2f}", 1.0, max),
    Column("sliding\nm", "sliding_distance_m", "{:.0f}", 1.0, max),
    Column("friction\nMJ", "friction_energy_kj", "{:.1f}", 1e-3, fmean),
    Column("flat risk\nMN m", "flat_risk_mnm", "{:.2f}", 1.0, max),
    Column("valve\nops", "valve_operations", "{:.0f}", 1.0, fmean),
    Column("air\nnl", "air_nl", "{:.0f}", 1.0, fmean),
    Column("ref. error\nkm/h", "reference_error_rms_kmh", "{:.2f}", 1.0, fmean),
    Column("reservoir\nbar", "least_reservoir_bar", "{:.1f}", 1.0, min),
    Column("unfilled\ns", "longest_unfilled_s", "{:.1f}", 1.0, max),
    Column("safety\ntimer s", "safety_timer_s", "{:.1f}", 1.0, max),
)


def terminal_table(card: Scorecard) -> Table:
    """A row for each stop, groups apart with a line of their means (of locks, sliding, flat risk, times: the worst)."""
    title = f"{card.programme.title or card.programme.name}: {card.controller}"
    table = Table(title=title, title_justify="left", padding=(0, 1), pad_edge=False, box=None, header_style="bold")
    table.add_column("stop", no_wrap=True)
    for column in COLUMNS:
        table.add_column(column.heading, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for group, group_title in card.programme.groups.items():
        results = card.of_group(group)
        failed = [s.name for s in card.programme.stops if s.group == group and s.name in card.failures]
        if not results and not failed:
            continue
        table.add_section()
        means = [column.text(_over(column, results)) for column in COLUMNS]
        table.add_row(group_title, *means, "", style="bold")
        for result in results:
            found = card.beyond[result.stop.name]
            metrics = {entry.metric for entry in found}
            cells = []
            for column in COLUMNS:
                text = column.text(METRICS[column.metric].value(result))
                cells.append(f"[{BEYOND_STYLE}]{text}[/]" if column.metric in metrics else text)
            table.add_row(f"  {result.stop.name}", *cells, f"[{BEYOND_STYLE}]beyond[/]" if found else "")
        for name in failed:
            table.add_row(f"  {name}", *("" for _ in COLUMNS), f"[{BEYOND_STYLE}]failed[/]")
    return table


def _over(column: Column, results: Sequence[Result]) -> float | None:
    known = [value for value in (METRICS[column.metric].value(r) for r in results) if value is not None]
    return column.over_group(known) if known else None


def beyond_lines(card: Scorecard) -> list[str]:
    """What lies beyond its limit, a line each; M marks limits known at second hand."""
    return [f"{name}: {entry}" for name, found in card.beyond.items() for entry in found]


def verdict(card: Scorecard) -> str:
    """The closing sentence."""
    stops = len(card.results)
    text = f"{stops} stops, {card.count_beyond} with a figure beyond a limit"
    if card.failures:
        text += f", {len(card.failures)} more broke down"
    if any(limit.known == "second-hand" for limit in card.limits):
        text += ". M: limit known at second hand; no standard is quoted"
    return text


def scorecard_tree(card: Scorecard, settings: Sequence[str]) -> dict[str, Any]:
    """The content of scorecard.json."""
    return {
        "program": PROGRAM,
        "controller": card.controller,
        "settings": list(settings),
        "programme": {"name": card.programme.name, "title": card.programme.title},
        "metrics": {name: {"unit": metric.unit, "about": metric.about} for name, metric in METRICS.items()},
        "limits": [limit.model_dump(mode="json", exclude_none=True) for limit in card.limits],
        "groups": {
            group: {
                "title": title,
                "stops": len(card.of_group(group)),
                "mean": {name: _mean(metric.value, card.of_group(group)) for name, metric in METRICS.items()},
            }
            for group, title in card.programme.groups.items()
            if card.of_group(group)
        },
        "stops": [_stop_tree(result, card.beyond[result.stop.name]) for result in card.results],
        "failures": dict(card.failures),
    }


def _mean(of: Callable[[Result], float | None], results: Sequence[Result]) -> float | None:
    known = [value for value in map(of, results) if value is not None]
    return fmean(known) if known else None


def _stop_tree(result: Result, found: Sequence[Beyond]) -> dict[str, Any]:
    stop, score = result.stop, result.score
    details = asdict(score)
    for stretch, source in zip(details["stretches"], score.stretches, strict=True):
        stretch["performance"] = result.performance(source)
    return {
        "name": stop.name,
        "group": stop.group,
        "settings": list(stop.settings),
        "limits": list(stop.limits),
        "ended": score.ended,
        **{name: metric.value(result) for name, metric in METRICS.items()},
        "slide_events": score.slide_events,
        "stretches": details["stretches"],
        "wheelsets": details["wheelsets"],
        "beyond": [
            {"metric": b.metric, "value": b.value, "limit": b.limit.mark if b.limit else "standstill"} for b in found
        ],
    }


def write_json(path: Path, tree: Mapping[str, Any], option: str = "--json") -> None:
    """Raises BadInput if the file cannot be written."""
    try:
        path.write_text(json.dumps(tree, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise BadInput(Fault(option, str(path), f"cannot be written: {error.strerror}")) from None


def write_csv(path: Path, card: Scorecard) -> None:
    """A row for each stop; the unit of a column stands at the end of its name, none for shares and counts."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["name", "group", *METRICS, "beyond"])
        for result in card.results:
            values = [metric.value(result) for metric in METRICS.values()]
            found = "; ".join(map(str, card.beyond[result.stop.name]))
            cells = ["" if value is None else repr(value) for value in values]
            writer.writerow([result.stop.name, result.stop.group, *cells, found])
