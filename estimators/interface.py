"""What an on-board computer has at a tick (`Sample`), what it starts with (`Initial`), what it answers (`Estimate`)."""

import dataclasses
import math
from collections.abc import Iterable
from typing import Protocol

import numpy as np

from sensors.streams import BoolArray, FloatArray, Int8Array, Stream, quantity


@dataclasses.dataclass(frozen=True, slots=True)
class Sample:
    """The readings at one tick.

    `axle_speed_mps` (4,) positive forward and `valid` (4,) at `t_s`; `specific_force_mps2` and `angular_rate_radps`,
    both (3,), as means over the tick, in the sensor's own axes; the position told by a balise passed since the last
    tick and how long ago that was (nan: none passed); direction +1 or -1 of the active cab.
    """

    t_s: float
    axle_speed_mps: FloatArray
    valid: BoolArray
    specific_force_mps2: FloatArray
    angular_rate_radps: FloatArray
    balise_position_m: float = math.nan
    balise_age_s: float = math.nan
    direction: int = 1


@dataclasses.dataclass(frozen=True, slots=True)
class Initial:
    """What a train knows when the estimator starts; standard deviations say how well.

    `imu_roll_rad`, `imu_pitch_rad`: believed mounting angles of the IMU (gravity calibration); its yaw is unknown.
    `pitch_rad`: believed pitch of the carbody (nose down positive), that is minus the gradient.
    """

    t_s: float = 0.0
    position_m: float = 0.0
    position_sd_m: float = 5.0
    speed_mps: float = 0.0
    speed_sd_mps: float = 0.5
    imu_roll_rad: float = 0.0
    imu_pitch_rad: float = 0.0
    pitch_rad: float = 0.0
    pitch_sd_rad: float = 0.01
    direction: int = 1

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if not math.isfinite(value):
                raise ValueError(f"Initial.{field.name}: {value}, wanted a finite number")
            if "_sd_" in field.name and value <= 0.0:
                raise ValueError(f"Initial.{field.name}: {value}, wanted a standard deviation above 0")
        if self.direction not in (-1, 1):
            raise ValueError(f"Initial.direction: {self.direction}, wanted 1 or -1")


@dataclasses.dataclass(frozen=True, slots=True)
class Estimate:
    """An estimator's answer at one tick; nan where it has none. Bounds belong to the estimator's own rule."""

    t_s: float
    position_m: float
    position_lower_m: float
    position_upper_m: float
    speed_mps: float
    speed_lower_mps: float
    speed_upper_mps: float
    acceleration_mps2: float
    gradient_permille: float
    roll_rad: float
    pitch_rad: float
    yaw_rad: float
    direction: int
    valid: bool


class EstimateStream(Stream):
    """Estimates of one run as a record of arrays."""

    t_s: FloatArray = quantity("s", about="time of the tick")
    position_m: FloatArray = quantity("m", about="estimated position along the track")
    position_lower_m: FloatArray = quantity("m", about="lower bound of the position")
    position_upper_m: FloatArray = quantity("m", about="upper bound of the position")
    speed_mps: FloatArray = quantity("m/s", about="estimated speed, positive forward")
    speed_lower_mps: FloatArray = quantity("m/s", about="lower bound of the speed")
    speed_upper_mps: FloatArray = quantity("m/s", about="upper bound of the speed")
    acceleration_mps2: FloatArray = quantity("m/s2", about="estimated acceleration along the track")
    gradient_permille: FloatArray = quantity("permille", about="estimated gradient, positive uphill")
    roll_rad: FloatArray = quantity("rad", about="estimated roll of the carbody")
    pitch_rad: FloatArray = quantity("rad", about="estimated pitch of the carbody, nose down positive")
    yaw_rad: FloatArray = quantity("rad", about="estimated yaw since the start")
    direction: Int8Array = quantity("1", about="direction of travel, +1 forward", dtype=np.int8)
    valid: BoolArray = quantity("1", about="whether the estimate may be used", dtype=np.bool_)

    @classmethod
    def of(cls, estimates: Iterable[Estimate]) -> "EstimateStream":
        """The record of a sequence of estimates."""
        rows = list(estimates)
        names = [field.name for field in dataclasses.fields(Estimate)]
        return cls(**{name: np.array([getattr(row, name) for row in rows]) for name in names})


class Estimator(Protocol):
    """Speed, position or orientation from samples; the same object runs in the loop and afterwards.

    `reset` starts anew from what the train knows; `step` takes the sample of each tick, `period_s` apart.
    """

    @property
    def period_s(self) -> float: ...

    def reset(self, initial: Initial) -> None: ...

    def step(self, sample: Sample) -> Estimate: ...
