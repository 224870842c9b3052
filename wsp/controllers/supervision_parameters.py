"""Parameters that every controller has: speeds, wheels, limits, requests, reference speed."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from wsp.reference_speed import ReferenceSpeedParameters

Size = Annotated[float, Field(ge=0.0, le=100.0)]
Time = Annotated[float, Field(ge=0.01, le=60.0)]


class SupervisionParameters(BaseModel):
    """Speeds, wheels, limits, requests and reference speed. Times count in whole ticks of 10 ms. M: known at second
    hand."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    filter_time_s: Time = Field(
        default=0.03,
        description="memory of the speed filter: 0.1 % noise at 120 km/h leaves 0.4 m/s2 in the acceleration",
    )
    frozen_after_s: Time = Field(
        default=0.5, description="a reading above all others that stays the same to the bit for so long is not believed"
    )
    compare_above_mps: Size = Field(
        default=5.0, description="wheel diameters are compared when unbraked above this speed"
    )
    compare_below_mps2: Size = Field(default=0.3, description="and while the train's acceleration is smaller than this")
    compare_memory_s: Time = 5.0
    largest_wheel_difference: float = Field(
        default=0.04,
        ge=0.0,
        le=0.2,
        description="new to worn: 920 to 850 mm, +-4 %; an axle that differs by more when unbraked is not believed",
    )
    distrust_after_s: Time = Field(default=1.0, description="and believed again when it has agreed for as long")
    empty_after_s: Time = Field(
        default=0.5, description="of venting without filling, after which a brake is out; 0.4 from 3.8 bar (M)"
    )
    cut_off_mps: Size = Field(default=1.4, description="brakes fill freely below; M: 3..5 km/h")
    releases_for_s: Time = Field(
        default=20.0, description="after the demand has gone, brakes may still be on: 15..20 s from 3.8 to 0.4 bar"
    )
    quiet_s: Time = Field(
        default=2.0, description="without venting for so long an axle is not under control: it fills freely"
    )
    watchdog_s: Time = Field(
        default=9.0, description="longest time without filling; the brake's own safety timer acts at 10 s (M: 7..10)"
    )
    watchdog_refill_s: Time = Field(
        default=1.0, description="filling that then follows on an axle that was vented, whatever it does; assumed"
    )
    blind_share: float = Field(
        default=0.4,
        ge=0.0,
        le=1.0,
        description="pressure of an axle without a speed over that of its neighbour under control: what friction keeps "
        "when a wheel locks, so that it does not stay locked",
    )
    blind_relief_s: Time = Field(default=0.16, description="of venting that bring it there; 3.8 to 1.9 bar (M)")
    sand_below_mps2: Size = Field(
        default=0.5,
        description="deceleration found with an axle under control below which sand is asked for: adhesion of about "
        "0.05 (M: extremely low); 0: never",
    )
    track_brake_below_mps2: Size = Field(
        default=0.0, description="the same for the track brake; 0: never, as it is the driver's and wears the rail"
    )
    request_after_s: Time = Field(
        default=1.0, description="of such a deceleration; ends after as long without; assumed"
    )
    request_above_mps: Size = Field(
        default=2.8, description="no sand below: a standing train would cut itself off from track circuits"
    )
    reference: ReferenceSpeedParameters = ReferenceSpeedParameters()
