"""One run from scenario to run folder: solve, masks, estimators, metrics, tables, figures."""

import os
import platform
import time
import traceback
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from scenarios.compile_cache import source_fingerprint
from scenarios.cosimulation.line import track_of
from scenarios.cosimulation.simulation import simulate
from scenarios.errors import RunFailed, RunInterrupted, SolveFailed
from scenarios.metrics import estimator_errors, estimator_metrics, metrics_tree, stop_metrics, wheelset_metrics
from scenarios.names import display_name
from scenarios.observe import observe
from scenarios.parquet import write_stream
from scenarios.rail_adhesion import adhesion_along_rail
from scenarios.run_folder import PROGRAM, RunFolder
from scenarios.scenario_file import dump_scenario
from scenarios.schema import Scenario
from scenarios.shortest_stop import shortest_stop
from scenarios.truth import SolveRecord, Truth

RECORDED_PACKAGES = ("exudyn", "filterpy", "matplotlib", "numba", "numpy", "pyarrow", "pydantic", "scipy")


class Watcher:
    """Whoever looks on while a run goes; this one does not."""

    def stage(self, name: str) -> None:
        """A part of the run begins."""

    def solving(self, t_s: float, position_m: float, speed_mps: float) -> None:
        """The solve has come so far; called often."""

    def stop_requested(self) -> bool:
        """Polled during the solve and between the stages."""
        return False

    def guard(self) -> AbstractContextManager[None]:
        """Context of the solve and of the last rename, in which no exception may come from outside."""
        return nullcontext()


@dataclass(frozen=True)
class RunResult:
    """Where a run lies, what metrics.json says, and its pictures."""

    folder: Path
    metrics: dict[str, Any]
    figures: list[Path]


class _Stages:
    """The parts of a run, announced and timed."""

    def __init__(self, watcher: Watcher) -> None:
        self.watcher = watcher
        self.wall_s: dict[str, float] = {}

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        if self.watcher.stop_requested():
            raise RunInterrupted
        self.watcher.stage(name)
        begin = time.perf_counter()
        yield
        self.wall_s[name] = round(time.perf_counter() - begin, 4)


def run_scenario(
    scenario: Scenario,
    out: Path,
    watcher: Watcher | None = None,
    *,
    command: Sequence[str] = (),
    figures: bool = True,
) -> RunResult:
    """Run `scenario` into the folder `out / scenario.name`; `command` is recorded as what started it.

    Raises BadInput if the folder cannot be written (before anything is computed), RunFailed if the run breaks down
    (what it had then lies in `<name>.failed/`), RunInterrupted if the watcher asks to stop (nothing is left).
    """
    stages = _Stages(watcher or Watcher())
    started = datetime.now(UTC)
    with RunFolder(out, scenario.name) as folder:
        try:
            metrics, solve, pictures = _fill(folder, scenario, stages, figures)
            folder.write_json("provenance.json", _provenance(scenario, command, started, stages.wall_s, solve))
            with stages.watcher.guard():
                place = folder.publish()
        except RunInterrupted:
            raise
        except Exception as error:
            if stages.watcher.stop_requested():
                raise RunInterrupted from error
            provenance = _provenance(scenario, command, started, stages.wall_s, None)
            raise _failed(folder, provenance, error) from error
    return RunResult(place, metrics, [place / "figures" / name for name in pictures])


def _fill(
    folder: RunFolder, scenario: Scenario, stages: _Stages, figures: bool
) -> tuple[dict[str, Any], SolveRecord, list[str]]:
    """Compute everything and write each part as soon as it is there; metrics, solve and the names of the pictures."""
    (folder.path / "scenario.toml").write_text(dump_scenario(scenario), encoding="utf-8")
    with stages("solve"), stages.watcher.guard():
        truth = simulate(scenario, stages.watcher.solving, stages.watcher.stop_requested)
    with stages("truth tables"):
        _write_truth(folder.path, truth)
    with stages("sensors and estimators"):
        observed = observe(scenario, truth)
    with stages("tables"):
        write_stream(folder.path / "readings" / "imu.parquet", observed.imu)
        write_stream(folder.path / "readings" / "balises.parquet", observed.balises)
        for name, estimate in observed.estimates.items():
            write_stream(folder.path / "estimates" / f"{display_name(name)}.parquet", estimate)
    with stages("metrics"):
        errors = {
            name: estimator_errors(truth.motion, observed.balises, estimate)
            for name, estimate in observed.estimates.items()
        }
        metrics = metrics_tree(
            truth.solve,
            stop_metrics(truth, shortest_stop(scenario, truth)),
            wheelset_metrics(truth.motion, truth.wheelsets),
            {display_name(name): estimator_metrics(error) for name, error in errors.items()},
        )
        folder.write_json("metrics.json", metrics)
    pictures: list[str] = []
    if figures:
        with stages("figures"):
            from scenarios.figures import write_figures  # matplotlib is slow to import

            pictures = write_figures(
                folder.path / "figures",
                truth,
                observed.imu,
                scenario.imu,
                observed.balises,
                observed.estimates,
                errors,
                adhesion_along_rail(scenario, truth),
                track_of(scenario).irregularities,
            )
    return metrics, truth.solve, pictures


def _write_truth(path: Path, truth: Truth) -> None:
    write_stream(path / "truth.parquet", truth.motion)
    write_stream(path / "wheelsets.parquet", truth.wheelsets)
    write_stream(path / "brake.parquet", truth.brake)
    write_stream(path / "rail.parquet", truth.rail)
    write_stream(path / "readings" / "tachometers.parquet", truth.tachometer)
    write_stream(path / "readings" / "axle-speeds.parquet", truth.axle_speeds)


def _failed(folder: RunFolder, provenance: dict[str, Any], error: Exception) -> RunFailed:
    """Keep what there is, the truth up to a failed solve included; a full disk may leave even less."""
    if isinstance(error, SolveFailed):
        reason = story = str(error)
        if error.__cause__ is not None and error.__cause__.__cause__ is not None:  # a controller's own error
            story = "".join(traceback.format_exception(error.__cause__.__cause__))
    else:
        reason = f"{type(error).__name__}: {error}"
        story = "".join(traceback.format_exception(error))
    try:
        folder.write_json("provenance.json", provenance)
        if isinstance(error, SolveFailed) and isinstance(error.partial, Truth):
            _write_truth(folder.path, error.partial)
        return RunFailed(reason, folder.publish_failed(story))
    except OSError as second:
        return RunFailed(f"{reason} (and what it had could not be kept: {second})", None)


def _provenance(
    scenario: Scenario,
    command: Sequence[str],
    started: datetime,
    wall_s: dict[str, float],
    solve: SolveRecord | None,
) -> dict[str, Any]:
    """What produced a run. Wall times stand here and in the metrics' `solve` only."""
    return {
        "program": PROGRAM,
        "versions": {
            PROGRAM: version(PROGRAM),
            "python": platform.python_version(),
            **{package: version(package) for package in RECORDED_PACKAGES},
        },
        "sources": source_fingerprint(),
        "platform": {
            "system": platform.platform(),
            "machine": platform.machine(),
            "cores": os.cpu_count(),
        },
        "seeds": {"world": scenario.scenario.world_seed, "sensor": scenario.scenario.sensor_seed},
        "presets": scenario.presets,
        "command": list(command),
        "started": started.isoformat(timespec="seconds"),
        "wall_s": wall_s,
        "solve": asdict(solve) if solve else None,
    }
