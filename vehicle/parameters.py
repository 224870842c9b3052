"""Parameters of a coach with two bogies and four wheelsets; presets are TOML files of the same form."""

from pathlib import Path
from typing import Annotated, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from vehicle.axle_boxes import AxleBox, AxleBoxes, lumped_stage
from vehicle.characteristics import Characteristic
from vehicle.loads import EMPTY, Payload, Saloon
from vehicle.soundness import first_fault
from vehicle.wheels import Wheels
from wheel_rail import ContactParameters

COACH_PRESETS: dict[str, Path] = {p.stem: p for p in sorted((Path(__file__).parent / "presets").glob("*.toml"))}

GRAVITY_MPS2 = 9.81

AXES = ("longitudinal", "lateral", "vertical")
"""Axes x, y, z as they stand in the names of keys."""

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
    """Wheelset together with its two axle boxes, which do not spin; its pitch inertia is theirs."""

    mass_kg: Positive
    roll_inertia_kgm2: Positive
    yaw_inertia_kgm2: Positive
    spin_inertia_kgm2: Positive
    wheel_diameter_m: Annotated[float, Field(ge=0.3, le=1.5)]


class Stage(_Section):
    """One suspension stage, given per spring (8 primary, 4 secondary); axes x, y, z of the body above.

    To the linear stiffness and damping come the characteristics named for an axis: springs (of airsprings, flexicoils,
    rubber) and stops over deflection, dampers and friction over speed. Static loads are carried at zero deflection at
    every load: heights are those of a levelled coach.
    """

    half_spacing_m: Positive = Field(description="lateral distance of the spring from the centreline")
    height_m: Positive = Field(description="of the plane where the spring acts, above the rail")
    stiffness_npm: Stiffness
    damping_nspm: Stiffness = (0.0, 0.0, 0.0)
    rotational_stiffness_nmprad: Stiffness = (0.0, 0.0, 0.0)
    rotational_damping_nmsprad: Stiffness = (0.0, 0.0, 0.0)
    longitudinal_spring: str | None = None
    lateral_spring: str | None = None
    vertical_spring: str | None = None
    longitudinal_stop: str | None = None
    lateral_stop: str | None = None
    vertical_stop: str | None = None
    longitudinal_damper: str | None = None
    lateral_damper: str | None = None
    vertical_damper: str | None = None
    longitudinal_friction: str | None = None
    lateral_friction: str | None = None
    vertical_friction: str | None = None

    def named(self, axis: int, *kinds: str) -> list[str]:
        """Names of the characteristics of these kinds (spring, stop, damper, friction) along axis 0, 1, 2."""
        names = (getattr(self, f"{AXES[axis]}_{kind}") for kind in kinds)
        return [name for name in names if name is not None]


class YawDampers(_Section):
    """Longitudinal dampers between body and bogie, one on either side of each bogie."""

    half_spacing_m: Positive
    height_m: Positive
    damper: str


class LateralStop(_Section):
    """Bump stop between body and the middle of each bogie, where it does not act in the plane of the springs."""

    height_m: Positive
    stop: str


class TractionRod(_Section):
    """Longitudinal link between body and each bogie."""

    height_m: Positive
    stiffness_npm: NotNegative
    damping_nspm: NotNegative
    spring: str | None = Field(default=None, description="characteristic that comes on top, such as of rubber or play")
    damper: str | None = None


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
    """Everything that defines a coach. Bodies' inertia products are zero; but for its wheels the coach is symmetric."""

    body: RigidBody = Field(description="empty")
    bogie: RigidBody
    wheelset: Wheelset
    axle_boxes: AxleBoxes = "lumped"
    axle_box: AxleBox
    wheels: Wheels = Wheels()
    bogie_distance_m: Positive
    wheelbase_m: Positive
    primary: Stage
    secondary: Stage
    characteristics: dict[str, Characteristic] = Field(default={}, description="by the names that the elements give")
    anti_roll_bar_nmprad: NotNegative = Field(default=0.0, description="per bogie, between body and bogie")
    yaw_dampers: YawDampers | None = None
    lateral_stop: LateralStop | None = None
    traction_rod: TractionRod | None = None
    caliper: Caliper
    contact: ContactParameters
    resistance: Resistance
    load: str = Field(default=EMPTY, description=f"{EMPTY}, or one of loads")
    saloon: Saloon | None = None
    loads: dict[str, Payload] = {}

    @model_validator(mode="after")
    def _is_sound(self) -> Self:
        fault = first_fault(self)
        if fault is not None:
            raise ValueError(fault)
        return self

    @property
    def payload(self) -> Payload | None:
        """What the coach carries; None when it is empty."""
        return None if self.load == EMPTY else self.loads[self.load]

    @property
    def laden_body(self) -> RigidBody:
        """The body with its payload: mass, centre of mass, and inertias about that centre."""
        body, payload = self.body, self.payload
        if payload is None:
            return body
        mass_kg = body.mass_kg + payload.mass_kg
        height_m = (body.mass_kg * body.height_m + payload.mass_kg * payload.height_m) / mass_kg
        apart = body.mass_kg * payload.mass_kg / mass_kg * (payload.height_m - body.height_m) ** 2
        roll, pitch, yaw = payload.own_inertia_kgm2(self.saloon)
        return RigidBody(
            mass_kg=mass_kg,
            roll_inertia_kgm2=body.roll_inertia_kgm2 + roll + apart,
            pitch_inertia_kgm2=body.pitch_inertia_kgm2 + pitch + apart,
            yaw_inertia_kgm2=body.yaw_inertia_kgm2 + yaw,
            height_m=height_m,
        )

    @property
    def primary_at_axle(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Of coil spring and swing arm lumped into one: stiffness (N/m), damping (Ns/m), rotational stiffness (Nm/rad)
        and damping (Nms/rad), (3,) each."""
        stage = self.primary
        return lumped_stage(
            self.axle_box, stage.stiffness_npm, stage.damping_nspm, stage.rotational_stiffness_nmprad,
            stage.rotational_damping_nmsprad,
        )  # fmt: skip

    @property
    def mass_kg(self) -> float:
        """Total mass of the coach with its payload."""
        return self.laden_body.mass_kg + 2.0 * self.bogie.mass_kg + 4.0 * self.wheelset.mass_kg

    @property
    def effective_mass_kg(self) -> float:
        """Mass plus the wheelsets' rotating inertia reduced to the rail: what a braking force decelerates."""
        radius_m = 0.5 * self.wheelset.wheel_diameter_m
        return self.mass_kg + 4.0 * self.wheelset.spin_inertia_kgm2 / radius_m**2

    @property
    def load_ratio(self) -> float:
        """Effective mass over that of the empty coach: by what a brake that weighs the load brakes harder."""
        return self.effective_mass_kg / (self.effective_mass_kg - (self.payload.mass_kg if self.payload else 0.0))

    @property
    def static_wheel_load_n(self) -> float:
        """Vertical load of each wheel on level straight track."""
        return self.mass_kg * GRAVITY_MPS2 / 8.0
