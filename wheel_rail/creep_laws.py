"""The creep laws by name, and the one compiled function through which the contact calls them.

A law in force is (number, address, extra): the number chooses the branch of `creep_force`, the address is that of a
user's compiled law (0 otherwise), `extra` (8,) holds the law's own parameters.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.fastsim import fastsim_force, modified_fastsim_force
from wheel_rail.kalker_linear import CUBIC, CUT, kalker_linear_force
from wheel_rail.polach import polach_force
from wheel_rail.user_law import CompiledLaw, compile_law, user_force

KALKER_LINEAR, POLACH, FASTSIM, MODIFIED_FASTSIM, USER = range(5)
EXTRA = 8


@compiled
def creep_force(
    law: int, address: int, extra: Array, creep_x: float, creep_y: float, spin_1pm: float, slip_speed_mps: float,
    normal_force_n: float, patch: Vector, rail: Array, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Creep force on the wheel (Fx, Fy) in N; tangent dF/ds along the slip and secant F/s in N per unit creep.

    `law`, `address`, `extra` (EXTRA,): the law in force (`LawInForce`); the other arguments as in `polach_force`.
    """
    if law == POLACH:
        return polach_force(creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, patch, rail, shear_modulus_pa)
    if law == FASTSIM:
        return fastsim_force(
            int(extra[0]), int(extra[1]),
            creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, patch, rail, shear_modulus_pa,
        )  # fmt: skip
    if law == MODIFIED_FASTSIM:
        return modified_fastsim_force(
            int(extra[0]), int(extra[1]), extra[2], extra[3], extra[4],
            creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, patch, rail, shear_modulus_pa,
        )  # fmt: skip
    if law == KALKER_LINEAR:
        return kalker_linear_force(
            int(extra[0]),
            creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, patch, rail, shear_modulus_pa,
        )  # fmt: skip
    return user_force(
        address, creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, patch, rail, shear_modulus_pa
    )


class LawParameters(BaseModel):
    """Parameters of a creep law's own; the friction curve is the rail's. A law without any takes these."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    def extra(self) -> np.ndarray:
        """The parameters as `creep_force` reads them, (EXTRA,), in the order of the fields."""
        values = [float(value) for value in self.model_dump().values()]
        return np.array(values + [0.0] * (EXTRA - len(values)))


class KalkerLinearParameters(LawParameters):
    """How Kalker's linear law saturates."""

    saturation: Literal["cubic", "cut"] = "cubic"

    def extra(self) -> np.ndarray:
        return np.array([CUT if self.saturation == "cut" else CUBIC] + [0.0] * (EXTRA - 1), dtype=float)


class FastsimParameters(LawParameters):
    """Grid of FASTSIM: cells along a strip, and strips across the ellipse."""

    nx: int = Field(default=10, ge=2, le=500)
    ny: int = Field(default=10, ge=3, le=500)


class ModifiedFastsimParameters(FastsimParameters):
    """Grid and stiffness reduction k0 ((1 - alpha_inf)/(1 + beta eps) + alpha_inf).

    Defaults: CONTACT's example for the locomotive measured by Polach (User guide for CONTACT, creep-force curves).
    """

    k0: float = Field(default=0.54, gt=0.0, le=1.0)
    alpha_inf: float = Field(default=0.02, ge=0.0, le=1.0)
    beta: float = Field(default=0.62, ge=0.0, le=1000.0)


@dataclass(frozen=True)
class LawInForce:
    """A law with its parameters, ready for `creep_force(law.number, law.address, law.extra, ...)`.

    A user's law is machine code of this process: `compiled` keeps it alive, and each process compiles its own.
    """

    number: int
    extra: np.ndarray = field(compare=False)
    address: int = 0
    compiled: CompiledLaw | None = field(default=None, repr=False)


@dataclass(frozen=True)
class CreepLaw:
    """An entry of CREEP_LAWS: number in `creep_force`, one line for the user, model of its parameters."""

    number: int
    description: str
    Parameters: type[LawParameters]
    compiled: CompiledLaw | None = field(default=None, repr=False)

    def in_force(self, parameters: LawParameters | None = None) -> LawInForce:
        """The law with `parameters` (an instance of `Parameters`), or with the defaults."""
        chosen = self.Parameters() if parameters is None else parameters
        address = 0 if self.compiled is None else self.compiled.address
        return LawInForce(self.number, chosen.extra(), address, self.compiled)


CREEP_LAWS: dict[str, CreepLaw] = {
    "kalker-linear": CreepLaw(
        KALKER_LINEAR, "Kalker's linear theory, saturated smoothly or cut off at mu N", KalkerLinearParameters
    ),
    "polach": CreepLaw(POLACH, "Polach's closed formula for large creepages and falling friction", LawParameters),
    "fastsim": CreepLaw(FASTSIM, "Kalker's FASTSIM on a grid over the contact ellipse", FastsimParameters),
    "modified-fastsim": CreepLaw(
        MODIFIED_FASTSIM, "FASTSIM whose stiffness falls with creepage", ModifiedFastsimParameters
    ),
}


@lru_cache(maxsize=64)
def user_creep_law(function: Callable[..., Any], name: str) -> CreepLaw:
    """The creep law of a user's `function` with the arguments `user_law.ARGUMENTS`; it takes no parameters and is
    compiled once.

    Raises UnusableLaw if it cannot be compiled or is no creep law.
    """
    return CreepLaw(USER, f"user's law {name}", LawParameters, compile_law(function, name))
