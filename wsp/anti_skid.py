"""Anti-skid of traction: the torque of driven wheelsets, reduced before their wheels spin away on slippery rail.

It sees the axle speeds of the tachometers and what it has let the motors do. From both it observes, per axle, the
torque that the rail takes (inertia I, radius R; rim acceleration a from the same filter as the brake's controllers use)

    rail torque = torque - I a/R

and, summed over all axles, the train's acceleration. Reference speed: the slowest axle, for a driven wheel is never
slower than the train; its rise is limited to that acceleration and a margin, wide while a wheel grips and narrow while
all are held back, because all driven axles may spin together. It is dead reckoning then, and every few seconds the
slowest axle is relieved for a moment: a wheel that pulls little rolls at the train's speed. From the errors seen there
it learns what else accelerates the train: gradient, resistance, a mass that is not the one assumed.

Each axle: when the slip speed or the acceleration against the train is too large, the torque falls below what the rail
was taking, and on until the wheel comes back; then most of the largest rail torque seen meanwhile is given back, and
the torque rises slowly towards the edge again, faster the longer nothing happens.
"""

import math

import numpy as np
from numpy.typing import NDArray

from wsp.anti_skid_parameters import AntiSkidParameters
from wsp.anti_skid_record import AXLES, anti_skid_record
from wsp.axle_speed import fading_memory_after
from wsp.compiled import FloatArray, Record, compiled

GRIPS, SLIPS, RELIEVED = range(3)


@compiled
def _observe(c: Record, axle_speed_mps: FloatArray, valid: NDArray[np.bool_], direction: float) -> float:
    """Filter the axle speeds (nan where not valid), find the rails' torques and the train's acceleration.

    Returns the slowest axle's speed, nan if none is valid.
    """
    slowest = np.nan
    total = 0.0
    for axle in range(AXLES):
        c.felt_nm[axle] += (1.0 - c.memory) * (c.in_force_nm[axle] - c.felt_nm[axle])
        c.in_force_nm[axle] = c.torque_nm[axle]
        measured = max(0.0, direction * axle_speed_mps[axle])
        if not valid[axle] or np.isnan(axle_speed_mps[axle]):
            c.speed_mps[axle] = np.nan
            c.rail_nm[axle] = c.felt_nm[axle]
            total += c.rail_nm[axle]
            continue
        if np.isnan(c.speed_mps[axle]):
            c.speed_mps[axle], c.acceleration_mps2[axle] = measured, c.train_mps2
        else:
            c.speed_mps[axle], c.acceleration_mps2[axle] = fading_memory_after(
                c.speed_mps[axle], c.acceleration_mps2[axle], measured, c.memory, c.period_s
            )
        inertia = c.inertia_kgm2 / c.wheel_radius_m * c.acceleration_mps2[axle]
        c.rail_nm[axle] = max(0.0, c.felt_nm[axle] - inertia)
        total += c.rail_nm[axle]
        if not c.speed_mps[axle] >= slowest:
            slowest = c.speed_mps[axle]
    seen = min(total / (c.wheel_radius_m * c.mass_kg), c.rise_limit_mps2)
    c.train_mps2 += (1.0 - c.train_memory) * (seen - c.train_mps2)
    return slowest


@compiled
def _follow_train(c: Record, slowest_mps: float, outside_mps: float) -> None:
    """Reference speed one tick on; an outside speed is taken as it is."""
    if not np.isnan(outside_mps):
        c.reference_mps = abs(outside_mps)
        c.started = 1
        c.unsure_s = 0.0
        return
    if np.isnan(slowest_mps):
        c.reference_mps += (c.train_mps2 + c.unknown_mps2) * c.period_s
        return
    if c.started == 0:
        c.started = 1
        c.reference_mps = slowest_mps
    all_held = True
    for axle in range(AXLES):
        if c.mode[axle] == GRIPS and c.since_slip_s[axle] >= c.quiet_s and not np.isnan(c.speed_mps[axle]):
            all_held = False
    predicted = c.reference_mps + (c.train_mps2 + c.unknown_mps2) * c.period_s
    error = slowest_mps - predicted
    c.reference_mps = min(slowest_mps, predicted + (c.margin_at_work_mps2 if all_held else c.margin_mps2) * c.period_s)
    if not all_held or error < 0.0:
        _learn(c, c.learn_ps2 * error * c.period_s)
    c.unsure_s = c.unsure_s + c.period_s if all_held else 0.0


