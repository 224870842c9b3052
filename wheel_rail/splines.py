"""Tables read in between their nodes: cubics that belong to the values and slopes at both ends of a cell."""

from wheel_rail.compiled import inlined
from wheel_rail.lanes import Lanes, joined, swapped

Weights = tuple[float, float, float]


@inlined
def hermite(u: float, cell_m: float) -> tuple[Weights, Weights]:
    """Weights of the change between two nodes and of the slopes at both, for the value at share u of the way; those of
    the slope there."""
    u2 = u * u
    return (
        (u2 * (3.0 - 2.0 * u), u * (1.0 - u) * (1.0 - u) * cell_m, u2 * (u - 1.0) * cell_m),
        (6.0 * u * (1.0 - u) / cell_m, 1.0 - 4.0 * u + 3.0 * u2, 3.0 * u2 - 2.0 * u),
    )


@inlined
def between_nodes(here: Lanes, there: Lanes, weights: tuple[Weights, Weights]) -> Lanes:
    """Four values in between two nodes, then their slopes, as each of the nodes has them.

    `weights`: what `hermite` gives.
    """
    (change, here_slope, there_slope), (change_1, here_1, there_1) = weights
    rise, slope, slope_there = there - here, swapped(here), swapped(there)
    return joined(
        here + change * rise + here_slope * slope + there_slope * slope_there,
        change_1 * rise + here_1 * slope + there_1 * slope_there,
    )
