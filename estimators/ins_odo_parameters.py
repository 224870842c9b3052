"""Parameters of the estimator `ins-odo`."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from estimators.orientation_filter import OrientationParameters


class InsOdoParameters(BaseModel):
    """Tuning; the defaults suit the low-cost board of the source at 10 Hz. `orientation` is the filter inside."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    orientation: OrientationParameters = OrientationParameters()
    adhesion_sign: Literal["sound", "printed"] = "sound"
    balise: Literal["sound", "printed"] = "sound"
    balise_spacing_m: float = Field(default=1000.0, gt=0.0, description="of the printed balise form alone")

    acceleration_walk_mps2_per_rts: float = Field(default=0.5, gt=0.0, description="sigma_a of Q")
    acceleration_sd_mps2: float = Field(default=0.02, gt=0.0, description="sigma_a of R while sliding")
    acceleration_distrusted_sd_mps2: float = Field(default=0.3, gt=0.0, description="the same, adhesion good")
    wheel_speed_sd_mps: float = Field(default=0.03, gt=0.0, description="sigma_v, adhesion good")
    wheel_speed_distrusted_sd_mps: float = Field(default=1e4, gt=0.0)
    balise_sd_m: float = Field(default=5.0, gt=0.0, description="sigma_p")

    adhesion_acceleration_mps2: float = Field(default=0.2, gt=0.0, description="eta_ad")
    adhesion_speed_mps: float = Field(default=0.3, gt=0.0, description="eta_v")
    lookback_s: float = Field(default=8.0, gt=0.0, le=60.0)
    confirmation_s: float = Field(default=1.0, ge=0.0)
    wheel_force_mps2: float = Field(default=0.15, gt=0.0, description="f_x that shows traction or braking")
    standstill_s: float = Field(default=2.0, gt=0.0)

    # What lasts, and so counts in the bounds, beside pitch and yaw of the IMU.
    accelerometer_sd_mps2: float = Field(default=4e-3, ge=0.0)
    wheel_radius_sd_share: float = Field(default=0.002, ge=0.0, le=0.1)
    bound_sigmas: float = Field(default=3.0, gt=0.0)
