"""The pair of magnet valves of an axle: hold shuts the supply off, vent opens to the atmosphere.

FILL = neither energised (the brake works without a controller), HOLD = hold energised, VENT = both energised.
A command acts after the dead time, a whole number of base steps; then the passage opens or shuts linearly over the
opening time.
"""

from numba import njit

FILL = 0
HOLD = 1
VENT = 2


@njit(cache=True)
def supply_open(code: int) -> float:
    """Passage from the distributor to the cylinder that the hold valve moves to: 1 open, 0 shut."""
    return 1.0 if code == FILL else 0.0


@njit(cache=True)
def exhaust_open(code: int) -> float:
    """Passage from the cylinder to the atmosphere that the vent valve moves to: 1 open, 0 shut."""
    return 1.0 if code == VENT else 0.0


@njit(cache=True)
def passage_after(passage: float, target: float, share: float) -> float:
    """Passage (0..1) of a valve after a step of `share` opening times on its way to the target (0 or 1)."""
    if target > passage:
        return min(target, passage + share)
    return max(target, passage - share)


@njit(cache=True)
def mean_passage(passage: float, target: float, share: float) -> float:
    """Mean passage over that step. The ramp may end within it: what flows does not depend on where the steps begin."""
    way = abs(target - passage)
    if way >= share:
        return 0.5 * (passage + passage_after(passage, target, share))
    return target + 0.5 * (passage - target) * way / share
