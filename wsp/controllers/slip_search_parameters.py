"""Parameters of the search for the best slip."""

from itertools import pairwise
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

LEVELS = 5

Slip = Annotated[float, Field(ge=0.0, le=0.3)]
Place = Annotated[float, Field(ge=0.0, le=30.0)]


class SlipSearchParameters(BaseModel):
    """Slip levels, and how they are tried."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    slip_offset_mps: float = Field(
        default=0.1, ge=0.0, le=5.0, description="set-point of slip speed = this + share of the level * reference"
    )
    slip_share: tuple[Slip, Slip, Slip, Slip, Slip] = Field(
        default=(0.008, 0.02, 0.05, 0.10, 0.15), description="of the levels, in rising order"
    )
    largest_slip_mps: float = Field(default=6.0, gt=0.0, le=50.0, description="no set-point beyond")
    axle_position_m: tuple[Place, Place, Place, Place] = Field(
        default=(0.0, 2.42, 16.9, 19.32), description="of axles 1..4 behind the first, in rising order"
    )
    search_above_mps: float = Field(default=6.0, ge=0.0, le=100.0)
    settling_s: float = Field(default=0.25, ge=0.0, le=10.0, description="of even slip before figures count")
    measuring_s: float = Field(default=0.6, gt=0.0, le=10.0, description="of evenly slipping axles, for each figure")
    longest_trial_s: float = Field(default=4.0, gt=0.0, le=20.0, description="given up when not measured by then")
    first_interval_s: float = Field(default=0.8, gt=0.0, le=60.0, description="between trials when the last was news")
    last_interval_s: float = Field(default=6.0, gt=0.0, le=60.0, description="between trials when there is no news")
    scout_level: int = Field(
        default=3, ge=1, le=LEVELS - 1, description="tried from wherever, as what it does is seen best"
    )
    scout_interval_s: float = Field(default=10.0, gt=0.0, le=100.0, description="doubled whenever it was in vain")
    figures_kept: float = Field(default=3.0, ge=1.0, le=100.0, description="a level's figures are the mean of so many")
    margin: float = Field(default=0.004, ge=0.0, le=1.0, description="adhesion that a level higher has to gain")
    persistence: float = Field(default=0.005, ge=0.0, le=1.0, description="in favour of the level in use")

    @model_validator(mode="after")
    def _rise(self) -> Self:
        for key in ("slip_share", "axle_position_m"):
            values = getattr(self, key)
            if any(not upper > lower for lower, upper in pairwise(values)):
                raise ValueError(f"{key} = {values}: values in rising order are needed")
        return self
