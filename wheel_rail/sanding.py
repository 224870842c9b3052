"""Sanding: nozzles at chosen wheelsets lay sand on both rails; what lies there raises the friction of later wheels.

The sand on a rail counts in g/m. Friction moves from the rail's own towards that of plenty of sand, by the share
1 - exp(-sand/effective_gpm), and never down; each wheel that passes crushes or throws off a part of the sand.
"""

from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from wheel_rail.adhesion_state import SAND_KEPT, RailTables, spread
from wheel_rail.compiled import Array, address_of, array_at, compiled, record_reader

MOST_SANDERS = 8
# columns of a sander's row for `lay_sand`
WHEELSET, OFFSET, FLOW = range(3)

SANDERS = np.dtype(
    [
        ("count", "i8"),
        ("rows_at", "i8"),  # (count, 3)
        ("asked_at", "i8"),  # (count, slots): flow asked for, in a ring of periods
        ("slots", "i8"),
        ("steps", "i8"),
        ("rate_gps", "f8", (MOST_SANDERS,)),
        ("delay", "i8", (MOST_SANDERS,)),  # in periods
    ]
)
"""What the compiled part of `Sanders` works on."""

_sanders_at = record_reader(SANDERS)


class SandEffect(BaseModel):
    """What sand does to the rail. All figures are assumed: no measured curve over g/m is at hand."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    sanded_adhesion: float = Field(
        default=0.15, gt=0.0, le=0.5, description="peak adhesion under plenty of sand, at 68.7 kN and 100 km/h"
    )
    effective_gpm: float = Field(default=3.0, gt=0.0, description="sand on one rail that gives 63 % of the gain")
    left_share: float = Field(default=0.5, ge=0.0, le=1.0, description="of the sand, after a wheel has passed")


class SanderParameters(BaseModel):
    """One sander: a pair of nozzles, one over each rail."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    wheelset: int = Field(ge=1, le=4, description="the wheelset it is fixed to, from the front")
    offset_m: float = Field(
        default=-0.6, ge=-3.0, le=3.0, description="where sand meets the rail, ahead of the wheelset; negative behind"
    )
    rate_gps: float = Field(default=30.0, gt=0.0, le=500.0, description="on each rail")
    delay_s: float = Field(default=0.5, ge=0.0, le=10.0, description="from the command to sand on the rail, and back")


class SandingParameters(BaseModel):
    """The sanders of a train, and what sand does."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    sanders: tuple[SanderParameters, ...] = Field(default=(), max_length=MOST_SANDERS)
    effect: SandEffect = SandEffect()

    @model_validator(mode="after")
    def _one_at_a_place(self) -> Self:
        places = [(sander.wheelset, sander.offset_m) for sander in self.sanders]
        for k, place in enumerate(places):
            if place in places[:k]:
                raise ValueError(f"sanders.{k}.offset_m = {place[1]}: there is a sander at this place already")
        return self


class Sanders:
    """The sanders' valves: commands in, flow out after each one's delay. `rows` (m, 3) is what `lay_sand` reads."""

    def __init__(self, parameters: SandingParameters, period_s: float) -> None:
        """`period_s`: of `step`; the delays are rounded to whole periods."""
        sanders = parameters.sanders
        self.rows = np.zeros((len(sanders), 3))
        self.rows[:, WHEELSET] = [sander.wheelset - 1 for sander in sanders]
        self.rows[:, OFFSET] = [sander.offset_m for sander in sanders]
        delays = [round(sander.delay_s / period_s) for sander in sanders]
        self._asked = np.zeros((len(sanders), max(delays, default=0) + 1))
        self._record = np.zeros(1, SANDERS)
        record = self._record[0]
        record["count"], record["slots"] = self._asked.shape
        record["rows_at"], record["asked_at"] = address_of(self.rows), address_of(self._asked)
        record["rate_gps"][: len(sanders)] = [sander.rate_gps for sander in sanders]
        record["delay"][: len(sanders)] = delays
        self.address = address_of(self._record)
        """Of a record of SANDERS, for `work_sanders`; valid as long as this object lives."""

    def step(self, sand: ArrayLike) -> None:
        """Take the command per wheelset, `sand` (4,) of bool, and set the flows that hold for the next period."""
        work_sanders(self.address, np.array(sand, dtype=np.bool_).view(np.uint8))


@compiled
def work_sanders(address: int, sand: NDArray[np.uint8]) -> None:
    """`Sanders.step` by the address of its record; `sand` (4,): 0 or 1."""
    sanders = _sanders_at(address)
    rows = array_at(sanders.rows_at, (sanders.count, 3))
    asked = array_at(sanders.asked_at, (sanders.count, sanders.slots))
    for k in range(sanders.count):
        asked[k, sanders.steps % sanders.slots] = sanders.rate_gps[k] * sand[int(rows[k, WHEELSET])]
        rows[k, FLOW] = asked[k, (sanders.steps - sanders.delay[k]) % sanders.slots]
    sanders.steps += 1


@compiled
def lay_sand(rail: RailTables, sanders: Array, s0_m: Array, s1_m: Array, step_s: float) -> None:
    """What all sanders (rows of `Sanders.rows`) lay on both rails while wheelset i goes from s0_m[i] to s1_m[i]."""
    for k in range(sanders.shape[0]):
        mass = sanders[k, FLOW] * step_s
        if mass > 0.0:
            i = int(sanders[k, WHEELSET])
            offset = sanders[k, OFFSET]
            # at standstill it piles up in one cell
            spread(rail, SAND_KEPT, s0_m[i] + offset, s1_m[i] + offset, mass, mass)
