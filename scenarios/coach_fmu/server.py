"""The Python process of one coach FMU, as its library starts it.

    python -m scenarios.coach_fmu.server RESOURCES      (a connected socket as standard input)

What goes over the socket is written down in `scenarios.coach_fmu.tool`.
"""

import gc
import os
import signal
import socket
import sys
from pathlib import Path


def main() -> None:
    """Entry point of the process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in the host's terminal is the host's affair
    connected = _take_socket()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(100_000, 20, 20)
    from scenarios.compile_cache import use_compile_cache

    use_compile_cache()
    from scenarios.coach_fmu.tool import Connection, serve  # brings compiled code along

    serve(Connection(connected), Path(sys.argv[1]))


def _take_socket() -> socket.socket:
    """The socket that is standard input, moved to where nobody who reads or prints meets it."""
    connected = socket.socket(fileno=os.dup(0))
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    return connected


if __name__ == "__main__":
    main()
