"""The other process of a foreign controller: started, asked with a time limit, and ended with all that it started."""

import contextlib
import json
import math
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import weakref
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

from wsp.foreign.frames import BODY_AT, END, REPLY, REQUEST

FAREWELL_S = 1.0
_WORDS_KEPT = 2000  # bytes of what the controller has printed, the last ones
_LINES_SHOWN = 5

# A bare package stands in for wsp: its own __init__ would bring the compiler along, which takes the better part of a
# second and is of no use there.
_START = """
import sys, types
package = types.ModuleType("wsp")
package.__path__ = [sys.argv[1]]
sys.modules["wsp"] = package
from wsp.foreign.worker import main
main()
"""
_PACKAGE = Path(__file__).parent.parent


class Broken(Exception):
    """The process reported an error, died or did not answer in time, and is gone. The message follows on its name."""


class WorkerProcess:
    """One child process with a pipe each way; what it prints is kept, not shown."""

    def __init__(self, task: Mapping[str, Any], limit_s: float) -> None:
        """Start it and wait until it has loaded what `task` says (see `worker`). Raises Broken."""
        if os.name != "posix":
            raise Broken("needs Linux or macOS: its process could not be kept in bounds on this system")
        folder = tempfile.mkdtemp(prefix="railslide-fmu-") if task["file"].endswith(".fmu") else None
        try:
            child = subprocess.Popen(
                [sys.executable, "-P", "-c", _START, str(_PACKAGE), json.dumps({**task, "folder": folder})],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                bufsize=0,
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
                start_new_session=True,  # Ctrl-C and the terminal are the parent's alone
            )
        except OSError as error:
            if folder is not None:
                shutil.rmtree(folder)
            raise Broken(f"its process cannot be started: {error.strerror}") from None
        self.pid = child.pid
        self.close = weakref.finalize(self, _end, child, folder)
        """Let the controller say farewell and end its process; goes by itself when this object does."""
        self._child = child
        self._words = bytearray()
        self._requests, self._replies, self._output = (
            pipe.fileno() for pipe in (child.stdin, child.stdout, child.stderr) if pipe is not None
        )
        os.set_blocking(self._output, False)
        self._poll = select.poll()
        self._poll.register(self._replies, select.POLLIN)
        self._poll.register(self._output, select.POLLIN)
        self._receive(limit_s, "start_limit_s")

    def ask(self, request: bytes, limit_s: float) -> bytes:
        """The reply to a request. Raises Broken."""
        if not self.close.alive:  # the numbers of its pipes may belong to other files by now
            raise Broken("has been closed")
        try:
            os.write(self._requests, request)
        except BrokenPipeError:
            self._died()
        return self._receive(limit_s, "tick_limit_s")

    def _receive(self, limit_s: float, key: str) -> bytes:
        give_up_s = time.monotonic() + limit_s
        reply = b""
        length = REPLY.size
        while len(reply) < length:
            left_s = give_up_s - time.monotonic()
            if left_s <= 0.0:
                self._fail(f"did not answer within process.{key} = {limit_s:g} s")
            for pipe, _ in self._poll.poll(math.ceil(1000.0 * left_s)):
                if pipe == self._output:
                    self._listen()
                    continue
                part = os.read(pipe, length + 8192)
                if not part:
                    self._died()
                reply += part
                if len(reply) >= REPLY.size:
                    length = REPLY.size + int.from_bytes(reply[:BODY_AT], sys.byteorder)
        if length > REPLY.size:
            self._fail(reply[REPLY.size :].decode("utf-8", "replace"))
        return reply

    def _listen(self) -> None:
        """Take what the controller has printed, so that its pipe never fills, and keep the end of it."""
        with contextlib.suppress(BlockingIOError):
            part = os.read(self._output, 65536)
            if not part:
                with contextlib.suppress(KeyError):
                    self._poll.unregister(self._output)
            self._words = (self._words + part)[-_WORDS_KEPT:]

    def _died(self) -> NoReturn:
        try:
            code = self._child.wait(FAREWELL_S)
        except subprocess.TimeoutExpired:
            self._fail("closed its pipes")
        if code >= 0:
            self._fail(f"ended its process with exit code {code}")
        known = signal.Signals(-code).name if -code in signal.valid_signals() else f"signal {-code}"
        self._fail(f"crashed: killed by {known} ({signal.strsignal(-code)})")

    def _fail(self, what: str) -> NoReturn:
        _kill(self._child)
        self._listen()
        self.close()
        # whatever was printed must not play with the terminal that shows it
        lines = [
            "".join(letter for letter in line if letter.isprintable()).strip()
            for line in self._words.decode("utf-8", "replace").splitlines()
        ]
        shown = " | ".join([line for line in lines if line][-_LINES_SHOWN:])
        raise Broken(f"{what}; it had printed: {shown}" if shown else what)


def _kill(child: "subprocess.Popen[bytes]") -> None:
    """End the process and all that it has started; they are a group of their own."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child.pid, signal.SIGKILL)
    child.wait()


def _end(child: "subprocess.Popen[bytes]", folder: str | None) -> None:
    if child.stdin is not None and child.poll() is None:
        with contextlib.suppress(OSError, subprocess.TimeoutExpired):
            child.stdin.write(REQUEST.pack(END, *(0,) * 12))
            child.wait(FAREWELL_S)
    _kill(child)
    for pipe in (child.stdin, child.stdout, child.stderr):
        if pipe is not None:
            pipe.close()
    if folder is not None:
        shutil.rmtree(folder, ignore_errors=True)
