"""Parameters of the contact between the wheels of a coach and the rails."""

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from wheel_rail.contact_geometry import ContactGeometryParameters


class ConicalGeometry(BaseModel):
    """Conical wheels on a rail head of constant radius: the simple option."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    conicity: float = Field(ge=0.0, le=0.5, description="tangent of the cone's half angle")
    rail_head_radius_m: float = Field(ge=0.05, le=100.0)
    flange_clearance_m: float = Field(gt=0.0, le=0.02, description="lateral play to either side")


class ProfileGeometry(BaseModel):
    """Wheel and rail profiles by name (`railslide list`) or from files of two columns, alike on both sides."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    wheel_profile: str
    rail_profile: str
    rail_inclination: float = Field(ge=-0.2, le=0.2, description="tangent, 0.025 for 1:40; 0 if measured as laid")
    gauge_m: float = Field(ge=0.6, le=2.0, description="14 mm below the top of the rails")
    back_to_back_m: float = Field(ge=0.5, le=2.0, description="between the flanges' backs")

    @property
    def geometry(self) -> ContactGeometryParameters:
        """The same for both wheels of a wheelset."""
        return ContactGeometryParameters(
            wheel_profiles=(self.wheel_profile, self.wheel_profile),
            rail_profiles=(self.rail_profile, self.rail_profile),
            rail_inclination=self.rail_inclination,
            gauge_m=self.gauge_m,
            back_to_back_m=self.back_to_back_m,
        )


class ContactParameters(BaseModel):
    """Geometry, material and stiffness of the contact of one coach's wheels."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    geometry: Literal["profiles", "conical"] = Field(description="which of the two tables below holds")
    profiles: ProfileGeometry | None = None
    conical: ConicalGeometry | None = None
    shear_modulus_pa: float = Field(gt=0.0)
    poisson: float = Field(ge=0.0, le=0.5)
    track_stiffness_npm: float = Field(
        gt=0.0, le=1e9, description="vertical, of the track under one wheel, in series with Hertz' contact"
    )
    damping_nspm: float = Field(ge=0.0, description="normal, per wheel")
    flange_stiffness_npm: float = Field(gt=0.0, description="lateral, of the rail against a flange")
    creep_speed_mps: float = Field(gt=0.0, description="speed below which the creepage denominator is held up")

    @model_validator(mode="after")
    def _geometry_is_given(self) -> Self:
        if (self.profiles if self.geometry == "profiles" else self.conical) is None:
            raise ValueError(f'geometry = "{self.geometry}": needs the table contact.{self.geometry}')
        return self
