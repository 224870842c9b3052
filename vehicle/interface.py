"""What the coach exchanges with those who work it within a run: its state, what acts on it, and who is called when."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from vehicle.layout import ACTUATION, SPIN
from vehicle.observation import OBSERVATION, observe
from wheel_rail.compiled import address_of


class Actuation:
    """What acts on the coach during one step.

    Per wheelset (4,): `brake_torque_nm`, friction torque that the brake can hold, >= 0 (whether it slides or sticks
    comes out of the motion), and `drive_torque_nm`, positive forwards. Per bogie (2,): `track_brake_force_n`, friction
    of its magnets on the rails, >= 0. All three are views of `numbers` (10,). `sanders` (m, 3): rows of
    `wheel_rail.sanding.Sanders`.
    """

    def __init__(self, sanders: np.ndarray | None = None) -> None:
        self.numbers = np.zeros(ACTUATION)
        self.brake_torque_nm = self.numbers[:4]
        self.drive_torque_nm = self.numbers[4:8]
        self.track_brake_force_n = self.numbers[8:]
        self.sanders = np.zeros((0, 3)) if sanders is None else sanders


class CoachState:
    """The coach at the instant of a callback; arrays are views that change from step to step and end with the run.

    `address`: of the coach's record, for compiled code.
    """

    def __init__(self, q: np.ndarray, v: np.ndarray, record: np.ndarray) -> None:
        self._record = record
        self.address = address_of(record)
        self._velocity = v[:3]
        self._place = record["s"][0]
        self._rows, self._first_row = np.zeros(0, OBSERVATION), 0
        self.wheel_angle_rad = q[SPIN : SPIN + 4]
        self.wheel_rate_radps = v[SPIN : SPIN + 4]

    @property
    def position_m(self) -> float:
        """Place of the carbody's centre along the track (within a millimetre)."""
        place: float = self._place.item(4)
        return place

    @property
    def speed_mps(self) -> float:
        """Speed of the carbody's centre."""
        x, y, z = self._velocity.tolist()
        return math.sqrt(x * x + y * y + z * z)

    @property
    def observed(self) -> np.void:
        """The coach's record (dtype `COACH`) as `observe` left it: rotations, track frames, reports of the contacts."""
        record: np.void = self._record[0]
        return record

    def observe(self, t_s: float, rows: np.ndarray, row: int) -> None:
        """Write the full observation into `rows[row]`, a contiguous array of dtype `OBSERVATION`."""
        if rows is not self._rows:
            self._rows, self._first_row = rows, address_of(rows)
        observe(t_s, self.address, self._first_row + row * OBSERVATION.itemsize)


OnStep = Callable[[float, CoachState], Actuation | None]


@dataclass(frozen=True)
class Plant:
    """Compiled work within a run: `function`, the address of a C function int64(int64, double), is called with
    `argument` and the time every `period_s`, a whole multiple of the step, and may change the actuation.

    When it answers anything but 0, `refused` is called with the time and that answer, and raises what the run ends by.
    """

    function: int
    argument: int
    period_s: float
    refused: Callable[[float, int], NoReturn]
