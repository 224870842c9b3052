"""A wheel slide protection in Python. example_controller.c is the same law, line by line.

[wsp]
controller = "example_controller.py:ExampleController"
[wsp.parameters]
vent_slip = 0.12
"""

import math

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from wsp import FILL, HOLD, VENT, ControllerOutput


class ExampleParameters(BaseModel):
    """What [wsp.parameters] may hold; an unknown key or a value out of bounds is refused before the run."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    vent_slip: float = Field(default=0.10, gt=0.0, lt=1.0, description="slip above which an axle is vented")
    hold_slip: float = Field(default=0.03, gt=0.0, lt=1.0, description="slip above which it is held")
    slip_offset_mps: float = Field(default=0.4, ge=0.0, description="added to both: matters at low speed")
    vent_below_mps2: float = Field(default=-3.0, lt=0.0, description="an axle that slows down faster is vented")
    fall_limit_mps2: float = Field(default=1.8, gt=0.0, description="the train does not slow down faster")
    filter_ticks: float = Field(default=4.0, ge=1.0, description="time constant of the acceleration")
    pulse_ticks: int = Field(default=3, ge=1, description="a refilling pulse lasts so long ...")
    cycle_ticks: int = Field(default=9, ge=1, description="... and comes so often")
    cut_off_mps: float = Field(default=1.0, ge=0.0, description="below, the driver's brake acts unchanged")
    watchdog_ticks: int = Field(default=600, ge=1, description="an axle unfilled for so long is filled")


class ExampleController:
    """Vents an axle that slips or slows down too much, holds it while it catches up, refills it in pulses."""

    Parameters = ExampleParameters
    period_s = 0.01

    def __init__(self, parameters: ExampleParameters) -> None:
        self.parameters = parameters
        self._output = ControllerOutput()
        self.reset(0.0, 1)

    def reset(self, t_s: float, direction: int) -> None:
        """Forget everything."""
        self._reference_mps = -1.0  # none yet
        self._speed_mps = [-1.0] * 4
        self._acceleration_mps2 = [0.0] * 4
        self._in_cycle = [-1] * 4  # ticks since the last pulse began, -1: the axle is left alone
        self._unfilled = [0] * 4  # ticks since it was last filled

    def step(
        self,
        t_s: float,
        axle_speed_mps: NDArray[np.float64],
        valid: NDArray[np.bool_],
        demand: float,
        direction: int,
        outside_reference_mps: float,
    ) -> ControllerOutput:
        """One tick: what it answers here acts from the next tick on."""
        p, output = self.parameters, self._output
        speeds = [direction * speed for speed in axle_speed_mps.tolist()]
        for axle in range(4):
            if not valid[axle]:
                self._speed_mps[axle] = -1.0
                continue
            speed = speeds[axle] if speeds[axle] > 0.0 else 0.0
            before = self._speed_mps[axle]
            if before < 0.0:
                self._acceleration_mps2[axle] = 0.0
            else:
                change = (speed - before) / self.period_s - self._acceleration_mps2[axle]
                self._acceleration_mps2[axle] += change / p.filter_ticks
            self._speed_mps[axle] = speed
        self._follow_train(outside_reference_mps)
        off = demand <= 0.0 or self._reference_mps < p.cut_off_mps
        for axle in range(4):
            if off or self._speed_mps[axle] < 0.0:
                self._in_cycle[axle], self._unfilled[axle] = -1, 0
                output.valve[axle] = FILL
                output.sand[axle] = False
            else:
                output.valve[axle] = self._command(axle)
                output.sand[axle] = self._in_cycle[axle] >= 0
        output.reference_speed_mps = self._reference_mps if self._reference_mps >= 0.0 else math.nan
        return output

    def _follow_train(self, outside_reference_mps: float) -> None:
        """The fastest axle, its fall limited; a speed found elsewhere is believed."""
        if outside_reference_mps >= 0.0:  # False for nan, which stands for none
            self._reference_mps = outside_reference_mps
            return
        fallen = self._reference_mps - self.parameters.fall_limit_mps2 * self.period_s
        fastest = fallen
        for speed in self._speed_mps:
            if speed > fastest:
                fastest = speed
        self._reference_mps = fastest if fastest >= 0.0 or self._reference_mps < 0.0 else 0.0

    def _command(self, axle: int) -> int:
        """The valve command of an axle under the brake."""
        p = self.parameters
        slip_mps = self._reference_mps - self._speed_mps[axle] - p.slip_offset_mps
        acceleration = self._acceleration_mps2[axle]
        if (slip_mps > p.vent_slip * self._reference_mps and acceleration < 0.0) or (
            slip_mps > 0.0 and acceleration < p.vent_below_mps2
        ):
            command = VENT
            self._in_cycle[axle] = 0
        elif self._in_cycle[axle] < 0:
            command = FILL
        elif slip_mps > p.hold_slip * self._reference_mps:
            command = HOLD
        else:
            self._in_cycle[axle] += 1
            if self._in_cycle[axle] >= p.cycle_ticks:
                self._in_cycle[axle] = 0
            command = FILL if self._in_cycle[axle] < p.pulse_ticks else HOLD
        self._unfilled[axle] = 0 if command == FILL else self._unfilled[axle] + 1
        if self._unfilled[axle] > p.watchdog_ticks:
            self._in_cycle[axle], self._unfilled[axle] = -1, 0
            command = FILL
        return command
