"""Stops on the cores, and what is kept of them: a second call goes on where the first one stopped.

A stop's outcome depends on the stop alone: each is loaded and run from its settings, in whichever process.
"""

import hashlib
import json
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

from pydantic import TypeAdapter

from scenarios.compile_cache import source_fingerprint
from scenarios.errors import RunFailed, RunInterrupted
from scenarios.interruption import Interruption
from scenarios.scenario_file import dump_scenario
from scenarios.schema import Scenario
from scenarios.wsp_test.programme import Stop
from scenarios.wsp_test.scorecard import Score
from scenarios.wsp_test.worker import StopRequested, begin, work

Item = TypeVar("Item")
Done = TypeVar("Done")
SCORE: TypeAdapter[Score] = TypeAdapter(Score)


class Workers:
    """Context of some processes (spawn) that work off items; a single one is this process itself.

    Leaving it by an exception, Ctrl-C as a rule, lets the stops that are running break off and waits for that.
    """

    def __init__(self, count: int, interruption: Interruption) -> None:
        self._interruption = interruption
        self._executor: ProcessPoolExecutor | None = None
        if count > 1:
            spawn = multiprocessing.get_context("spawn")
            self._stop = spawn.Event()
            self._executor = ProcessPoolExecutor(count, mp_context=spawn, initializer=begin, initargs=(self._stop,))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._executor is not None:
            if kind is not None:
                self._stop.set()
            self._executor.shutdown(wait=True, cancel_futures=True)

    def each(
        self, function: Callable[[Item, StopRequested], Done], items: Sequence[Item]
    ) -> Iterator[tuple[Item, Done]]:
        """Every item and what `function(item, stop_requested)` made of it, in the order in which they are ready.

        Raises RunFailed if a worker process dies, RunInterrupted or KeyboardInterrupt on Ctrl-C.
        """
        if self._executor is None:
            for item in items:
                with self._interruption.deferred():
                    done = function(item, self._interruption.requested)
                if self._interruption.requested():
                    raise RunInterrupted
                yield item, done
            return
        with _workers_ignore_ctrl_c():
            pending = {self._executor.submit(work, function, item): item for item in items}
        while pending:
            ready, _ = wait(pending, return_when=FIRST_COMPLETED)
            for future in ready:
                item = pending.pop(future)
                try:
                    yield item, future.result()
                except BrokenProcessPool:
                    raise RunFailed("a worker process died; the stops finished before are kept", None) from None


@contextmanager
def _workers_ignore_ctrl_c() -> Iterator[None]:
    """Processes started in here ignore Ctrl-C from their first instruction on, until `begin` says so itself."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


class KeptStops:
    """The folder of finished stops: a file each, with the key of what it was computed from."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def find(self, name: str, key: str) -> Score | None:
        """The score kept under this name, if it was computed from the same as `key` says."""
        try:
            kept = json.loads((self._folder / f"{name}.json").read_text(encoding="utf-8"))
            return SCORE.validate_python(kept["score"]) if kept["key"] == key else None
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def keep(self, name: str, key: str, score: Score) -> None:
        """Write a finished stop, whole or not at all."""
        content: dict[str, Any] = {"name": name, "key": key, "score": SCORE.dump_python(score, mode="json")}
        text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
        partial = self._folder / f".{name}.{os.getpid()}.partial"
        partial.write_text(text, encoding="utf-8")
        partial.replace(self._folder / f"{name}.json")


def stop_key(stop: Stop, scenario: Scenario) -> str:
    """Digest of all that a stop's score follows from: program, resolved scenario, files that it names, scoring."""
    text = dump_scenario(scenario)
    digest = hashlib.sha256(f"{source_fingerprint()}\0{text}\0{stop.scoring.model_dump_json()}".encode())
    for file in sorted(set(_files_named(scenario.model_dump(mode="json")))):
        digest.update(f"\0{file}\0".encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()


def _files_named(tree: Any) -> Iterator[Path]:
    """Files of the user's own: values that are paths, begin with one as in `path/to/file.py:Name`, or run folders."""
    if isinstance(tree, dict):
        for value in tree.values():
            yield from _files_named(value)
    elif isinstance(tree, list):
        for value in tree:
            yield from _files_named(value)
    elif isinstance(tree, str) and 0 < len(tree) < 4096 and "\0" not in tree:
        for candidate in (tree, tree.rpartition(":")[0], f"{tree}/brake.parquet"):
            if candidate and Path(candidate).is_file():
                yield Path(candidate)
