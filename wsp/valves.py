"""The pair of magnet valves of an axle: hold shuts the supply off, vent opens to the atmosphere.

FILL = neither energised (the brake works without a controller), HOLD = hold energised, VENT = both energised.
A command acts after the dead time, a whole number of base steps; then the passage opens or shuts linearly over the
opening time. A stuck valve stays where it is, whatever its coil does.
"""

from wsp.compiled import compiled

FILL = 0
HOLD = 1
VENT = 2

FREE = 0
STUCK_OPEN = 1
STUCK_SHUT = 2


@compiled
def stuck_at(target: float, stuck: int) -> float:
    """Where a passage goes that is sent to `target` (0 or 1), the valve being FREE, STUCK_OPEN or STUCK_SHUT."""
    if stuck == STUCK_OPEN:
        return 1.0
    if stuck == STUCK_SHUT:
        return 0.0
    return target


@compiled
def supply_open(code: int) -> float:
    """Passage from the distributor to the cylinder that the hold valve moves to: 1 open, 0 shut."""
    return 1.0 if code == FILL else 0.0


@compiled
def exhaust_open(code: int) -> float:
    """Passage from the cylinder to the atmosphere that the vent valve moves to: 1 open, 0 shut."""
    return 1.0 if code == VENT else 0.0


@compiled
def passage_after(passage: float, target: float, share: float) -> float:
    """Passage (0..1) of a valve after a step of `share` opening times on its way to the target (0 or 1)."""
    if target > passage:
        return min(target, passage + share)
    return max(target, passage - share)


@compiled
def mean_passage(passage: float, target: float, share: float) -> float:
    """Mean passage over that step. The ramp may end within it: what flows does not depend on where the steps begin."""
    way = abs(target - passage)
    if way >= share:
        return 0.5 * (passage + passage_after(passage, target, share))
    return target + 0.5 * (passage - target) * way / share
