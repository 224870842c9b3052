"""The elements of a coach as the compiled forces read them: a lane for each pair of bodies that elements join.

What is the same for all elements between two bodies is worked out once a lane, and the elements of all lanes one slot
after the other. A pair with many elements stands in several lanes, where that saves slots.
"""

from dataclasses import dataclass
from itertools import groupby

import numpy as np

from wheel_rail.lanes import LANES

MOST_BATCHES = 5
SLOTS = 12
KNOTS = 864  # six slots with a curve of 24 points over deflection and one over speed along each axis

# what the elements of a slot are, rows of lanes: lower point in the lower body's axes, upper one in the upper body's,
# stiffness, damping (3 each), preload
POINT, REST, STIFFNESS, DAMPING, PRELOAD, SLOT = 0, 3, 6, 9, 12, 13
# of a batch: the upper and the lower bodies, and where their coordinates begin
BODY_UPPER, BODY_LOWER, UPPER, LOWER, PLACES = range(5)
# a knot of a curve: where its slope changes and by how much, on the side above 0 and on the side below
KNOT = 4
OVER_DEFLECTION, OVER_SPEED = 0, 1

_BATCH_COST = 3.0  # of what is worked out once, in slots


@dataclass
class _Seat:
    """A lane: two bodies and some of the elements between them; `turns` the one that knows what resists turning."""

    upper: int
    lower: int
    pushing: list[int]
    turning: list[int]


def arrange_pairs(c: np.void) -> None:
    """Set the batches, slots and knots of a coach record by its elements."""
    seats = _seated(c)
    c["batches"] = -(-len(seats) // LANES)
    for name in ("pair_place", "pair_turning", "pair_slots", "slot", "slot_knots", "knot"):
        c[name] = 0
    slot = knot = 0
    for batch in range(int(c["batches"])):
        lanes = seats[LANES * batch : LANES * (batch + 1)]
        for k, seat in enumerate(lanes):
            bodies = np.array([seat.upper, seat.lower])
            c["pair_place"][batch, :, k] = [*bodies, *c["body_place"][bodies]]
            for e in seat.turning:
                c["pair_turning"][batch, :3, k] += c["rotational_stiffness"][e]
                c["pair_turning"][batch, 3:, k] += c["rotational_damping"][e]
        depth = max(len(seat.pushing) for seat in lanes)
        c["pair_slots"][batch] = slot, slot + depth
        for _ in range(depth):
            elements = {k: seat.pushing.pop(0) for k, seat in enumerate(lanes) if seat.pushing}
            knot = _fill_slot(c, slot, elements, knot)
            slot += 1


def _fill_slot(c: np.void, slot: int, elements: dict[int, int], knot: int) -> int:
    """Set a slot of these elements by lane, its knots from `knot` on; what follows the last one."""
    rows = c["slot"][slot]
    for k, e in elements.items():
        rows[POINT:REST, k], rows[REST:STIFFNESS, k] = c["lower_point"][e], c["upper_point"][e]
        rows[STIFFNESS:DAMPING, k], rows[DAMPING:PRELOAD, k] = c["stiffness"][e], c["damping"][e]
        rows[PRELOAD, k] = c["preload"][e]
    for axis in range(3):
        for over, name in ((OVER_DEFLECTION, "stop"), (OVER_SPEED, "damper")):
            most = 0
            for k, e in elements.items():
                if c[name][e, axis] >= 0:
                    most = max(most, _fill_knots(c, int(c[name][e, axis]), knot, k))
            c["slot_knots"][slot, axis, over] = knot, knot + most
            knot += most
    return knot


def _fill_knots(c: np.void, curve: int, first: int, k: int) -> int:
    """Write the knots of a curve into lane k from row `first` on; how many there are."""
    knots = c["knot"]
    for side in range(2):
        points = int(c["curve_points"][curve, side])
        slopes = c["curve_slope"][curve, side, 1:points]
        knots[first : first + points - 1, 2 * side, k] = c["curve_x"][curve, side, : points - 1]
        knots[first : first + points - 1, 2 * side + 1, k] = np.diff(slopes, prepend=0.0)
    return int(c["curve_points"][curve].max()) - 1


def _seated(c: np.void) -> list[_Seat]:
    """The pairs in lanes, those with the most elements first, at the least cost of batches and slots."""
    pairs = []
    elements = sorted(range(int(c["elements"])), key=lambda e: (int(c["upper"][e]), int(c["lower"][e])))
    for (upper, lower), group in groupby(elements, lambda e: (int(c["upper"][e]), int(c["lower"][e]))):
        alike = list(group)
        # those with many curves side by side in the first slots
        pushing = sorted((e for e in alike if c["pushes"][e]), key=lambda e: -_curves(c, e))
        pairs.append(_Seat(upper, lower, pushing, [e for e in alike if c["turns"][e]]))
    deepest = max(len(pair.pushing) for pair in pairs)
    return min((_spread(pairs, depth) for depth in range(1, max(deepest, 1) + 1)), key=_cost)


def _curves(c: np.void, e: int) -> int:
    return int(np.count_nonzero(c["stop"][e] >= 0) + np.count_nonzero(c["damper"][e] >= 0))


def _spread(pairs: list[_Seat], depth: int) -> list[_Seat]:
    """The pairs with at most `depth` elements in a lane."""
    seats = []
    for pair in pairs:
        lanes = max(1, -(-len(pair.pushing) // depth))
        for k in range(lanes):
            seats.append(_Seat(pair.upper, pair.lower, pair.pushing[k::lanes], pair.turning if k == 0 else []))
    return sorted(seats, key=lambda seat: -len(seat.pushing))


def _cost(seats: list[_Seat]) -> float:
    return sum(_BATCH_COST + len(seats[first].pushing) for first in range(0, len(seats), LANES))
