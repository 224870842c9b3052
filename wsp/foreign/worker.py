"""The process of a foreign controller: loads it, then answers one frame after the other until the pipe ends.

Whatever the controller prints goes to this process's error output, which the other side keeps. The process ends with
the one that started it, even while the controller is busy.
"""

import ctypes
import io
import json
import os
import select
import shutil
import signal
import sys
import threading
from typing import Any, Protocol

from wsp.foreign.errors import UnusableController
from wsp.foreign.frames import BODY_AT, END, REPLY, REQUEST, RESET, Input, Output
from wsp.foreign.signals import NONE


class Loaded(Protocol):
    """A controller in this process."""

    def reset(self, t_s: float, direction: int) -> None: ...
    def step(self, given: Input, answer: Output) -> None: ...
    def end(self) -> None: ...


def main() -> None:
    """`sys.argv[1]` is JSON: file, folder (of its own, or null), period_s, parameters, variables."""
    task = json.loads(sys.argv[-1])
    requests, replies = _take_standard_streams()
    _limit_damage()
    threading.Thread(target=_end_with_parent, args=(requests.fileno(), task["folder"]), daemon=True).start()
    reply = bytearray(REPLY.size)
    try:
        loaded = _load(task)
    except UnusableController as error:
        _answer(replies, reply, str(error))
        return
    except Exception as error:
        _answer(replies, reply, f"cannot be loaded: {type(error).__name__}: {error}")
        return
    _answer(replies, reply)
    if not _serve(loaded, requests, replies, reply):
        _vanish(task["folder"])


def _load(task: dict[str, Any]) -> Loaded:
    file, period_s, parameters = task["file"], task["period_s"], task["parameters"]
    if file.endswith(".fmu"):
        from wsp.foreign.fmu import FmuController

        return FmuController(file, task["folder"], period_s, parameters, task["variables"])
    from wsp.foreign.c_library import LibraryController

    return LibraryController(file, period_s, parameters)


def _serve(loaded: Loaded, requests: io.FileIO, replies: io.FileIO, reply: bytearray) -> bool:
    """Answer until told to end; False if the pipe ended before that."""
    request = bytearray(REQUEST.size)
    given = Input.from_buffer(request, BODY_AT)
    answer = Output.from_buffer(reply, BODY_AT)
    nothing_said = bytes(len(reply) - BODY_AT)
    while requests.readinto(request) == len(request):
        asked = int.from_bytes(request[:BODY_AT], sys.byteorder)
        reply[BODY_AT:] = nothing_said
        answer.reference_speed_mps = NONE
        text = ""
        try:
            if asked == END:
                loaded.end()
                return True
            if asked == RESET:
                loaded.reset(given.t_s, given.direction)
            else:
                loaded.step(given, answer)
        except Exception as error:
            text = str(error) or type(error).__name__
        _answer(replies, reply, text)
    return False


def _answer(replies: io.FileIO, reply: bytearray, text: str = "") -> None:
    words = text.encode("utf-8", "replace")[:4000]
    reply[:BODY_AT] = len(words).to_bytes(BODY_AT, sys.byteorder)
    replies.write(reply + words)


def _take_standard_streams() -> tuple[io.FileIO, io.FileIO]:
    """The pipes for the frames, taken away from where a controller might read or print.

    The C library's own buffer is switched off, so that the last words of a crashing controller are not lost.
    """
    requests = io.FileIO(os.dup(0), "rb")
    replies = io.FileIO(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    try:
        libc = ctypes.CDLL(None)
        stdout = ctypes.c_void_p.in_dll(libc, "__stdoutp" if sys.platform == "darwin" else "stdout")
        libc.setvbuf(stdout, None, 2, ctypes.c_size_t(0))  # 2 is _IONBF
    except (AttributeError, ValueError, OSError):  # a C library that calls it otherwise
        pass
    return requests, replies


def _limit_damage() -> None:
    """No core dumps in the user's folder."""
    import resource

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _end_with_parent(requests: int, folder: str | None) -> None:
    """Wait until nobody holds the other end of the pipe: then the parent is gone, and so is the need for this process.

    ctypes lets this thread run while the controller computes, or hangs.
    """
    poll = select.poll()
    poll.register(requests, 0)  # not for input: for the end alone
    poll.poll()
    _vanish(folder)


def _vanish(folder: str | None) -> None:
    """Leave nothing behind: neither the folder nor what the controller may have started."""
    if folder is not None:
        shutil.rmtree(folder, ignore_errors=True)
    if os.getpgrp() == os.getpid():
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


if __name__ == "__main__":
    main()
