"""[[faults]] of a scenario: what breaks, where and when."""

from typing import Annotated, Literal, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

Axle = Annotated[int, Field(ge=1, le=4, description="from the front")]


class _Entry(BaseModel):
    """A fault that comes at `at_s` and, unless it stays, goes at `until_s`, both from the start of the run."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    at_s: float = Field(ge=0.0, description="from the start of the run; acts from the next tick of 10 ms on")
    until_s: float | None = Field(default=None, description="when it is gone again; stays without it")

    @model_validator(mode="after")
    def _ends_after_it_begins(self) -> Self:
        if self.until_s is not None and not self.until_s > self.at_s:
            raise ValueError(f"until_s = {self.until_s}: must be later than at_s = {self.at_s}")
        return self


class ValveStuck(_Entry):
    """A magnet valve that no longer follows: its passage stays open or shut."""

    kind: Literal["valve-stuck"]
    axle: Axle
    valve: Literal["hold", "vent"]
    position: Literal["open", "shut"]


class TachometerLost(_Entry):
    """No pulses, and the front end says so: not valid."""

    kind: Literal["tachometer-lost"]
    axle: Axle


class TachometerFrozen(_Entry):
    """The front end repeats its last speed, as valid as it was."""

    kind: Literal["tachometer-frozen"]
    axle: Axle


class ToothCount(_Entry):
    """The front end counts on another number of teeth than the wheel has."""

    kind: Literal["tooth-count"]
    axle: Axle
    teeth: int = Field(ge=4, le=4096)


class WheelDiameter(_Entry):
    """The front end counts on another wheel diameter."""

    kind: Literal["wheel-diameter"]
    axle: Axle
    diameter_mm: float = Field(gt=400.0, le=2000.0)


class PipeLeak(_Entry):
    """A leak behind the valves of an axle."""

    kind: Literal["pipe-leak"]
    axle: Axle
    conductance_dm3psbar: float = Field(gt=0.0, le=20.0, description="sonic conductance of the leak, ISO 6358")


class LowReservoir(_Entry):
    """The auxiliary reservoir stands at this pressure and is not resupplied."""

    kind: Literal["low-reservoir"]
    pressure_bar: float = Field(ge=0.0, le=12.0, description="gauge")


class ControllerDead(_Entry):
    """The controller no longer answers: its last commands stand until the safety timer of the valves acts. It begins
    anew when the fault is gone."""

    kind: Literal["controller-dead"]


class BrakeCutOut(_Entry):
    """The brake of an axle is isolated and vented."""

    kind: Literal["brake-cut-out"]
    axle: Axle


FaultEntry = (
    ValveStuck
    | TachometerLost
    | TachometerFrozen
    | ToothCount
    | WheelDiameter
    | PipeLeak
    | LowReservoir
    | ControllerDead
    | BrakeCutOut
)

FAULT_KINDS: dict[str, type[FaultEntry]] = {
    get_args(model.model_fields["kind"].annotation)[0]: model for model in get_args(FaultEntry)
}
"""Kind of a fault, as a scenario names it -> its entry."""
