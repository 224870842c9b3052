"""The tool that uses the coach's FMU, seen from the process that computes the coach.

Over the socket, all in doubles of this machine: the process first tells the digest of its variables, then answers
requests. A request is a command, its argument, and all values that the tool sets. START (the time to begin with) builds
the coach and answers what it shows at its first tick; STEP (a number of ticks) answers what it shows after them; STOP
ends the run. An answer is a status (0: fine) and the number of bytes that follow: values, or a text. Where the socket
ends, the process ends.
"""

import os
import socket
from pathlib import Path
from typing import NoReturn

import numpy as np

from scenarios.coach_fmu.readouts import Readouts
from scenarios.coach_fmu.variables import GOT, SET, interface_digest, slice_of
from scenarios.cosimulation.outside import View
from scenarios.cosimulation.simulation import simulate
from scenarios.errors import BadInput, SolveFailed
from scenarios.scenario_file import load_scenario
from wsp import FILL, VENT, ControllerOutput

START, STEP = 0, 1
FINE, REFUSED = 0.0, 1.0

_DRIVES = slice_of(SET, "external_driver").start
_DEMAND = slice_of(SET, "demand").start
_TRACTION = slice_of(SET, "traction_n").start
_TRACK_BRAKE = slice_of(SET, "track_brake").start
_VALVES = slice_of(SET, "valve_command")
_SAND = slice_of(SET, "sand")


class Connection:
    """Frames over the socket. The process ends with it: nobody waits then for what it has computed."""

    def __init__(self, connected: socket.socket) -> None:
        self._socket = connected
        self._request = np.zeros(2 + len(SET))
        self._bytes = self._request.data.cast("B")
        self._answer = np.zeros(2 + len(GOT))
        self._answer[1] = 8 * len(GOT)
        self.values = self._answer[2:]
        """(GOT,) what the next answer says; a view."""
        self.set = self._request[2:]
        """(SET,) what the tool has set with its last request; a view."""
        self.tell(interface_digest())

    def receive(self) -> tuple[int, float]:
        """Command and argument of the next request."""
        got = 0
        try:
            while got < len(self._bytes):
                more = self._socket.recv_into(self._bytes[got:])
                if not more:
                    os._exit(0)
                got += more
        except OSError:
            os._exit(0)
        return int(self._request[0]), float(self._request[1])

    def answer(self) -> None:
        """Send `values`."""
        self._send(self._answer.data)

    def tell(self, text: str, status: float = FINE) -> None:
        """Send a text, which may be empty."""
        message = text.encode()[:1000]
        self._send(np.array([status, len(message)]).tobytes() + message)

    def _send(self, frame: memoryview | bytes) -> None:
        try:
            self._socket.sendall(frame)
        except OSError:
            os._exit(0)


class Tool:
    """The tool as the one who works the valves (`cosimulation.Outside`): it sees a tick and answers with a step."""

    def __init__(self, connection: Connection, readouts: Readouts) -> None:
        self._connection = connection
        self._readouts = readouts
        self._output = ControllerOutput()
        self._ticks_left = 1
        self._drives = False
        self._demand = self._traction_n = 0.0

    def tick(self, t_s: float, view: View) -> ControllerOutput | None:
        """Show the end of a step and wait for the next one; None if the tool wants no more."""
        self._readouts.follow(t_s, view)
        self._ticks_left -= 1
        if self._ticks_left == 0:
            if self._drives:
                view.demand = self._demand
            self._readouts.write(t_s, view, self._connection.values)
            self._connection.answer()
            if not self._next_step():
                return None
        if self._drives:
            view.demand, view.traction_n = self._demand, self._traction_n
        return self._output

    def _next_step(self) -> bool:
        """Wait for a step that makes sense; False if the tool stops the run."""
        while True:
            command, ticks = self._connection.receive()
            if command != STEP:
                return False
            fault = self._take(self._connection.set.tolist())
            if not fault:
                self._ticks_left = int(ticks)
                return True
            self._connection.tell(fault, REFUSED)

    def _take(self, values: list[float]) -> str:
        """Take over what the tool has set, or say what is wrong with it."""
        valves, demand, traction_n = values[_VALVES], values[_DEMAND], values[_TRACTION]
        for axle, code in enumerate(valves, 1):
            if not FILL <= code <= VENT:
                return f"valve_command[{axle}] = {code:g}: must be 0 (fill), 1 (hold) or 2 (vent)"
        if not 0.0 <= demand <= 1.0:
            return f"demand = {demand:g}: must be 0 to 1"
        if not 0.0 <= traction_n < np.inf:
            return f"traction_n = {traction_n:g}: must be a finite force, forwards"
        output = self._output
        output.valve[:] = valves
        output.sand[:] = values[_SAND]
        output.track_brake = values[_TRACK_BRAKE] != 0.0
        self._drives = values[_DRIVES] != 0.0
        self._demand, self._traction_n = demand, traction_n
        return ""


def serve(connection: Connection, resources: Path) -> NoReturn:
    """Answer requests until the host is gone."""
    over = ""
    while True:
        command, argument = connection.receive()
        if command == START:
            over = _run(connection, resources, argument)
            connection.tell(over, REFUSED if over else FINE)
        elif command == STEP:
            connection.tell(over, REFUSED)
        else:
            connection.tell("")


def _run(connection: Connection, resources: Path, start_s: float) -> str:
    """One run; why it is over, or nothing if the tool has stopped it. The last request has not been answered yet."""
    try:
        scenario = load_scenario(resources / "scenario.toml")
        truth = simulate(scenario, lambda *_: None, lambda: False, Tool(connection, Readouts(scenario, start_s)))
    except (BadInput, SolveFailed, ValueError) as error:
        return str(error)
    if truth.solve.simulated_s >= scenario.simulation.longest_s:
        return f"the run is over after {truth.solve.simulated_s:g} s, the longest that it can take"
    return ""
