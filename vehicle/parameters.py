"""Parameters of a coach with two bogies and four wheelsets; presets are TOML files of the same form."""

from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from wheel_rail import ContactParameters

COACH_PRESETS: dict[str, Path] = {p.stem: p for p in sorted((Path(__file__).parent / "presets").glob("*.toml"))}

GRAVITY_MPS2 = 9.81

Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Stiffness = tuple[NotNegative, NotNegative, NotNegative]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class RigidBody(_Section):
    """A sprung rigid body; inertias about its centre of mass, which lies `height_m` above the rail."""

    mass_kg: Positive
    roll_inertia_kgm2: Positive
    pitch_inertia_kgm2: Positive
    yaw_inertia_kgm2: Positive
    height_m: Positive


class Wheelset(_Section):
    """Wheelset with its axle boxes: the boxes do not spin and carry `box_pitch_inertia_kgm2` for both."""

    mass_kg: Positive
    roll_inertia_kgm2: Positive
    yaw_inertia_kgm2: Positive
    spin_inertia_kgm2: Positive
    box_pitch_inertia_kgm2: Positive
    wheel_diameter_m: Annotated[float, Field(ge=0.3, le=1.5)]


class Characteristic(_Section):
    """Odd-symmetric curve through the given points from (0, 0) on; continued with its last slope.

    `x`: deflection in m or speed in m/s; `force_n`: force magnitude.
    """

    x: tuple[float, ...] = Field(min_length=2, max_length=12)
    force_n: tuple[float, ...] = Field(min_length=2, max_length=12)

    @model_validator(mode="after")
    def _is_a_curve(self) -> Self:
        if len(self.x) != len(self.force_n):
            raise ValueError(f"x has {len(self.x)} points, force_n has {len(self.force_n)}: they must be equally many")
        if self.x[0] != 0.0 or self.force_n[0] != 0.0:
            raise ValueError("x and force_n must both start at 0")
        if any(b <= a for a, b in zip(self.x, self.x[1:], strict=False)):
            raise ValueError("x must increase from point to point")
        if any(b < a for a, b in zip(self.force_n, self.force_n[1:], strict=False)):
            raise ValueError("force_n must not fall from point to point")
        return self


class Stage(_Section):
    """One suspension stage, given per spring (8 primary, 4 secondary); axes x, y, z of the body above."""

    half_spacing_m: Positive = Field(description="lateral distance of the spring from the centreline")
    height_m: Positive = Field(description="of the plane where the spring acts, above the rail")
    stiffness_npm: Stiffness
    damping_nspm: Stiffness = (0.0, 0.0, 0.0)
    rotational_stiffness_nmprad: Stiffness = (0.0, 0.0, 0.0)
    rotational_damping_nmsprad: Stiffness = (0.0, 0.0, 0.0)
    vertical_damper: Characteristic
    lateral_damper: Characteristic | None = None
    vertical_stop: Characteristic
    lateral_stop: Characteristic | None = None


class YawDampers(_Section):
    """Longitudinal dampers between body and bogie, one on either side of each bogie."""

    half_spacing_m: Positive
    height_m: Positive
    damper: Characteristic


class TractionRod(_Section):
    """Longitudinal link between body and each bogie."""

    height_m: Positive
    stiffness_npm: Positive
    damping_nspm: NotNegative


class Caliper(_Section):
    """How stiffly a stuck friction brake holds the wheelset: torsion of disc, pads and caliper, per wheelset."""

    stiffness_nmprad: Positive
    damping_nmsprad: NotNegative


class Resistance(_Section):
    """Running resistance of the whole coach, N: a + b v + c v^2 with v in m/s, acting at the body's centre of mass."""

    a_n: NotNegative
    b_nspm: NotNegative
    c_ns2pm2: NotNegative


class CoachParameters(_Section):
    """Everything that defines a coach. Bodies' inertia products are zero; the coach is symmetric."""

    body: RigidBody
    bogie: RigidBody
    wheelset: Wheelset
    bogie_distance_m: Positive
    wheelbase_m: Positive
    primary: Stage
    secondary: Stage
    anti_roll_bar_nmprad: NotNegative = Field(description="per bogie, between body and bogie")
    yaw_dampers: YawDampers
    traction_rod: TractionRod
    caliper: Caliper
    contact: ContactParameters
    resistance: Resistance

    @model_validator(mode="after")
    def _wheelsets_do_not_collide(self) -> Self:
        if self.wheelbase_m <= self.wheelset.wheel_diameter_m:
            raise ValueError(f"wheelbase_m = {self.wheelbase_m}: must exceed wheelset.wheel_diameter_m")
        if self.bogie_distance_m <= self.wheelbase_m + self.wheelset.wheel_diameter_m:
            raise ValueError(f"bogie_distance_m = {self.bogie_distance_m}: the bogies overlap")
        return self

    @property
    def mass_kg(self) -> float:
        """Total mass of the coach."""
        return self.body.mass_kg + 2.0 * self.bogie.mass_kg + 4.0 * self.wheelset.mass_kg

    @property
    def effective_mass_kg(self) -> float:
        """Mass plus the wheelsets' rotating inertia reduced to the rail: what a braking force decelerates."""
        radius_m = 0.5 * self.wheelset.wheel_diameter_m
        return self.mass_kg + 4.0 * self.wheelset.spin_inertia_kgm2 / radius_m**2

    @property
    def static_wheel_load_n(self) -> float:
        """Vertical load of each wheel on level straight track."""
        return self.mass_kg * GRAVITY_MPS2 / 8.0
