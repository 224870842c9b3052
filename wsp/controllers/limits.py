"""Limits that no control law may pass: how long an axle may go unfilled; and the axles that a law cannot command."""

import numpy as np
from numpy.typing import NDArray

from wsp.compiled import Record
from wsp.controllers.interface import AXLES
from wsp.controllers.records import part_of_tick
from wsp.valves import FILL, HOLD, VENT


@part_of_tick
def sighted(s: Record, axle: int) -> bool:
    """Whether an axle's speed is known."""
    return not np.isnan(s.speed_mps[axle])


@part_of_tick
def _leave_alone(s: Record, c: Record, axle: int) -> int:
    """An axle is left to the driver's brake, and what was done to it before forgotten; the valve code for that."""
    s.since_vent[axle] = c.quiet
    s.unfilled[axle] = 0
    s.vented[axle] = 0
    s.rolls[axle] = 0
    s.forced[axle] = 0
    return FILL


@part_of_tick
def guarded(s: Record, c: Record, axle: int, code: int) -> int:
    """Watchdog: the valve code that is commanded when the law wants `code`; counts the time since the last vent.

    Once the valves have not let air in for the longest time, they do: an axle that was vented since gets its brake
    back for a while, whatever it does (whoever vents so long is mistaken); one that was only held gets a tick of it,
    enough for the brake's own safety timer, which counts held valves as well.
    """
    if s.forced[axle] > 0:
        s.forced[axle] -= 1
        code = FILL
    elif code != FILL and s.unfilled[axle] >= c.watchdog:
        code = FILL
        if s.vented[axle] > 0:
            s.forced[axle] = c.watchdog_refill - 1
    if code == FILL:
        s.unfilled[axle] = 0
        s.vented[axle] = 0
    else:
        s.unfilled[axle] += 1
        if code == VENT:
            s.vented[axle] += 1
    s.since_vent[axle] = 0 if code == VENT else s.since_vent[axle] + 1
    return code


@part_of_tick
def partner_of(axle: int) -> int:
    """The other axle of the bogie."""
    return axle + 1 if axle % 2 == 0 else axle - 1


@part_of_tick
def _thinned(s: Record, c: Record, axle: int, code: int, under_control: bool) -> int:
    """First venting down to about the share, then that share of the ticks of filling, evenly spread."""
    if not under_control:
        s.blind_relief[axle] = c.blind_relief
        return code
    if s.blind_relief[axle] > 0:
        s.blind_relief[axle] -= 1
        return VENT
    if code != FILL:
        return code
    s.fill_due[axle] += c.blind_share
    if s.fill_due[axle] < 1.0:
        return HOLD
    s.fill_due[axle] -= 1.0
    return FILL


@part_of_tick
def command_the_rest(s: Record, c: Record, valve: NDArray[np.int8], at_work: bool) -> None:
    """Fill in the valve codes of the axles that no law commands, those of the others being there.

    A blind axle is vented with the other axle of its bogie, and while that is under control filled for a share of
    the time only for which that is: venting takes a share of a pressure and filling adds to it, so that its
    pressure tends to that share of the other's; the first step towards it is taken at once. Where its partner is
    blind as well, or no valve to be worked at all, an axle is left to the driver's brake.
    """
    for axle in range(AXLES):
        if at_work and sighted(s, axle):
            s.blind_relief[axle] = c.blind_relief
            continue
        partner = partner_of(axle)
        if at_work and sighted(s, partner):
            valve[axle] = guarded(s, c, axle, _thinned(s, c, axle, valve[partner], s.since_vent[partner] < c.quiet))
        else:
            valve[axle] = _leave_alone(s, c, axle)
