"""From slip set-points to valve commands: predictor of the valves' dead time, sliding line, pulses.

A wheelset obeys da = f - b p: its rim accelerates with what adhesion gives (f, m/s2) less what the brake takes (b m/s2
a bar). The known changes of p are fed into the speed filter, which thereby follows f. Supposing that f stays as it is,
the pressures that are already on their way (wsp.controllers.cylinder_model) tell slip speed w and acceleration a
against the train for the moment from which a new command acts. There

    a_wanted = gain (w - w_set), bounded

makes the slip approach its set-point like exp(-gain t), and the pressure is to change by (a - a_wanted)/b. A pulse goes
on as long as that is more than a share of what one more tick of it gives. Absolute pressures do not enter, so that the
model's offsets do not matter.

As all axles can thus slip evenly, none of them tells the train's speed for long. Between two reliefs (see
wsp.controllers.axle_release) the deceleration follows the adhesion forces: it changes by the rotating share of the
change of mean f, since the train's mass feels the same forces as the wheelsets.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wsp.compiled import Record
from wsp.controllers.axle_release import NO_AXLE, still_falls
from wsp.controllers.cylinder_model import (
    commit,
    committed_before,
    cylinder_constants,
    cylinder_state,
    follow_demand,
    pressure_after,
)
from wsp.controllers.grip import go_by_gripping_axles, grip_state, grips
from wsp.controllers.interface import AXLES
from wsp.controllers.limits import command_the_rest, guarded, sighted
from wsp.controllers.records import part_of_tick
from wsp.controllers.slip_law_parameters import SlipLawControllerParameters
from wsp.controllers.supervision import observe, under_control
from wsp.valves import FILL, HOLD, VENT

_EMPTY_BAR = 0.05  # supposed to be out: a vent valve left open costs nothing, and makes sure
_GRIPPING_SHARE = 0.5  # of its relief by which a gripping axle's adhesion has fallen at least
_ROLLS_WITHIN_MPS, _ROLLING_S = 0.3, 0.5  # of the reference; memory of the deceleration
_LOST_MPS = 1.0  # beyond its set-point a relieved axle is no longer left to its relief: worse rail has come
_EVEN_FOR_S = 1.5
_FURTHER_RELIEF_BAR = 0.03  # a tick, for a relieved axle that still falls


def slip_law_constants(p: SlipLawControllerParameters, period_s: float) -> dict[str, Any]:
    """Constants by name, besides the supervision's."""
    return {
        **cylinder_constants(p.cylinder, period_s),
        **p.law.model_dump(exclude={"adhesion_memory_s"}),
        "adhesion_smoothing": min(1.0, period_s / p.law.adhesion_memory_s),
    }


def slip_law_state() -> dict[str, Any]:
    """State by name, besides the supervision's: adhesion f, m/s2, its mean, set-points, relief from and to."""
    return {
        **cylinder_state(),
        **grip_state(),
        "adhesion_mps2": np.zeros(AXLES),
        "mean_adhesion_mps2": 0.0,
        "slip_set_mps": np.zeros(AXLES),
        "relieved_from_bar": 0.0,
        "relieved_from_mps2": 0.0,
        "relieved_to_bar": 0.0,
    }


@part_of_tick
def _grips(s: Record, c: Record) -> bool:
    """Whether the relieved axle's adhesion has gone down with its brake: a sliding one's does not depend on it.

    With its pressure held a sliding axle does not go on evenly for long, so that in the end that alone will do.
    """
    if s.relieved == NO_AXLE:
        return False
    if s.relieved_ticks * c.period_s > _EVEN_FOR_S:
        return True
    acting_bar = committed_before(s, s.relieved, c.delay)
    relief = c.mps2_per_bar * (s.relieved_from_bar - acting_bar)
    adhesion = s.acceleration_mps2[s.relieved] + c.mps2_per_bar * acting_bar
    return bool(relief > 0.0 and s.relieved_from_mps2 - adhesion > _GRIPPING_SHARE * relief)


@part_of_tick
def _go_by_rolling_axles(s: Record, c: Record) -> None:
    """The train decelerates no more than its axles while they all roll and nobody works their brakes."""
    total = 0.0
    count = 0
    for axle in range(AXLES):
        if sighted(s, axle):
            if abs(s.speed_mps[axle] - s.reference_mps) > _ROLLS_WITHIN_MPS:
                return
            total -= s.acceleration_mps2[axle]
            count += 1
    if count > 0 and s.deceleration_mps2 > total / count:
        error = s.deceleration_mps2 - total / count
        s.deceleration_mps2 -= min(error / _ROLLING_S, c.jerk_decline_mps3) * c.period_s


