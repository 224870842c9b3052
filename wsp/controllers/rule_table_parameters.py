"""Parameters of the controller `rule-table`: bands, the table itself, pulses and limits."""

from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, model_validator

from wsp.controllers.supervision_parameters import Size, SupervisionParameters, Time

ACTIONS = "FfHvV"
"""Fill, fill in pulses, hold, vent in pulses, vent."""

ROWS, COLUMNS = 4, 5

Row = Annotated[str, Field(pattern=f"^[{ACTIONS}]{{{COLUMNS}}}$")]


class RuleTableParameters(SupervisionParameters):
    """Bands, table, pulses and limits. Times count in whole ticks of 10 ms.

    Figures marked M are those of controllers in use, known at second hand. The others were searched on eight kinds of
    rail, 0.02 to 0.08, even, in waves, in patches and in steps, whose friction falls with the slip speed (Polach's
    `low`): there the best slip is below 1 % and 10 % already costs a quarter, so the bands are far narrower than the
    10..15 % (M) of rails with a flat curve.
    """

    slip_offset_mps: tuple[Size, Size, Size] = Field(
        default=(0.15, 0.5, 0.75), description="upper borders of the first three slip bands, together with slip_share"
    )
    slip_share: tuple[Size, Size, Size] = Field(
        default=(0.006, 0.04, 0.06),
        description="border = offset + share * reference speed, with which the tachometers' noise grows",
    )
    acceleration_mps2: tuple[float, float, float, float] = Field(
        default=(-2.0, -0.75, 0.75, 3.5),
        description="borders of the bands, rim against train; M: a fall of 3 m/s2 is sliding, a rise of 1..2 recovery",
    )
    table: tuple[Row, Row, Row, Row] = Field(
        default=(
            # Gripping: refill in pulses, but let a wheel that still moves against the train settle first. A rise that
            # goes on at small slip says that the reference is too low, and filling would hide it.
            "HHfHf",
            "VvHHH",
            "VVvvH",
            "VVVHH",
        ),
        description="row = slip band, small slip first; column = acceleration band, falling fastest first",
    )
    fill_pulse_s: Time = Field(default=0.02, description="M: 20..60 ms")
    fill_cycle_s: Time = Field(default=0.10, description="a pulse shows in the rim's acceleration after some 80 ms")
    fill_growth: Size = Field(
        default=0.8,
        description="lengthens the pulse, ticks per second since the last vent: catches up where the rail improves",
    )
    vent_pulse_s: Time = 0.02
    vent_cycle_s: Time = 0.08
    relief_vent_s: Time = Field(
        default=0.06, description="venting of the axle that is relieved to show the train's speed, a quarter at 2 bar"
    )

    @model_validator(mode="after")
    def _borders_rise(self) -> Self:
        for key in ("slip_offset_mps", "slip_share", "acceleration_mps2"):
            borders = getattr(self, key)
            if any(upper < lower for lower, upper in pairwise(borders)):
                raise ValueError(f"{key} = {borders}: borders in rising order are needed")
        return self
