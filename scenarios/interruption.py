"""Ctrl-C without an exception inside the solver: the signal sets a flag that the co-simulation polls."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any, Self

CAUGHT = (signal.SIGINT, signal.SIGTERM)
HAS_TIMER = hasattr(signal, "setitimer")
PATIENCE_S = 3.0
"""If the flag is not seen for so long (compiling, say), the interruption is raised after all."""


class Interruption:
    """Context in which SIGINT and SIGTERM are caught.

    Inside `deferred()` the first signal only makes `requested()` true; a second one, or `PATIENCE_S`, raises
    KeyboardInterrupt. Outside of it the signal raises KeyboardInterrupt at once.
    """

    def __init__(self) -> None:
        self.number: int | None = None
        self._deferring = False
        self._before: dict[int, Any] = {}

    def requested(self) -> bool:
        return self.number is not None

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():  # Python hands signals to no other
            self._before = {number: signal.signal(number, self._on_signal) for number in CAUGHT}
            if HAS_TIMER:
                self._before[signal.SIGALRM] = signal.signal(signal.SIGALRM, _raise)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    @contextmanager
    def deferred(self) -> Iterator[None]:
        """Context of the solve, and of whatever else must not be broken off half way."""
        self._deferring = True
        try:
            yield
        finally:
            self._deferring = False
            if HAS_TIMER:
                signal.setitimer(signal.ITIMER_REAL, 0.0)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        repeated = self.number is not None
        self.number = number
        if repeated or not self._deferring:
            raise KeyboardInterrupt
        if HAS_TIMER:
            signal.setitimer(signal.ITIMER_REAL, PATIENCE_S)


def _raise(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
