"""The driver: accelerates to a speed and holds it, coasts, brakes to a speed or stops, by the place along the line."""

from itertools import pairwise
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from scenarios.cosimulation.traction import TractionParameters
from scenarios.units import KMH_PER_MPS

Action = Literal["hold", "coast", "brake", "stop"]

_KEYS: dict[str, tuple[tuple[Action, ...], bool]] = {
    "speed_kmh": (("hold",), True),
    "acceleration_mps2": (("hold",), False),
    "demand": (("brake", "stop"), True),
    "until_kmh": (("brake",), False),
    "standing_s": (("stop",), True),
}
"""Key of a phase -> the actions that it belongs to, and whether they need it."""


class DriverPhase(BaseModel):
    """What the driver does from `from_m` on, until the next phase.

    A phase behind one that ends of itself (`brake` with `until_kmh`, `stop`) may do without `from_m`: it follows at
    once.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    from_m: float | None = Field(default=None, ge=0.0)
    action: Action
    speed_kmh: float | None = Field(
        default=None, gt=0.0, le=400.0, description="to accelerate to and to hold; for action = 'hold' only"
    )
    acceleration_mps2: float | None = Field(
        default=None, gt=0.0, le=3.0, description="limit on the way to speed_kmh; for action = 'hold' only"
    )
    demand: float | None = Field(
        default=None, gt=0.0, le=1.0, description="share of full service; for action = 'brake' and 'stop' only"
    )
    until_kmh: float | None = Field(
        default=None, gt=0.0, le=400.0, description="at this speed the brake is released; for action = 'brake' only"
    )
    standing_s: float | None = Field(
        default=None, ge=0.0, le=3600.0, description="from standstill to the next phase; for action = 'stop' only"
    )

    sand: bool = Field(default=False, description="the driver sands, at every sander")
    track_brake: bool = Field(default=False, description="the driver has the magnetic track brakes on")

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> Self:
        for key, (actions, needed) in _KEYS.items():
            given, belongs = getattr(self, key) is not None, self.action in actions
            if (given and not belongs) or (needed and belongs and not given):
                names = " and ".join(f"'{action}'" for action in actions)
                raise ValueError(f"{key}: {'belongs' if given else 'needed'} with action = {names}" + " only" * given)
        return self

    @property
    def ends_of_itself(self) -> bool:
        return self.action == "stop" or self.until_kmh is not None


class DriverParameters(BaseModel):
    """Phases along the line."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    phases: tuple[DriverPhase, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.phases[0].from_m != 0.0:
            raise ValueError(f"phases.0.from_m = {self.phases[0].from_m}: the first phase starts at 0")
        last_m = 0.0
        for k, (before, phase) in enumerate(pairwise(self.phases), start=1):
            if phase.from_m is None:
                if not before.ends_of_itself:
                    raise ValueError(
                        f"phases.{k}.from_m: is missing; only a phase behind a stop, or behind a brake with until_kmh, "
                        "may do without"
                    )
                continue
            if before.action == "stop":
                raise ValueError(f"phases.{k}.from_m = {phase.from_m}: a phase behind a stop begins where that was")
            if not phase.from_m > last_m:
                raise ValueError(f"phases.{k}.from_m = {phase.from_m}: must lie beyond the phase before ({last_m})")
            last_m = phase.from_m
        return self


class Driver:
    """Turns place and speed into traction and brake demand, tick by tick.

    Holding a speed is a proportional-integral law on the speed error, limited in force and in its rise; the integral
    rests while the force is at a limit. With a limit of acceleration the speed wanted rises along a ramp from the speed
    at which the phase was entered, and waits for a train that falls behind.
    """

    _GAIN_NSPM = 40_000.0  # one m/s too slow asks for most of the traction of a coach
    _RESET_TIME_S = 10.0
    _LEAD_MPS = 3.0  # of the ramp: enough for all the force there is
    _STANDS_MPS = 0.05

    def __init__(self, parameters: DriverParameters, traction: TractionParameters, period_s: float) -> None:
        self._phases = parameters.phases
        self._traction = traction
        self._period_s = period_s
        self._number = 0
        self._integral_n = 0.0
        self._ramp_mps: float | None = None
        self._reached = False
        self._stood_s = 0.0
        self.traction_n = 0.0
        self.demand = 0.0
        self.sand = False
        self.track_brake = False

    @property
    def goes_on(self) -> bool:
        """Whether he stands at a station, to start again."""
        return self._phases[self._number].action == "stop" and self._number + 1 < len(self._phases)

    def step(self, position_m: float, speed_mps: float) -> None:
        """One tick: update `traction_n` (whole coach, >= 0), `demand` (0..1), `sand` and `track_brake`."""
        self._see(speed_mps)
        while self._is_over(position_m):
            self._number += 1
            self._reached, self._stood_s = False, 0.0
        phase = self._phases[self._number]
        wanted_n = 0.0
        if phase.speed_kmh is not None:
            wanted_n = self._holding_n(phase, phase.speed_kmh / KMH_PER_MPS, speed_mps)
        else:
            self._integral_n, self._ramp_mps = 0.0, None
        rise = self._traction.force_rise_nps * self._period_s
        self.traction_n = min(max(wanted_n, self.traction_n - rise), self.traction_n + rise)
        self.demand = 0.0 if self._reached else phase.demand or 0.0
        self.sand, self.track_brake = phase.sand, phase.track_brake

    def _see(self, speed_mps: float) -> None:
        """Whether the phase has done what it had to."""
        phase = self._phases[self._number]
        if phase.until_kmh is not None and speed_mps <= phase.until_kmh / KMH_PER_MPS:
            self._reached = True
        if phase.standing_s is not None and self.goes_on:
            self._stood_s = self._stood_s + self._period_s if abs(speed_mps) < self._STANDS_MPS else 0.0
            self._reached = self._stood_s > phase.standing_s

    def _is_over(self, position_m: float) -> bool:
        if self._number + 1 == len(self._phases):
            return False
        from_m = self._phases[self._number + 1].from_m
        return self._reached if from_m is None else position_m >= from_m

    def _holding_n(self, phase: DriverPhase, target_mps: float, speed_mps: float) -> float:
        if phase.acceleration_mps2 is None:
            self._ramp_mps = None
        else:
            begin = speed_mps if self._ramp_mps is None else self._ramp_mps
            ramp = min(begin + phase.acceleration_mps2 * self._period_s, speed_mps + self._LEAD_MPS)
            self._ramp_mps = target_mps = min(ramp, target_mps)
        error = target_mps - speed_mps
        wanted_n = self._GAIN_NSPM * error + self._integral_n
        limited_n = min(max(wanted_n, 0.0), self._traction.force_limit_n(speed_mps))
        if limited_n == wanted_n:
            self._integral_n += self._GAIN_NSPM * error * self._period_s / self._RESET_TIME_S
        return limited_n
