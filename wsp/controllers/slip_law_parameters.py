"""Parameters of the controllers that work with slip set-points."""

from pydantic import BaseModel, ConfigDict, Field

from wsp.controllers.cylinder_model import CylinderParameters
from wsp.controllers.supervision_parameters import SupervisionParameters
from wsp.reference_speed import ReferenceSpeedParameters


class ReckonedReferenceParameters(ReferenceSpeedParameters):
    """Limits for a deceleration that follows the adhesion forces: what else changes it (gradient, a load that is not
    the assumed one) is slow."""

    fall_margin_mps2: float = Field(default=0.1, gt=0.0, le=5.0)
    fall_margin_at_work_mps2: float = Field(default=0.003, gt=0.0, le=5.0)
    jerk_limit_mps3: float = Field(default=0.03, gt=0.0, le=10.0)
    jerk_limit_at_work_mps3: float = Field(default=0.003, gt=0.0, le=10.0)


class SlipLawParameters(BaseModel):
    """Sliding line, pulses and relief; chosen on rails of 0.03..0.08 with Polach's curves."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    gain_ps: float = Field(default=8.0, gt=0.0, le=50.0, description="rate at which the slip approaches its set-point")
    recovery_mps2: float = Field(
        default=4.0, gt=0.0, le=50.0, description="largest acceleration wanted of a rim that slips too much"
    )
    approach_mps2: float = Field(
        default=2.0, gt=0.0, le=50.0, description="largest deceleration wanted of one that slips too little"
    )
    fill_share: float = Field(
        default=1.0, gt=0.0, le=10.0, description="of a tick's filling that must be lacking for another tick of it"
    )
    vent_share: float = Field(default=1.0, gt=0.0, le=10.0, description="the same of venting")
    noise_share: float = Field(
        default=3.0,
        ge=0.0,
        le=10.0,
        description="of the noise found in the acceleration while rolling that must be lacking for any pulse",
    )
    start_offset_mps: float = Field(
        default=0.5,
        ge=0.0,
        le=10.0,
        description="an axle comes under control with a slip speed of this + share * reference, ...",
    )
    start_share: float = Field(default=0.02, ge=0.0, le=0.3)
    start_fall_mps2: float = Field(
        default=1.5, gt=0.0, le=20.0, description="... or falling so fast against the train; one that creeps, grips"
    )
    adhesion_memory_s: float = Field(default=0.2, ge=0.01, le=5.0, description="of the smoothed adhesion")
    relief_share: float = Field(
        default=0.12, gt=0.0, le=1.0, description="a relieved axle is braked by so much less than its adhesion ..."
    )
    least_relief_mps2: float = Field(default=1.0, gt=0.0, le=20.0, description="... and by no less than this")


class SlipLawControllerParameters(SupervisionParameters):
    """What every controller has that works with slip set-points."""

    reference: ReckonedReferenceParameters = ReckonedReferenceParameters()
    cylinder: CylinderParameters = CylinderParameters()
    law: SlipLawParameters = SlipLawParameters()