@compiled
def _learn(c: Record, change_mps2: float) -> None:
    """What accelerates the train beside its motors (gradient, resistance, a mass that is not the one assumed)."""
    c.unknown_mps2 = min(max(c.unknown_mps2 + change_mps2, -c.margin_mps2), c.margin_mps2)


@compiled
def _is_sure(c: Record, axle: int) -> None:
    """This axle pulls little and keeps in step with the train: its speed is the train's."""
    if c.unsure_s > c.relieve_s:
        _learn(c, (c.speed_mps[axle] - c.reference_mps) / c.unsure_s)
    c.reference_mps = c.speed_mps[axle]
    c.unsure_s = 0.0


@compiled
def _relieve(c: Record) -> None:
    """Choose an axle to be relieved when none has been sure for too long, and take the train's speed from it."""
    for axle in range(AXLES):
        if c.mode[axle] == RELIEVED:
            c.relieved_s += c.period_s
            if np.isnan(c.speed_mps[axle]) or c.relieved_s >= c.relieve_s:
                c.mode[axle] = GRIPS
                c.since_slip_s[axle] = 0.0
                c.limit_nm[axle] = c.restore_share * c.largest_rail_nm[axle]
                if abs(c.acceleration_mps2[axle] - c.train_mps2 - c.unknown_mps2) < c.return_mps2:
                    _is_sure(c, axle)
                c.unsure_s = 0.0
            return
    if c.unsure_s < c.relieve_every_s:
        return
    slowest = -1
    for axle in range(AXLES):
        if not np.isnan(c.speed_mps[axle]) and (slowest < 0 or c.speed_mps[axle] < c.speed_mps[slowest]):
            slowest = axle
    if slowest >= 0:
        c.mode[slowest] = RELIEVED
        c.relieved_s = 0.0
        c.largest_rail_nm[slowest] = max(c.rail_nm[slowest], c.largest_rail_nm[slowest])


@compiled
def _limit(c: Record, axle: int, demand_nm: float) -> None:
    """Torque limit of an axle one tick on: the rules at the head of this file."""
    slip = c.speed_mps[axle] - c.reference_mps
    much = c.slip_offset_mps + c.slip_share * c.reference_mps
    excess = c.acceleration_mps2[axle] - c.train_mps2 - c.unknown_mps2
    rail = c.rail_nm[axle]
    if c.mode[axle] == RELIEVED:
        c.limit_nm[axle] = c.relieve_share * c.largest_rail_nm[axle]
    elif c.mode[axle] == SLIPS:
        c.largest_rail_nm[axle] = max(c.largest_rail_nm[axle], rail)
        if slip < c.gripping_share * much:
            c.mode[axle] = GRIPS
            c.since_slip_s[axle] = 0.0
            c.limit_nm[axle] = c.restore_share * c.largest_rail_nm[axle]
        elif excess > -c.return_mps2:
            least = c.relieve_share * c.largest_rail_nm[axle]
            c.limit_nm[axle] -= c.cut_rate_ps * c.largest_rail_nm[axle] * c.period_s
            if c.limit_nm[axle] <= least:
                c.limit_nm[axle] = least
                c.since_slip_s[axle] += c.period_s
                if c.since_slip_s[axle] >= c.relieve_s and excess < c.return_mps2:
                    _is_sure(c, axle)
    elif slip > much or (slip > c.gripping_share * much and excess > c.excess_mps2):
        c.mode[axle] = SLIPS
        c.since_slip_s[axle] = 0.0
        c.largest_rail_nm[axle] = rail
        c.limit_nm[axle] = c.cut_share * rail
    else:
        c.since_slip_s[axle] += c.period_s
        if c.since_slip_s[axle] >= c.quiet_s:
            rise = c.free_rise_nmps
        else:
            growth = 1.0 + c.seek_growth_ps * c.since_slip_s[axle]
            rise = min(c.seek_rate_ps * growth * c.largest_rail_nm[axle], c.free_rise_nmps)
        c.limit_nm[axle] += rise * c.period_s
    c.limit_nm[axle] = min(max(c.limit_nm[axle], c.least_share * demand_nm), demand_nm)


@compiled
def forget_slips(c: Record) -> None:
    """`AntiSkid.reset` on its record."""
    for axle in range(AXLES):
        c.speed_mps[axle] = np.nan
        c.acceleration_mps2[axle] = 0.0
        c.torque_nm[axle] = c.in_force_nm[axle] = c.felt_nm[axle] = 0.0
        c.rail_nm[axle] = c.limit_nm[axle] = c.largest_rail_nm[axle] = 0.0
        c.mode[axle] = GRIPS
        c.since_slip_s[axle] = c.quiet_s
    c.relieved_s = c.unsure_s = 0.0
    c.reference_mps = c.train_mps2 = c.unknown_mps2 = 0.0
    c.started = 0


