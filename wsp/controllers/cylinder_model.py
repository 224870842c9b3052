"""What a controller supposes its valves to do: the cylinder pressures that its own commands lead to.

There is no pressure sensor. `committed` is the pressure of an axle when every command given so far has acted; what acts
now is what was committed `delay` ticks ago (a tick of the link, the valves' dead time, half their opening time). Flow
by ISO 6358 as in wsp.pneumatics, from a distributor that follows the demand at constant rates. Its figures are those
that the brake's drawings give; the real brake differs, so nothing here may be relied on to the last tenth of a bar.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from wsp.compiled import Record
from wsp.controllers.interface import AXLES
from wsp.controllers.records import part_of_tick
from wsp.pneumatics import ATMOSPHERE_BAR, pressure_emptied_bar, pressure_filled_bar
from wsp.valves import FILL, VENT

_REMEMBERED = 16
"""Ticks of committed pressures that are kept: more than the longest delay."""


class CylinderParameters(BaseModel):
    """The brake as the controller supposes it to be: rated figures of a disc-braked coach."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    full_service_pressure_bar: float = Field(default=3.4, gt=0.0, le=8.0)
    application_time_s: float = Field(default=4.0, gt=0.0, le=60.0)
    release_time_s: float = Field(default=19.0, gt=0.0, le=120.0)
    fill_rate_ps: float = Field(
        default=2.0, gt=0.0, le=50.0, description="conductance over volume, dm3/(s bar)/dm3: 5 over 2.5; M"
    )
    vent_rate_ps: float = Field(default=3.2, gt=0.0, le=50.0, description="the same: 8 over 2.5; M")
    critical_ratio: float = Field(default=0.3, gt=0.0, lt=1.0)
    valve_time_s: float = Field(
        default=0.04,
        ge=0.0,
        le=0.1,
        description="command to fully open, dead time and opening time; M: 20..40 ms and some 10 ms",
    )
    rim_deceleration_per_bar_mps2: float = Field(
        default=8.0,
        gt=0.0,
        le=100.0,
        description="what a bar does to a wheelset that does not grip: 1900 Nm on 0.46 m and 110 kg m2",
    )
    rotating_share: float = Field(
        default=0.037,
        gt=0.0,
        le=1.0,
        description="wheelsets' inertia over radius squared, over the mass of the train: 520 kg over 14 t",
    )


def cylinder_constants(p: CylinderParameters, period_s: float) -> dict[str, Any]:
    """Constants by name; rates are per tick."""
    return {
        "full_bar": p.full_service_pressure_bar,
        "rise_bar": p.full_service_pressure_bar / p.application_time_s * period_s,
        "fall_bar": p.full_service_pressure_bar / p.release_time_s * period_s,
        "fill_exchange": p.fill_rate_ps * period_s,
        "vent_exchange": p.vent_rate_ps * period_s,
        "critical_ratio": p.critical_ratio,
        # A command is read a tick later, and what it lets through is averaged over two ticks (opening, then open).
        "delay": 1 + round(p.valve_time_s / period_s),
        "mps2_per_bar": p.rim_deceleration_per_bar_mps2,
        "rotating_share": p.rotating_share,
    }


def cylinder_state() -> dict[str, Any]:
    """Empty cylinders. The pressures committed last and before, by tick and axle; the codes commanded last."""
    return {
        "distributor_bar": 0.0,
        "committed_bar": np.zeros(AXLES),
        "past_bar": np.zeros((_REMEMBERED, AXLES)),
        "now": 0,
        "commanded": np.full(AXLES, FILL, np.int64),
    }


@part_of_tick
def follow_demand(s: Record, c: Record, demand: float) -> None:
    """The distributor's pressure one tick on."""
    target = demand * c.full_bar
    if target >= s.distributor_bar:
        s.distributor_bar = min(target, s.distributor_bar + c.rise_bar)
    else:
        s.distributor_bar = max(target, s.distributor_bar - c.fall_bar)


@part_of_tick
def pressure_after(s: Record, c: Record, axle: int, code: int) -> float:
    """Committed pressure after one more tick of a command, bar; the passages change over within the tick."""
    before = s.commanded[axle]
    fill = 0.5 * ((1.0 if before == FILL else 0.0) + (1.0 if code == FILL else 0.0))
    vent = 0.5 * ((1.0 if before == VENT else 0.0) + (1.0 if code == VENT else 0.0))
    pressure = s.committed_bar[axle] + ATMOSPHERE_BAR
    if vent > 0.0:
        pressure = pressure_emptied_bar(pressure, ATMOSPHERE_BAR, vent * c.vent_exchange, c.critical_ratio)
    if fill > 0.0:
        source = s.distributor_bar + ATMOSPHERE_BAR
        if source >= pressure:
            pressure = pressure_filled_bar(pressure, source, fill * c.fill_exchange, c.critical_ratio)
        else:
            pressure = pressure_emptied_bar(pressure, source, fill * c.fill_exchange, c.critical_ratio)
    return pressure - ATMOSPHERE_BAR


@part_of_tick
def commit(s: Record, c: Record, valve: NDArray[np.int8]) -> None:
    """Remember the commands (4,) of a tick."""
    s.now = (s.now + 1) % _REMEMBERED
    for axle in range(AXLES):
        s.committed_bar[axle] = pressure_after(s, c, axle, valve[axle])
        s.commanded[axle] = valve[axle]
        s.past_bar[s.now, axle] = s.committed_bar[axle]


@part_of_tick
def committed_before(s: Record, axle: int, ticks_ago: int) -> float:
    """Pressure committed so many ticks ago (0: with the last command), bar."""
    return s.past_bar[(s.now - ticks_ago) % _REMEMBERED, axle]
