"""[traction]: what drives the coach, and the anti-skid control between the driver's demand and the wheelsets."""

from typing import Annotated, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from scenarios.units import KMH_PER_MPS
from wheel_rail.compiled import Array, address_of, compiled, record_reader
from wsp import AntiSkid, AntiSkidParameters
from wsp.anti_skid import advance_anti_skid, forget_slips
from wsp.anti_skid_record import ANTI_SKID

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


TRACTION = np.dtype(
    [
        ("power_w", "f8"),
        ("largest_rim_mps", "f8"),
        ("torque_per_force_m", "f8", (4,)),
        ("anti_skid_at", "i8"),  # 0: none
        ("drives", "i8"),  # whether there was a force or torque at the last tick
        ("asked_nm", "f8", (4,)),
        ("answered_nm", "f8", (4,)),
        ("torque_nm", "f8", (4,)),  # in force
    ]
)
"""What the compiled part of `Traction` works on."""

traction_at = record_reader(TRACTION)
_anti_skid_at = record_reader(ANTI_SKID)


class Traction:
    """From the driver's force to the drive torques of the wheelsets, tick by tick.

    `torque_nm` (4,): in force since the last `step`. A force acts at once; what the anti-skid makes of the speeds that
    it reads at a tick acts from the next one on, as every link has it. When nothing is asked any more the anti-skid
    forgets, and begins anew when something is. `address`: of a record of TRACTION, for `drive`; valid as long as this
    object lives.
    """

    def __init__(self, parameters: TractionParameters, wheel_radius_m: float, period_s: float) -> None:
        driven = np.zeros(4)
        driven[np.array(parameters.driven_wheelsets) - 1] = 1.0
        self._anti_skid = AntiSkid(parameters.anti_skid_parameters, period_s) if parameters.anti_skid else None
        self._record = np.zeros(1, TRACTION)
        record = self._record[0]
        record["power_w"] = 1000.0 * parameters.largest_power_kw
        record["largest_rim_mps"] = parameters.largest_rim_speed_kmh / KMH_PER_MPS
        record["torque_per_force_m"] = driven / driven.sum() * wheel_radius_m
        record["anti_skid_at"] = 0 if self._anti_skid is None else address_of(self._anti_skid.record)
        self.address = address_of(self._record)
        self.torque_nm: np.ndarray = self._record["torque_nm"][0]

    def step(self, force_n: float, axle_speed_mps: np.ndarray, valid: np.ndarray) -> None:
        """Answer the driver's force (whole coach, N) and the tachometers (4,) of a tick.

        A motor knows its own speed: beyond the power limit its torque falls with it. Raises ValueError for a force
        that is not finite, which the anti-skid cannot take.
        """
        if not drive(self.address, force_n, axle_speed_mps, valid.view(np.uint8)):
            raise ValueError(f"force_n = {force_n}: a finite force is needed")


@compiled
def drive(address: int, force_n: float, axle_speed_mps: Array, valid: np.ndarray) -> bool:
    """`Traction.step` by the address of its record, `valid` (4,) 0 or 1; False for a force that is not finite."""
    traction = traction_at(address)
    if force_n == 0.0 and traction.drives == 0:
        return True
    for axle in range(4):
        rim_mps = abs(axle_speed_mps[axle])
        limit_n = traction.power_w / max(rim_mps, _SLOWEST_MPS) if rim_mps <= traction.largest_rim_mps else 0.0
        traction.asked_nm[axle] = np.minimum(force_n, limit_n) * traction.torque_per_force_m[axle]
    torque_nm, answered_nm = traction.torque_nm, traction.answered_nm
    if traction.anti_skid_at == 0:
        torque_nm[:] = traction.asked_nm
    else:
        anti_skid = _anti_skid_at(traction.anti_skid_at)
        torque_nm[:] = answered_nm
        if not advance_anti_skid(anti_skid, axle_speed_mps, valid, traction.asked_nm, np.nan):
            return False
        answered_nm[:] = anti_skid.answer_nm
    traction.drives = 1 if force_n != 0.0 or np.any(torque_nm != 0.0) else 0
    if traction.drives == 0 and traction.anti_skid_at != 0:
        forget_slips(_anti_skid_at(traction.anti_skid_at))
    return True