@compiled
def _turn(c: Record, demand_nm: FloatArray) -> bool:
    """Take the direction of the demand, a new one from rest; False for a demand not finite or of both signs."""
    forward = backward = False
    for axle in range(AXLES):
        if not np.isfinite(demand_nm[axle]):
            return False
        forward = forward or demand_nm[axle] > 0.0
        backward = backward or demand_nm[axle] < 0.0
    if forward and backward:
        return False
    direction = 1.0 if forward else (-1.0 if backward else c.direction)
    if direction != c.direction:
        c.direction = direction
        forget_slips(c)
    return True


@compiled
def advance_anti_skid(
    c: Record, axle_speed_mps: FloatArray, valid: NDArray[np.bool_], demand_nm: FloatArray, outside_mps: float
) -> bool:
    """`AntiSkid.step` on its record, to `answer_nm`; False, and nothing done, for a demand that makes no sense."""
    if not _turn(c, demand_nm):
        return False
    _follow_train(c, _observe(c, axle_speed_mps, valid, c.direction), outside_mps)
    _relieve(c)
    smallest = np.inf
    for axle in range(AXLES):
        if not np.isnan(c.speed_mps[axle]):
            _limit(c, axle, abs(demand_nm[axle]))
            smallest = min(smallest, c.limit_nm[axle])
    for axle in range(AXLES):
        if np.isnan(c.speed_mps[axle]):  # not seen: no more than the most careful of the others
            c.limit_nm[axle] = min(smallest, abs(demand_nm[axle])) if smallest < np.inf else 0.0
        c.torque_nm[axle] = c.limit_nm[axle]
        c.answer_nm[axle] = c.torque_nm[axle] * c.direction
    return True


@compiled
def _advance_first(
    records: np.ndarray, axle_speed_mps: FloatArray, valid: NDArray[np.bool_], demand_nm: FloatArray, outside: float
) -> bool:
    return advance_anti_skid(records[0], axle_speed_mps, valid, demand_nm, outside)


@compiled
def _forget_first(records: np.ndarray) -> None:
    forget_slips(records[0])


class AntiSkid:
    """Slip control of four driven wheelsets; what it answers at one tick acts from the next one on.

    An axle whose speed is not valid gets no more than the most careful of the others, and nothing if there is none.
    """

    Parameters = AntiSkidParameters

    def __init__(self, parameters: AntiSkidParameters, period_s: float) -> None:
        """Raises ValueError for a period that is not positive and finite."""
        if not (math.isfinite(period_s) and period_s > 0.0):
            raise ValueError(f"period_s = {period_s}: a positive number of seconds is needed")
        self.parameters = parameters
        self.period_s = period_s
        self.record: np.ndarray = anti_skid_record(parameters, period_s)
        """(1,) of ANTI_SKID: all that it is; compiled code hands `record[0]` to advance_anti_skid."""
        self._demand_nm = np.zeros(AXLES)
        self._answer_nm: NDArray[np.float64] = self.record["answer_nm"][0]
        self.reset()

    def reset(self) -> None:
        """Forget speeds and torques: all axles free, at rest until the tachometers say otherwise."""
        _forget_first(self.record)

    @property
    def reference_speed_mps(self) -> float:
        """The train's speed as the anti-skid believes, positive in the direction of the demand."""
        return float(self.record["reference_mps"][0])

    def step(
        self,
        axle_speed_mps: NDArray[np.float64],
        valid: NDArray[np.bool_],
        demand_nm: NDArray[np.float64] | float,
        reference_mps: float = math.nan,
    ) -> NDArray[np.float64]:
        """Torques of the next period, (4,) Nm of the demand's sign and never beyond it; a view.

        axle_speed_mps, valid (4,): tachometers. demand_nm: torque demanded of each axle, (4,) or one for all, of one
        sign: that of the direction of travel, positive forward. reference_mps: the train's speed from elsewhere, nan
        for none. Raises ValueError for a demand that is not finite or of both signs.
        """
        self._demand_nm[:] = demand_nm
        if not _advance_first(self.record, axle_speed_mps, valid, self._demand_nm, reference_mps):
            raise ValueError(f"demand_nm = {demand_nm}: finite torques of one sign are needed")
        return self._answer_nm
