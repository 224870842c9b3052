"""What `railslide wsp-test` does: read and check all, run what is not there yet, show and write the scorecard."""

import os
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.measure import Measurement
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from scenarios.compile_cache import source_fingerprint
from scenarios.errors import BadInput, Fault, RunInterrupted
from scenarios.interruption import Interruption
from scenarios.names import display_name
from scenarios.run import RECORDED_PACKAGES
from scenarios.run_folder import PROGRAM, Contents, remove, why_not_replaceable
from scenarios.scenario_file import load_scenario
from scenarios.wsp_test.limits import beyond, load_limits
from scenarios.wsp_test.programme import Programme, Stop, load_programme
from scenarios.wsp_test.report import (
    Scorecard,
    beyond_lines,
    scorecard_tree,
    terminal_table,
    verdict,
    write_csv,
    write_json,
)
from scenarios.wsp_test.results import Result
from scenarios.wsp_test.runner import KeptStops, Workers, stop_key
from scenarios.wsp_test.scorecard import Score
from scenarios.wsp_test.worker import draw, score

DRAWN = ("none", "summary", "worst", "all")
"""Which pictures are drawn: of the programme as a whole, of the worst stops besides, of all stops."""
WORST_DRAWN = 4
RESULTS = ("scorecard.json", "scorecard.csv", "figures")
CONTENTS = Contents(frozenset({"provenance.json", "stops", *RESULTS}), "provenance.json", "test programme")


@dataclass(frozen=True)
class Request:
    """The command line of one test programme."""

    controller: str
    settings: tuple[str, ...]
    programme: Path
    limits: Path
    only: tuple[str, ...]
    out: Path
    workers: int
    drawn: str
    json_file: Path | None
    command: tuple[str, ...] = ()


def run_wsp_test(request: Request, console: Console, progress: Console, interruption: Interruption) -> Scorecard:
    """The whole command. Finished stops stay in the folder whatever happens; RunInterrupted says how many.

    Raises BadInput before anything is computed, RunFailed if a worker process dies.
    """
    if request.drawn not in DRAWN:
        raise BadInput(Fault("--figures", request.drawn, f"must be one of {', '.join(DRAWN)}"))
    programme = load_programme(request.programme, request.controller, request.settings)
    limits = load_limits(request.limits, {group for stop in programme.stops for group in stop.limits})
    if request.only:
        programme = programme.only(request.only)
    _check_command_line(request, programme.stops[0].scenario)
    if request.json_file is not None:
        write_json(request.json_file, {})  # whether it can be written shows before the work
    keys = _keys(programme)
    folder = _folder(request)
    begun = datetime.now(UTC)
    wall_s: dict[str, float] = {"begin": time.perf_counter()}
    kept = KeptStops(folder / "stops")
    scores: dict[str, Score] = {}
    failures: dict[str, str] = {}
    everything = (*programme.dry_references, *programme.stops)
    todo: list[Stop] = []
    for stop in everything:
        found = kept.find(stop.name, keys[stop.name])
        if found is None:
            todo.append(stop)
        else:
            scores[stop.name] = found
    # the long ones first: then no core waits long for another's last stop
    todo.sort(key=_likely_length, reverse=True)
    count = max(1, min(request.workers, len(todo) or request.workers))
    try:
        with Workers(count, interruption) as workers, _bar(progress, len(everything), len(scores)) as on_stop:
            for stop, scored in workers.each(score, todo):
                on_stop(stop.name)
                if scored.score is None:
                    failures[stop.name] = scored.failure
                else:
                    kept.keep(stop.name, keys[stop.name], scored.score)
                    scores[stop.name] = scored.score
            wall_s["stops"] = time.perf_counter() - wall_s["begin"]
            card = _scorecard(request, programme, limits, scores, failures)
            tree = scorecard_tree(card, request.settings)
            write_json(folder / "scorecard.json", tree)
            write_csv(folder / "scorecard.csv", card)
            pictures = _draw(card, folder / "figures", request.drawn, workers, on_stop)
    except (KeyboardInterrupt, RunInterrupted):
        raise RunInterrupted(
            f"interrupted; {len(scores)} of {len(everything)} stops are finished and kept in {folder}: "
            "the same command goes on from there"
        ) from None
    wall_s["all"] = time.perf_counter() - wall_s.pop("begin")
    write_json(folder / "provenance.json", _provenance(request, begun, count, len(todo), wall_s))
    if request.json_file is not None:
        write_json(request.json_file, tree)
    _show(console, card, folder, pictures, wall_s["all"], len(everything) - len(todo))
    return card


def _check_command_line(request: Request, base: str) -> None:
    """Faults of controller and settings, told once and not for every stop."""
    try:
        load_scenario(base, [f"wsp.controller={request.controller}", *request.settings])
    except BadInput as error:
        raise BadInput(
            *(
                replace(fault, source="CONTROLLER") if fault.key.startswith("wsp.controller") else fault
                for fault in error.faults
            )
        ) from None


def _keys(programme: Programme) -> dict[str, str]:
    """Name -> key of every stop; all of them are loaded for it, and what is wrong with any is raised together."""
    keys: dict[str, str] = {}
    faults: list[Fault] = []
    for stop in (*programme.dry_references, *programme.stops):
        try:
            keys[stop.name] = stop_key(stop, stop.load())
        except BadInput as error:
            faults.extend(error.faults)
    if faults:
        raise BadInput(*faults)
    return keys


