"""Conical wheels on rails with a circular head: the simple contact geometry, and the constants that contact needs."""

from dataclasses import dataclass, replace

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from wheel_rail.hertz import elliptic_contact
from wheel_rail.kalker import creep_coefficients
from wheel_rail.track import RAIL_SPACING_M

# constants of one wheelset-track pair, read by the compiled contact
CONTACT = np.dtype(
    [
        ("radius_m", "f8"),
        ("conicity", "f8"),
        ("half_spacing_m", "f8"),
        ("cosine", "f8"),  # of the cone's half angle
        ("patch", "f8", (6,)),  # a, b at the reference load, C11, C22, C23, factor of the spin
        ("reference_load_n", "f8"),
        ("shear_modulus_pa", "f8"),
        ("stiffness_npm", "f8"),
        ("damping_nspm", "f8"),
        ("flange_clearance_m", "f8"),
        ("flange_stiffness_npm", "f8"),
        ("creep_speed_mps", "f8"),
    ]
)


class ConicalContactParameters(BaseModel):
    """Conical wheel on a rail head of constant radius, with a flange that stops lateral play."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    conicity: float = Field(ge=0.0, le=0.5, description="tangent of the cone's half angle")
    rail_head_radius_m: float = Field(gt=0.0)
    shear_modulus_pa: float = Field(gt=0.0)
    poisson: float = Field(ge=0.0, le=0.5)
    stiffness_npm: float = Field(gt=0.0, description="normal, per wheel: wheel, rail and track in series")
    damping_nspm: float = Field(ge=0.0)
    flange_clearance_m: float = Field(gt=0.0)
    flange_stiffness_npm: float = Field(gt=0.0)
    creep_speed_mps: float = Field(gt=0.0, description="speed below which the creepage denominator is held up")


@dataclass(frozen=True)
class ConicalContact:
    """`ConicalContactParameters` made ready for wheels of `radius_m` at the nominal load per wheel."""

    parameters: ConicalContactParameters
    radius_m: float
    load_n: float

    @property
    def patch(self) -> np.ndarray:
        """Contact ellipse and coefficients at the nominal load: (a_m, b_m, C11, C22, C23, Polach's spin factor)."""
        p = self.parameters
        ellipse = elliptic_contact(
            self.load_n, 1.0 / self.radius_m, 1.0 / p.rail_head_radius_m, p.shear_modulus_pa, p.poisson
        )
        ratio = ellipse.a_m / ellipse.b_m
        return np.array(
            [ellipse.a_m, ellipse.b_m, *creep_coefficients(ratio, p.poisson), 1.0 + 6.3 * (1.0 - np.exp(-ratio))]
        )

    def at_load(self, load_n: float) -> "ConicalContact":
        """The same wheels under another nominal load."""
        return replace(self, load_n=load_n)

    def constants(self) -> np.ndarray:
        """Record of dtype `CONTACT` (shape ())."""
        p = self.parameters
        record = np.zeros((), CONTACT)
        record["radius_m"] = self.radius_m
        record["conicity"] = p.conicity
        record["cosine"] = 1.0 / np.sqrt(1.0 + p.conicity**2)
        record["half_spacing_m"] = 0.5 * RAIL_SPACING_M
        record["patch"] = self.patch
        record["reference_load_n"] = self.load_n
        for name in (
            "shear_modulus_pa",
            "stiffness_npm",
            "damping_nspm",
            "flange_clearance_m",
            "flange_stiffness_npm",
            "creep_speed_mps",
        ):
            record[name] = getattr(p, name)
        return record
