"""The shell of a controller whose tick is one compiled function over a record of its state and one of its constants."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from wsp.controllers.interface import ControllerOutput
from wsp.controllers.records import record_of
from wsp.controllers.supervision import supervision_constants, supervision_state
from wsp.valves import FILL

Tick = Callable[..., tuple[float, bool]]
"""tick(state (1,), constants (1,), valve, sand, axle_speed_mps, valid, demand, direction, outside_mps) -> reference
speed and whether the track brake is wanted: fills in valve codes (4,) and sand (4,)."""


class CompiledController(ABC):
    """To be derived from: a class gives its tick, and what it adds to the supervision's constants and state."""

    period_s = 0.01
    _tick: ClassVar[Tick]

    def __init__(self, parameters: Any) -> None:
        self.parameters = parameters
        self._output = ControllerOutput()
        # The supervision's come last: of records that begin alike numba takes the longer for a kind of the shorter, and
        # warns that it does.
        constants = {**self._own_constants(parameters), **supervision_constants(parameters, self.period_s)}
        self._constants = record_of(constants)
        self._first_state = record_of({**self._own_state(), **supervision_state(parameters, self.period_s)})
        self._state = self._first_state.copy()

    @abstractmethod
    def _own_constants(self, parameters: Any) -> dict[str, Any]:
        """Constants by name, besides the supervision's."""

    @abstractmethod
    def _own_state(self) -> dict[str, Any]:
        """State by name as a run begins, besides the supervision's."""

    def reset(self, t_s: float, direction: int) -> None:
        """Forget speeds, wheel ratios, what was done to the brakes and what was learnt."""
        self._state[:] = self._first_state
        output = self._output
        output.valve[:] = FILL
        output.sand[:] = False
        output.track_brake = False
        output.reference_speed_mps = np.nan

    def step(
        self,
        t_s: float,
        axle_speed_mps: NDArray[np.float64],
        valid: NDArray[np.bool_],
        demand: float,
        direction: int,
        outside_reference_mps: float,
    ) -> ControllerOutput:
        """One tick of 10 ms, see wsp.controllers.Controller; the same output object is returned each time."""
        output = self._output
        output.reference_speed_mps, output.track_brake = self._tick(
            self._state, self._constants, output.valve, output.sand, axle_speed_mps, valid, demand, direction,
            outside_reference_mps,
        )  # fmt: skip
        return output
