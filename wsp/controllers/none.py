"""`none`: no wheel slide protection; the valves stay de-energised, so every cylinder follows the distributor."""

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from wsp.controllers.interface import ControllerOutput


class NoProtectionParameters(BaseModel):
    """There is nothing to set."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class NoProtection:
    """A train whose WSP is switched off."""

    Parameters = NoProtectionParameters
    period_s = 0.01

    def __init__(self, parameters: NoProtectionParameters) -> None:
        self.parameters = parameters
        self._output = ControllerOutput()

    def reset(self, t_s: float, direction: int) -> None:
        """Nothing is carried over."""

    def step(
        self,
        t_s: float,
        axle_speed_mps: NDArray[np.float64],
        valid: NDArray[np.bool_],
        demand: float,
        direction: int,
        outside_reference_mps: float,
    ) -> ControllerOutput:
        """FILL on every axle, no reference speed."""
        return self._output
