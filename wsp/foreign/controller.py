"""What the co-simulation sees of a foreign controller: a Controller like any other, one round trip per tick."""

import math
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wsp.controllers.interface import ControllerOutput
from wsp.foreign.errors import ControllerFailed, UnusableController
from wsp.foreign.frames import REPLY, REQUEST, RESET, STEP
from wsp.foreign.parameters import ForeignParameters
from wsp.foreign.process import Broken, WorkerProcess
from wsp.foreign.signals import AXLES, NONE
from wsp.valves import FILL, VENT

_NOT_ASKED = (0.0,) * 6, (0,) * AXLES


class ForeignController:
    """A C shared library or an FMU, in a process of its own that begins and ends with this object.

    Building it raises UnusableController (a ValueError) when the file cannot serve; reset and step raise
    ControllerFailed when it crashes, does not answer in time, reports an error or answers nonsense.
    """

    Parameters = ForeignParameters
    file: ClassVar[Path]

    def __init__(self, parameters: ForeignParameters) -> None:
        limits = parameters.process
        self.parameters = parameters
        self.period_s = limits.period_s
        self._limit_s = limits.tick_limit_s
        self._output = ControllerOutput()
        task = {
            "file": str(self.file.absolute()),
            "period_s": limits.period_s,
            "parameters": parameters.own,
            "variables": parameters.variables,
        }
        if parameters.variables and self.file.suffix != ".fmu":
            raise UnusableController("parameters.variables: names the variables of an FMU, which this is not")
        try:
            self._process = WorkerProcess(task, limits.start_limit_s)
        except Broken as error:
            told = str(error)
            by_key = told.startswith("parameters.")
            raise UnusableController(told if by_key else f"controller = {str(self.file)!r}: {told}") from None

    def close(self) -> None:
        """End its process, for those who do not want to wait until this object is gone."""
        self._process.close()

    def reset(self, t_s: float, direction: int) -> None:
        """Forget everything; raises ControllerFailed."""
        speeds, valid = _NOT_ASKED
        try:
            self._process.ask(REQUEST.pack(RESET, t_s, *speeds, *valid, direction), self._limit_s)
        except Broken as error:
            raise ControllerFailed(f"{self._name} at its reset: {error}") from None
        self._output = ControllerOutput()

    def step(
        self,
        t_s: float,
        axle_speed_mps: NDArray[np.float64],
        valid: NDArray[np.bool_],
        demand: float,
        direction: int,
        outside_reference_mps: float,
    ) -> ControllerOutput:
        """One tick, see wsp.controllers.Controller; the same output object each time. Raises ControllerFailed."""
        speeds = axle_speed_mps.tolist()
        if not math.isfinite(sum(speeds)):
            speeds = [speed if math.isfinite(speed) else 0.0 for speed in speeds]
        outside = outside_reference_mps if outside_reference_mps == outside_reference_mps else NONE
        request = REQUEST.pack(STEP, t_s, *speeds, demand, outside, *valid.tolist(), direction)
        try:
            reply = self._process.ask(request, self._limit_s)
        except Broken as error:
            raise ControllerFailed(f"{self._name} at t = {t_s:.2f} s: {error}") from None
        _, reference, *codes = REPLY.unpack(reply)
        valve, sand, track_brake = codes[:AXLES], codes[AXLES : 2 * AXLES], codes[2 * AXLES]
        if not math.isfinite(reference):
            self._refuse(t_s, f"reference_speed_mps = {reference}", "a finite speed, or negative if there is none")
        if min(valve) < FILL or max(valve) > VENT:
            self._refuse(t_s, f"valve = {valve}", "0 (fill), 1 (hold) or 2 (vent) for every axle")
        if {*sand, track_brake} - {0, 1}:
            self._refuse(t_s, f"sand = {sand}, track_brake = {track_brake}", "0 or 1")
        output = self._output
        output.valve[:] = valve
        output.sand[:] = sand
        output.track_brake = track_brake == 1
        output.reference_speed_mps = reference if reference >= 0.0 else math.nan
        return output

    @property
    def _name(self) -> str:
        return f"controller {self.file.name}"

    def _refuse(self, t_s: float, given: str, must: str) -> None:
        self._process.close()
        raise ControllerFailed(f"{self._name} at t = {t_s:.2f} s: gave {given}, must be {must}")


def foreign_controller(file: Path) -> type[ForeignController]:
    """The controller class of a shared library or, if it ends in .fmu, an FMU; instantiating it reads the file."""
    return type("ForeignController", (ForeignController,), {"file": file, "__doc__": f"Controller from {file.name}."})
