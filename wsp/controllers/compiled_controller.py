"""The shell of a controller whose tick is one C function over one record: constants, state, inputs and output."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cache
from typing import Any, ClassVar

import numpy as np
from numba import cfunc, from_dtype, types
from numpy.typing import NDArray

from wsp.compiled import OPTIONS, call_at
from wsp.controllers.interface import INPUT, OUTPUT, ControllerOutput
from wsp.controllers.records import record_of
from wsp.controllers.supervision import supervision_constants, supervision_state

Tick = Callable[..., int]
"""tick(record, t_s): fills in `record.output`, of OUTPUT, by `record.inputs`, of INPUT, and the record's other parts,
`state` and `constants`; 0. A plain function, which is compiled as the C function that it is called as."""


@cache  # which keeps it alive
def _compiled_tick(tick: Tick, record: np.dtype) -> Any:
    # compiled code hands a record on by its address
    return cfunc(types.int64(from_dtype(record), types.float64), **OPTIONS)(tick)


class CompiledController(ABC):
    """To be derived from: a class gives its tick, and what it adds to the supervision's constants and state.

    For a tick without Python compiled code writes what stands at the address `inputs_at`, of INPUT, and calls the C
    function int64(int64, double) at `tick_at` with `record_at` and the time; the answer then stands where that of
    `step` does. All of this stays in its place as long as the controller lives.
    """

    period_s = 0.01
    _tick: ClassVar[Tick]

    def __init__(self, parameters: Any) -> None:
        self.parameters = parameters
        # The supervision's come last: of records that begin alike numba takes the longer for a kind of the shorter, and
        # warns that it does.
        constants = {**self._own_constants(parameters), **supervision_constants(parameters, self.period_s)}
        self._first_state = record_of({**self._own_state(), **supervision_state(parameters, self.period_s)})[0]
        parts = {
            "constants": record_of(constants)[0],
            "state": self._first_state,
            "inputs": np.zeros((), INPUT),
            "output": np.zeros((), OUTPUT),
        }
        self._record = record_of(parts)
        self._output = ControllerOutput(self._record["output"])
        inputs = self._record["inputs"]
        self._axle_speed_mps = inputs["axle_speed_mps"][0]
        self._valid = inputs["valid"][0].view(np.bool_)
        self._others = inputs[["demand", "direction", "outside_reference_mps"]]
        self.tick_at = int(_compiled_tick(type(self)._tick, self._record.dtype).address)
        self.record_at: int = self._record.ctypes.data
        self.inputs_at: int = inputs.ctypes.data

    @property
    def needs_no_python(self) -> bool:
        """Whether its compiled tick is all that `step` does: a class may put Python of its own around it."""
        return type(self).step is CompiledController.step

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
        self._axle_speed_mps[:] = axle_speed_mps
        self._valid[:] = valid
        self._others[0] = demand, direction, outside_reference_mps
        call_at(self.tick_at, self.record_at, t_s)
        return self._output
