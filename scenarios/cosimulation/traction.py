"""[traction]: what drives the coach, and the anti-skid control between the driver's demand and the wheelsets."""

from typing import Annotated, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from scenarios.units import KMH_PER_MPS
from wsp import AntiSkid, AntiSkidParameters

Wheelset = Annotated[int, Field(ge=1, le=4)]

_SLOWEST_MPS = 1.0  # below this speed the power no longer limits the force


class TractionParameters(BaseModel):
    """Drive of the coach: driven wheelsets alike, limited in force, in its rise and in power."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    driven_wheelsets: tuple[Wheelset, ...] = Field(default=(1, 2, 3, 4), min_length=1, max_length=4)
    largest_force_n: float = Field(default=60_000.0, gt=0.0, le=1e6, description="of all driven wheelsets together")
    force_rise_nps: float = Field(default=30_000.0, gt=0.0, le=1e7)
    largest_power_kw: float = Field(
        default=2_000.0, gt=0.0, le=1e5, description="at the rims of all driven wheelsets, at the speed of each"
    )
    largest_rim_speed_kmh: float = Field(default=250.0, gt=0.0, le=600.0, description="overspeed: no torque beyond")
    anti_skid: bool = Field(default=True, description="slip control of the driven wheelsets")
    anti_skid_parameters: AntiSkidParameters = AntiSkidParameters()

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        if len(set(self.driven_wheelsets)) < len(self.driven_wheelsets):
            raise ValueError(f"driven_wheelsets = {self.driven_wheelsets}: each wheelset once")
        return self

    def force_limit_n(self, speed_mps: float) -> float:
        """Largest force of the coach at a speed."""
        return min(self.largest_force_n, 1000.0 * self.largest_power_kw / max(speed_mps, _SLOWEST_MPS))


class Traction:
    """From the driver's force to the drive torques of the wheelsets, tick by tick.

    `torque_nm` (4,): in force since the last `step`. A force acts at once; what the anti-skid makes of the speeds that
    it reads at a tick acts from the next one on, as every link has it.
    """

    def __init__(self, parameters: TractionParameters, wheel_radius_m: float, period_s: float) -> None:
        driven = np.zeros(4)
        driven[np.array(parameters.driven_wheelsets) - 1] = 1.0
        self._parameters = parameters
        self._torque_per_force_m = driven / driven.sum() * wheel_radius_m
        self._anti_skid = AntiSkid(parameters.anti_skid_parameters, period_s) if parameters.anti_skid else None
        self.torque_nm = np.zeros(4)
        self._answered_nm = np.zeros(4)

    def rest(self) -> None:
        """Nothing is asked: the anti-skid begins anew when it is."""
        if self._anti_skid is not None:
            self._anti_skid.reset()

    def step(self, force_n: float, axle_speed_mps: np.ndarray, valid: np.ndarray) -> None:
        """Answer the driver's force (whole coach, N) and the tachometers (4,) of a tick.

        A motor knows its own speed: beyond the power limit its torque falls with it.
        """
        p = self._parameters
        rim_mps = np.abs(axle_speed_mps)
        limit_n = 1000.0 * p.largest_power_kw / np.maximum(rim_mps, _SLOWEST_MPS)
        limit_n[rim_mps > p.largest_rim_speed_kmh / KMH_PER_MPS] = 0.0
        asked_nm = np.minimum(force_n, limit_n) * self._torque_per_force_m
        if self._anti_skid is None:
            self.torque_nm[:] = asked_nm
            return
        self.torque_nm[:] = self._answered_nm
        self._answered_nm[:] = self._anti_skid.step(axle_speed_mps, valid, asked_nm)
