"""What a WSP controller is: it sees the tachometers' axle speeds at its own period and commands the magnet valves."""

from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from wsp.valves import FILL

AXLES = 4


class ControllerOutput:
    """Commands of one tick: valve (4,) int8 FILL/HOLD/VENT, sand (4,) bool, track_brake.

    And the reference speed, m/s >= 0 (nan: has none).

    Sand, for the sanders of each wheelset, and the track brake are wishes: a coach that carries none of either does
    not answer them. A controller may reuse one output: copy what is to outlive the next step.
    """

    __slots__ = ("reference_speed_mps", "sand", "track_brake", "valve")

    def __init__(self) -> None:
        self.valve: NDArray[np.int8] = np.full(AXLES, FILL, dtype=np.int8)
        self.sand: NDArray[np.bool_] = np.zeros(AXLES, dtype=np.bool_)
        self.track_brake: bool = False
        self.reference_speed_mps: float = np.nan


class Controller(Protocol):
    """Adds no delay of its own to the link: the co-simulation lets the output of one tick act from the next one on."""

    Parameters: ClassVar[type[BaseModel]]
    """The keys of its section [wsp.parameters]; the class is built by Class(parameters)."""
    period_s: float

    def __init__(self, parameters: Any) -> None: ...

    def reset(self, t_s: float, direction: int) -> None:
        """Forget everything; the first step follows. direction of travel: +1 forward, -1 backward."""

    def step(
        self,
        t_s: float,
        axle_speed_mps: NDArray[np.float64],
        valid: NDArray[np.bool_],
        demand: float,
        direction: int,
        outside_reference_mps: float,
    ) -> ControllerOutput:
        """One tick; axle_speed_mps (4,) signed, positive forward; valid (4,); demand 0..1.

        outside_reference_mps is a speed of the train found elsewhere, nan = none.
        """
