"""What a WSP controller is: it sees the tachometers' axle speeds at its own period and commands the magnet valves."""

from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from wsp.valves import FILL

AXLES = 4


INPUT = np.dtype(
    [
        ("axle_speed_mps", "f8", (AXLES,)),
        ("demand", "f8"),
        ("outside_reference_mps", "f8"),
        ("direction", "i8"),
        ("valid", "u1", (AXLES,)),
    ],
    align=True,
)
"""What a controller is given at a tick (see `Controller.step`), for compiled code."""

OUTPUT = np.dtype(
    [("reference_speed_mps", "f8"), ("valve", "i1", (AXLES,)), ("sand", "u1", (AXLES,)), ("track_brake", "u1")],
    align=True,
)
"""What a `ControllerOutput` says, for compiled code."""


class ControllerOutput:
    """Commands of one tick: valve (4,) int8 FILL/HOLD/VENT, sand (4,) bool, track_brake.

    And the reference speed, m/s >= 0 (nan: has none).

    Sand, for the sanders of each wheelset, and the track brake are wishes: a coach that carries none of either does
    not answer them. A controller may reuse one output: copy what is to outlive the next step.
    """

    __slots__ = ("_reference_speed_mps", "_sand", "_track_brake", "_valve", "address")

    def __init__(self, record: np.ndarray | None = None) -> None:
        """`record`: (1,) of OUTPUT in which it is to stand, if it is not to have one of its own."""
        record = np.zeros(1, OUTPUT) if record is None else record
        self.address: int = record.ctypes.data
        """Where its record stands, as long as this object lives."""
        self._valve: NDArray[np.int8] = record["valve"][0]
        self._sand: NDArray[np.bool_] = record["sand"][0].view(np.bool_)
        self._track_brake = record["track_brake"]
        self._reference_speed_mps = record["reference_speed_mps"]
        self.withdraw()

    def withdraw(self) -> None:
        """Command and wish nothing, without a reference speed."""
        self._valve[:] = FILL
        self._sand[:] = False
        self._track_brake[0] = False
        self._reference_speed_mps[0] = np.nan

    @property
    def valve(self) -> NDArray[np.int8]:
        """(4,) valve codes."""
        return self._valve

    @valve.setter
    def valve(self, codes: NDArray[np.int8]) -> None:
        self._valve[:] = codes

    @property
    def sand(self) -> NDArray[np.bool_]:
        """(4,) whether a wheelset's sanders are to sand."""
        return self._sand

    @sand.setter
    def sand(self, wishes: NDArray[np.bool_]) -> None:
        self._sand[:] = wishes

    @property
    def track_brake(self) -> bool:
        """Whether the track brake is to act."""
        return bool(self._track_brake[0])

    @track_brake.setter
    def track_brake(self, wish: bool) -> None:
        self._track_brake[0] = bool(wish)

    @property
    def reference_speed_mps(self) -> float:
        """The train's speed as the controller has it, nan if it has none."""
        return self._reference_speed_mps.item()

    @reference_speed_mps.setter
    def reference_speed_mps(self, speed_mps: float) -> None:
        self._reference_speed_mps[0] = speed_mps


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
