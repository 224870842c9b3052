"""The driver: holds a speed, coasts or brakes, by the place along the line."""

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from scenarios.cosimulation.traction import TractionParameters
from scenarios.units import KMH_PER_MPS


class DriverPhase(BaseModel):
    """What the driver does from `from_m` on, until the next phase."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    from_m: float = Field(ge=0.0)
    action: Literal["hold", "coast", "brake"]
    speed_kmh: float | None = Field(default=None, gt=0.0, le=400.0, description="to hold; for action = 'hold' only")
    demand: float | None = Field(
        default=None, gt=0.0, le=1.0, description="share of full service; for action = 'brake' only"
    )

    sand: bool = Field(default=False, description="the driver sands, at every sander")
    track_brake: bool = Field(default=False, description="the driver has the magnetic track brakes on")

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> Self:
        for key, action in (("speed_kmh", "hold"), ("demand", "brake")):
            given = getattr(self, key) is not None
            if given != (self.action == action):
                raise ValueError(
                    f"{key}: {'needed' if not given else 'belongs'} with action = '{action}'"
                    + (" only" if given else "")
                )
        return self


class DriverParameters(BaseModel):
    """Phases along the line."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    phases: tuple[DriverPhase, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        starts = [phase.from_m for phase in self.phases]
        if starts[0] != 0.0:
            raise ValueError(f"phases.0.from_m = {starts[0]}: the first phase starts at 0")
        for k in range(1, len(starts)):
            if not starts[k] > starts[k - 1]:
                raise ValueError(f"phases.{k}.from_m = {starts[k]}: must lie beyond the phase before ({starts[k - 1]})")
        return self


class Driver:
    """Turns place and speed into traction and brake demand, tick by tick.

    Holding a speed is a proportional-integral law on the speed error, limited in force and in its rise; the integral
    rests while the force is at a limit.
    """

    _GAIN_NSPM = 40_000.0  # one m/s too slow asks for most of the traction of a coach
    _RESET_TIME_S = 10.0

    def __init__(self, parameters: DriverParameters, traction: TractionParameters, period_s: float) -> None:
        self._parameters = parameters
        self._traction = traction
        self._period_s = period_s
        self._phase = 0
        self._integral_n = 0.0
        self.traction_n = 0.0
        self.demand = 0.0
        self.sand = False
        self.track_brake = False

    def step(self, position_m: float, speed_mps: float) -> None:
        """One tick: update `traction_n` (whole coach, >= 0), `demand` (0..1), `sand` and `track_brake`."""
        phases = self._parameters.phases
        while self._phase + 1 < len(phases) and position_m >= phases[self._phase + 1].from_m:
            self._phase += 1
        phase = phases[self._phase]
        wanted = 0.0
        if phase.speed_kmh is not None:
            error = phase.speed_kmh / KMH_PER_MPS - speed_mps
            wanted = self._GAIN_NSPM * error + self._integral_n
            limited = min(max(wanted, 0.0), self._traction.force_limit_n(speed_mps))
            if limited == wanted:
                self._integral_n += self._GAIN_NSPM * error * self._period_s / self._RESET_TIME_S
            wanted = limited
        else:
            self._integral_n = 0.0
        rise = self._traction.force_rise_nps * self._period_s
        self.traction_n = min(max(wanted, self.traction_n - rise), self.traction_n + rise)
        self.demand = phase.demand or 0.0
        self.sand, self.track_brake = phase.sand, phase.track_brake
