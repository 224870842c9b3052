"""Parameters of the anti-skid of traction."""

from pydantic import BaseModel, ConfigDict, Field


class AntiSkidParameters(BaseModel):
    """What the anti-skid knows of the coach, and its limits. All assumed: searched on the rails of the tests."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    mass_kg: float = Field(default=56_000.0, gt=0.0, le=1e7, description="of all that the driven axles pull")
    wheel_radius_m: float = Field(default=0.46, gt=0.0, le=1.0)
    inertia_kgm2: float = Field(default=110.0, gt=0.0, le=1e4, description="of one driven wheelset, its motor included")
    slip_offset_mps: float = Field(default=0.20, gt=0.0, le=5.0, description="slip speed too much at standstill")
    slip_share: float = Field(default=0.012, ge=0.0, le=0.5, description="its growth with the reference speed")
    gripping_share: float = Field(
        default=0.4, gt=0.0, lt=1.0, description="of that slip speed, below which a wheel counts as gripping again"
    )
    excess_mps2: float = Field(
        default=1.0, gt=0.0, le=20.0, description="rim against train: too much, from gripping_share of the slip on"
    )
    return_mps2: float = Field(default=0.8, gt=0.0, le=20.0, description="a wheel that returns slower is cut further")
    cut_share: float = Field(default=0.8, gt=0.0, lt=1.0, description="of the rail torque, left to a wheel that slips")
    cut_rate_ps: float = Field(default=3.0, gt=0.0, le=100.0, description="further fall, rail torques per second")
    restore_share: float = Field(default=0.95, gt=0.0, le=1.0, description="of the rail torque, given back")
    seek_rate_ps: float = Field(default=0.12, gt=0.0, le=10.0, description="rise then, rail torques per second")
    seek_growth_ps: float = Field(default=2.0, ge=0.0, le=10.0, description="growth of that rise per second")
    quiet_s: float = Field(default=3.0, gt=0.0, le=60.0, description="without slip for so long an axle is free again")
    free_rise_nmps: float = Field(default=8000.0, gt=0.0, le=1e6, description="largest rise of a free axle's torque")
    least_share: float = Field(default=0.02, ge=0.0, lt=1.0, description="of the demand, left in any case")
    rise_limit_mps2: float = Field(default=1.5, gt=0.0, le=5.0, description="largest acceleration of a train believed")
    margin_mps2: float = Field(
        default=0.8, gt=0.0, le=5.0, description="reference rises so much faster while one grips"
    )
    margin_at_work_mps2: float = Field(default=0.02, ge=0.0, le=5.0, description="the same while all are held back")
    learn_ps2: float = Field(
        default=2.0, ge=0.0, le=100.0, description="learning of unknown acceleration per m/s of error"
    )
    relieve_every_s: float = Field(default=4.0, gt=0.0, le=60.0, description="with all axles held back and none sure")
    relieve_s: float = Field(default=0.4, gt=0.0, le=5.0, description="how long")
    relieve_share: float = Field(default=0.3, ge=0.0, lt=1.0, description="of the rail torque, left to that axle")
    filter_time_s: float = Field(default=0.04, gt=0.0, le=1.0, description="memory of speed and acceleration")
    train_filter_time_s: float = Field(default=0.25, gt=0.0, le=5.0, description="memory of the train's acceleration")