@part_of_tick
def observe_adhesion(s: Record, c: Record, inputs: Record) -> bool:
    """`observe`, with the brake's changes fed forward; adhesion f of every axle and the deceleration from it."""
    follow_demand(s, c, inputs.demand)
    for axle in range(AXLES):
        # a reading is the mean over the past tick, and the difference of two the acceleration one tick ago
        change = committed_before(s, axle, c.delay) - committed_before(s, axle, c.delay + 1)
        s.acceleration_mps2[axle] -= c.mps2_per_bar * change
    s.grips = _grips(s, c)
    at_work = observe(s, c, inputs)
    mean = 0.0
    for axle in range(AXLES):
        if sighted(s, axle):
            adhesion = s.acceleration_mps2[axle] + c.mps2_per_bar * committed_before(s, axle, c.delay)
            s.adhesion_mps2[axle] += c.adhesion_smoothing * (adhesion - s.adhesion_mps2[axle])
        mean += s.adhesion_mps2[axle] / AXLES
    s.deceleration_mps2 += c.rotating_share * (mean - s.mean_adhesion_mps2)
    s.mean_adhesion_mps2 = mean
    if np.isnan(inputs.outside_reference_mps):
        if under_control(s, c):
            go_by_gripping_axles(s, c)
        else:
            _go_by_rolling_axles(s, c)
    return at_work


@part_of_tick
def _for_slip(s: Record, c: Record, axle: int) -> int:
    """Valve code of an axle that is to slip as set; one that is not under control yet is vented or left alone."""
    acting = committed_before(s, axle, c.delay)
    acceleration = s.acceleration_mps2[axle] + s.deceleration_mps2
    slip = s.reference_mps - s.speed_mps[axle]
    for ago in range(c.delay - 1, -1, -1):
        slip -= (acceleration - c.mps2_per_bar * (committed_before(s, axle, ago) - acting)) * c.period_s
    held = pressure_after(s, c, axle, HOLD)
    ahead = acceleration - c.mps2_per_bar * (held - acting)
    wanted = min(max(c.gain_ps * (slip - s.slip_set_mps[axle]), -c.approach_mps2), c.recovery_mps2)
    change = (ahead - wanted) / c.mps2_per_bar
    alone = s.since_vent[axle] >= c.quiet
    if alone and slip < c.start_offset_mps + c.start_share * s.reference_mps and ahead > -c.start_fall_mps2:
        return FILL
    if grips(s, axle) and slip < s.slip_set_mps[axle]:
        return FILL
    if abs(change) < c.noise_share * s.noise_mps2[axle] / c.mps2_per_bar:
        return FILL if alone else HOLD
    # what a tick of a command gives, half of it while the valve opens and half while it shuts
    if change < 0.0:
        vented = 2.0 * (held - pressure_after(s, c, axle, VENT))
        if held < _EMPTY_BAR or -change > c.vent_share * vented:
            return VENT
    elif change > c.fill_share * 2.0 * (pressure_after(s, c, axle, FILL) - held):
        return FILL
    return FILL if alone else HOLD


@part_of_tick
def _relieved(s: Record, c: Record, axle: int) -> int:
    """Valve code of the axle that is relieved to show the train's speed: a little below its adhesion, then held."""
    if s.relieved_ticks == 0:
        less = max(c.relief_share * s.adhesion_mps2[axle], c.least_relief_mps2)
        s.relieved_from_bar = committed_before(s, axle, c.delay)
        s.relieved_from_mps2 = s.adhesion_mps2[axle]
        s.relieved_to_bar = s.committed_bar[axle] - less / c.mps2_per_bar
    elif still_falls(s, c):
        s.relieved_to_bar -= _FURTHER_RELIEF_BAR
    if s.reference_mps - s.speed_mps[axle] > s.slip_set_mps[axle] + _LOST_MPS:
        return _for_slip(s, c, axle)
    held = pressure_after(s, c, axle, HOLD)
    if held - s.relieved_to_bar > held - pressure_after(s, c, axle, VENT) > 0.0:
        return VENT
    return HOLD


@part_of_tick
def command_slips(s: Record, c: Record, valve: NDArray[np.int8], at_work: bool) -> None:
    """Fill in the valve codes that lead every axle to its set-point (s.slip_set_mps) within the limits."""
    for axle in range(AXLES):
        if at_work and sighted(s, axle):
            code = _relieved(s, c, axle) if axle == s.relieved else _for_slip(s, c, axle)
            valve[axle] = guarded(s, c, axle, code)
    command_the_rest(s, c, valve, at_work)
    commit(s, c, valve)
