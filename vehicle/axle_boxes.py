"""Axle boxes: eight bodies between wheelset and bogie, or lumped into the wheelset that carries them.

An explicit box hangs on its wheelset by a bearing, stiff but free in pitch, on the bogie by the coil spring above the
axle, and by its swing arm, if it has one, on a bushing `length_m` from the axle towards the middle of the bogie.

Lumped, the box goes with its wheelset, and spring and arm become one spring at the axle: in the plane they act in
parallel; vertically the arm turns about its bushing by z/length, so that besides the coil spring only what resists
turning counts, 1/(1/kz + length^2/(k_coil + k_bushing)); the pitch of the box is held by the bushing's kz length^2.
That the bushing guides the box from beside the axle, and that the arm turns, are lost in it.
"""

from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

NotNegative = Annotated[float, Field(ge=0.0)]
Positive = Annotated[float, Field(gt=0.0)]
Stiffness = tuple[NotNegative, NotNegative, NotNegative]

AxleBoxes = Literal["lumped", "explicit"]

# A wheelset's carrier bears its spinning wheels and does not turn with them: beside explicit boxes this share of their
# pitch inertia holds it, on a spring so soft that left and right box pitch as they like.
CARRIER_SHARE = 0.125
_CARRIER_RADPS, _CARRIER_DAMPING = 50.0, 0.5


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class SwingArm(_Section):
    """The arm of an axle box and the bushing by which it hangs on the bogie."""

    length_m: float = Field(gt=0.1, le=2.0, description="axle to bushing")
    stiffness_npm: tuple[Positive, Positive, Positive]
    damping_nspm: Stiffness
    rotational_stiffness_nmprad: Stiffness
    rotational_damping_nmsprad: Stiffness


class Bearing(_Section):
    """Bearing between an axle box and its wheelset: stiff in all but pitch, in which it is free."""

    stiffness_npm: tuple[Positive, Positive, Positive]
    damping_nspm: tuple[Positive, Positive, Positive]
    tilting_stiffness_nmprad: Positive = Field(description="roll and yaw of the box on the axle")
    tilting_damping_nmsprad: Positive


class AxleBox(_Section):
    """One of eight alike, its centre of mass on the axle; the masses of wheelset and boxes are given together there."""

    mass_kg: Positive
    roll_inertia_kgm2: Positive
    pitch_inertia_kgm2: Positive
    yaw_inertia_kgm2: Positive
    swing_arm: SwingArm | None = None
    bearing: Bearing | None = Field(default=None, description="only of explicit boxes")

    @property
    def inertia_kgm2(self) -> np.ndarray:
        """Roll, pitch, yaw inertia of an explicit box (3,)."""
        pitch = (1.0 - CARRIER_SHARE) * self.pitch_inertia_kgm2
        return np.array([self.roll_inertia_kgm2, pitch, self.yaw_inertia_kgm2])

    @property
    def carrier_pitch_inertia_kgm2(self) -> float:
        """What holds the pitch of a wheelset's carrier beside explicit boxes."""
        return 2.0 * CARRIER_SHARE * self.pitch_inertia_kgm2

    @property
    def carrier_pitch(self) -> tuple[float, float]:
        """Pitch stiffness (Nm/rad) and damping (Nms/rad) between the carrier and each of its explicit boxes."""
        inertia = self.carrier_pitch_inertia_kgm2
        return 0.5 * inertia * _CARRIER_RADPS**2, _CARRIER_DAMPING * inertia * _CARRIER_RADPS


def lumped_stage(
    box: AxleBox,
    stiffness: Stiffness,
    damping: Stiffness,
    rotational_stiffness: Stiffness,
    rotational_damping: Stiffness,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, damping, rotational stiffness and damping (3,) of coil spring and swing arm in one, at the axle."""
    k, c, kr, cr = map(np.array, (stiffness, damping, rotational_stiffness, rotational_damping))
    arm = box.swing_arm
    if arm is None:
        return k, c, kr, cr
    kr = kr + arm.rotational_stiffness_nmprad
    cr = cr + arm.rotational_damping_nmsprad
    lever = arm.length_m**2
    turning = 1.0 / (1.0 / arm.stiffness_npm[2] + lever / kr[1]) if kr[1] > 0.0 else 0.0
    k = k + np.array([*arm.stiffness_npm[:2], turning])
    c = c + np.array([*arm.damping_nspm[:2], cr[1] / lever])
    kr[1], cr[1] = lever * arm.stiffness_npm[2], lever * arm.damping_nspm[2]
    return k, c, kr, cr