def _folder(request: Request) -> Path:
    """The folder of the results, made if it is not there; figures and tables of an earlier call are removed."""
    name = re.sub(r"[^A-Za-z0-9_.+-]", "-", display_name(request.controller))
    folder = request.out / f"wsp-test-{name}"
    refusal = why_not_replaceable(folder, CONTENTS)
    if refusal:
        raise BadInput(Fault("--out", str(folder), refusal))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # what the folder is must show from the first stop on
        write_json(folder / "provenance.json", {"program": PROGRAM, "controller": request.controller})
        for entry in RESULTS:
            remove(folder / entry)
            if (folder / entry).is_file():
                (folder / entry).unlink()
    except OSError as error:
        raise BadInput(Fault("--out", str(folder), f"cannot be written: {error.strerror}")) from None
    return folder


def _likely_length(stop: Stop) -> float:
    speeds = [s.partition("=")[2] for s in stop.settings if s.startswith("simulation.initial_speed_kmh=")]
    return float(speeds[-1])


def _scorecard(
    request: Request, programme: Programme, limits: Any, scores: Mapping[str, Score], failures: Mapping[str, str]
) -> Scorecard:
    results = tuple(
        Result(stop, scores[stop.name], scores.get(stop.dry or "")) for stop in programme.stops if stop.name in scores
    )
    found = {result.stop.name: beyond(result, limits) for result in results}
    return Scorecard(programme, request.controller, limits, results, found, failures)


def _draw(card: Scorecard, folder: Path, drawn: str, workers: Workers, on_stop: Any) -> list[Path]:
    """The pictures of the whole programme, and those of the worst stops or of all."""
    if not card.results or drawn == "none":
        return []
    from scenarios.wsp_test.figures import write_summaries  # matplotlib takes a while to import

    folder.mkdir(exist_ok=True)
    chosen = {"summary": [], "worst": _worst(card.results), "all": list(card.results)}[drawn]
    orders = [(result.stop, result.required_ratio, folder / f"stop-{result.stop.name}.png") for result in chosen]
    files = set()
    for order, file in workers.each(draw, orders):
        on_stop(f"drawing {order[0].name}")
        files.add(file)
    return [*write_summaries(folder, card), *(file for _, _, file in orders if file in files)]


def _worst(results: Sequence[Result]) -> list[Result]:
    """The worst stop of each group by distance over the shortest possible, and of these the worst few."""
    by_group: dict[str, tuple[float, Result]] = {}
    for result in results:
        distance_m, shortest_m = result.score.distance_m, result.score.shortest_distance_m
        ratio = distance_m / shortest_m if distance_m is not None and shortest_m else float("inf")
        if result.stop.group not in by_group or ratio > by_group[result.stop.group][0]:
            by_group[result.stop.group] = (ratio, result)
    ranked = sorted(by_group.values(), key=lambda entry: -entry[0])
    return [result for _, result in ranked[:WORST_DRAWN]]


@contextmanager
def _bar(console: Console, total: int, done: int) -> Iterator[Any]:
    """A progress bar where there is a terminal; gives the function that is told of each stop."""
    bar = Progress(
        TextColumn("{task.description:<36}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
    task = bar.add_task("starting", total=total, completed=done)

    def on_stop(name: str) -> None:
        bar.update(task, description=name, advance=0 if name.startswith("drawing ") else 1)

    with bar:
        yield on_stop


def _provenance(
    request: Request, begun: datetime, workers: int, computed: int, wall_s: Mapping[str, float]
) -> dict[str, Any]:
    return {
        "program": PROGRAM,
        "controller": request.controller,
        "settings": list(request.settings),
        "programme": str(request.programme),
        "limits": str(request.limits),
        "versions": {name: version(name) for name in (PROGRAM, *RECORDED_PACKAGES)},
        "sources": source_fingerprint(),
        "command": list(request.command),
        "started": begun.isoformat(timespec="seconds"),
        "workers": workers,
        "cores": os.cpu_count(),
        "stops_computed": computed,
        "wall_s": {name: round(value, 3) for name, value in wall_s.items()},
    }


def _show(
    console: Console, card: Scorecard, folder: Path, pictures: Sequence[Path], wall_s: float, reused: int
) -> None:
    if card.results:
        table = terminal_table(card)
        # lines that a narrow terminal breaks can still be read, squeezed columns cannot
        width = Measurement.get(console, console.options.update(max_width=1000), table).maximum
        wide = Console(file=console.file, width=max(width, console.width), force_terminal=console.is_terminal)
        wide.print(table)
    for line in beyond_lines(card):
        console.print(f"beyond: {line}", highlight=False, markup=False, soft_wrap=True)
    for name, failure in card.failures.items():
        console.print(f"failed: {name}: {failure}", highlight=False, markup=False, soft_wrap=True)
    console.print(verdict(card), highlight=False, markup=False, soft_wrap=True)
    earlier = f"; {reused} stops and dry references are from an earlier call" if reused else ""
    console.print(f"done in {wall_s:.1f} s{earlier}", highlight=False)
    console.print(f"scorecard   {folder / 'scorecard.json'}", highlight=False, soft_wrap=True)
    for picture in pictures:
        console.print(f"picture     {picture}", highlight=False, soft_wrap=True)
