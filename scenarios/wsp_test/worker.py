"""What one process does with one stop: run and score it, or draw it. The same in the main process and in a worker."""

import gc
import os
import signal
import threading
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import connection, parent_process
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import TypeVar

from scenarios.cosimulation.simulation import simulate
from scenarios.errors import RunInterrupted, SolveFailed
from scenarios.shortest_stop import shortest_stop
from scenarios.truth import Truth
from scenarios.wsp_test.programme import Stop
from scenarios.wsp_test.scorecard import Score, application, score_stop

Item = TypeVar("Item")
Done = TypeVar("Done")
StopRequested = Callable[[], bool]


@dataclass(frozen=True)
class Scored:
    """What came of a stop: its score, or why it broke down."""

    score: Score | None
    failure: str = ""


def score(stop: Stop, stop_requested: StopRequested) -> Scored:
    """Run a stop and score it. Whatever breaks it down is told, so that the other stops go on."""
    try:
        scenario = stop.load()
        truth = _run(stop, stop_requested)
        span = application(truth)
        shortest_m = shortest_stop(scenario, truth, span[0]) if span is not None else None
        return Scored(score_stop(truth, shortest_m, stop.scoring))
    except RunInterrupted:
        raise
    except SolveFailed as error:
        return Scored(None, str(error))
    except Exception as error:
        return Scored(None, f"{type(error).__name__}: {error}")


def draw(order: tuple[Stop, float | None, Path], stop_requested: StopRequested) -> Path:
    """Run a stop once more, which gives the same again, and draw it; with the braking ratio of full service."""
    from scenarios.figures.style import figure_style, write_png
    from scenarios.wsp_test.stop_figure import draw_stop

    stop, required_ratio, file = order
    truth = _run(stop, stop_requested)
    with figure_style():
        write_png(draw_stop(stop, truth, required_ratio), file)
    return file


def _run(stop: Stop, stop_requested: StopRequested) -> Truth:
    return simulate(stop.load(), lambda *_: None, stop_requested)


_stop: Event | None = None


def begin(stop: Event) -> None:
    """A worker process begins: Ctrl-C is the main process's business, and without that one there is nothing to do."""
    global _stop
    _stop = stop
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.set_threshold(100_000, 20, 20)
    threading.Thread(target=_leave_with_parent, daemon=True).start()


def work(function: Callable[[Item, StopRequested], Done], item: Item) -> Done:
    """Call `function` in a worker process."""
    if _stop is None:
        raise RuntimeError("work() is called in processes that begin() has begun")
    return function(item, _stop.is_set)


def _leave_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)
