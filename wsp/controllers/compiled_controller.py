"""The shell of a controller whose tick is one compiled function over one record: constants, state and output."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from wsp.controllers.interface import OUTPUT, ControllerOutput
from wsp.controllers.records import record_of
from wsp.controllers.supervision import supervision_constants, supervision_state

Tick = Callable[..., None]
"""tick(records (1,), axle_speed_mps, valid, demand, direction, outside_mps): fills in `records[0].output`, of OUTPUT,
by the record's other parts, `state` and `constants`."""


class CompiledController(ABC):
    """To be derived from: a class gives its tick, and what it adds to the supervision's constants and state."""

    period_s = 0.01
    _tick: ClassVar[Tick]

    def __init__(self, parameters: Any) -> None:
        self.parameters = parameters
        # The supervision's come last: of records that begin alike numba takes the longer for a kind of the shorter, and
        # warns that it does.
        constants = {**self._own_constants(parameters), **supervision_constants(parameters, self.period_s)}
        self._first_state = record_of({**self._own_state(), **supervision_state(parameters, self.period_s)})[0]
        parts = {"constants": record_of(constants)[0], "state": self._first_state, "output": np.zeros((), OUTPUT)}
        self._record = record_of(parts)
        self._output = ControllerOutput(self._record["output"])

    @abstractmethod
    def _own_constants(self, parameters: Any) -> dict[str, Any]:
        """Constants by name, besides the supervision's."""

    @abstractmethod
    def _own_state(self) -> dict[str, Any]:
        """State by name as a run begins, besides the supervision's."""

    def reset(self, t_s: float, direction: int) -> None:
        """Forget speeds, wheel ratios, what was done to the brakes and what was learnt."""
        self._record["state"] = self._first_state
        self._output.withdraw()

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
        self._tick(self._record, axle_speed_mps, valid, demand, direction, outside_reference_mps)
        return self._output
