"""Wheels that are not what they should be: unequal diameters and out-of-round treads, wheel by wheel."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

WHEELS = ("1L", "1R", "2L", "2R", "3L", "3R", "4L", "4R")
MOST_HARMONICS = 8  # per wheel

Diameter = Annotated[float, Field(ge=0.3, le=1.5)]


class Harmonic(BaseModel):
    """One harmonic of a wheel's radius: r = r0 + amplitude cos(order angle + phase), `angle` that the wheel has turned.

    The simulation's step must resolve it: `order` turns of the wheel in some eight steps or more.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    wheel: Literal["1L", "1R", "2L", "2R", "3L", "3R", "4L", "4R"]
    order: int = Field(ge=1, le=30, description="1 eccentric, 2 oval, 3 and more polygonal")
    amplitude_m: float = Field(gt=0.0, le=0.005)
    phase_deg: float = Field(default=0.0, ge=-360.0, le=360.0)


class Wheels(BaseModel):
    """True diameters of the eight wheels and how far they are from round; tachometers keep what they believe."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    diameter_m: tuple[Diameter, Diameter, Diameter, Diameter, Diameter, Diameter, Diameter, Diameter] | None = Field(
        default=None, description="on the tape circle, of 1L, 1R, 2L, 2R ...; without it wheelset.wheel_diameter_m"
    )
    out_of_roundness: tuple[Harmonic, ...] = ()

    def oversize_m(self, nominal_m: float) -> np.ndarray:
        """Radius of each wheel less the nominal one, (4, 2)."""
        if self.diameter_m is None:
            return np.zeros((4, 2))
        return 0.5 * (np.array(self.diameter_m).reshape(4, 2) - nominal_m)

    def harmonics(self) -> tuple[np.ndarray, np.ndarray]:
        """How many harmonics each wheel has (4, 2); their orders, amplitudes and phases (4, 2, MOST_HARMONICS, 3)."""
        count = np.zeros((4, 2), np.int64)
        rows = np.zeros((4, 2, MOST_HARMONICS, 3))
        for harmonic in self.out_of_roundness:
            at = divmod(WHEELS.index(harmonic.wheel), 2)
            rows[at][count[at]] = harmonic.order, harmonic.amplitude_m, math.radians(harmonic.phase_deg)
            count[at] += 1
        return count, rows

    def fault(self, nominal_m: float) -> str | None:
        """What makes these wheels unusable, as `key = value: reason`; None if nothing."""
        for wheel in WHEELS:
            if sum(harmonic.wheel == wheel for harmonic in self.out_of_roundness) > MOST_HARMONICS:
                return f"out_of_roundness: wheel {wheel} has more than {MOST_HARMONICS} harmonics"
        for k, diameter in enumerate(self.diameter_m or ()):
            if abs(diameter - nominal_m) > 0.1 * nominal_m:
                return (
                    f"diameter_m.{k} = {diameter}: must be within 10 % of wheelset.wheel_diameter_m = {nominal_m}, "
                    "for whose radius the contact is worked out"
                )
        return None
