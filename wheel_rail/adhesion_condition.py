"""What a wheel meets: the rail's condition at its place, from the tables of the line and what the rail has kept."""

import math

from wheel_rail.adhesion_curves import (
    FIRST_SPEED_MPS,
    KMH_PER_MPS,
    RATIO,
    SAND_SCALE,
    SANDED,
    SPEED_CORRECTION,
    SPEED_LAW,
    SPEEDS,
    curtius_kniffler,
)
from wheel_rail.adhesion_state import ENERGY_KEPT, SAND_KEPT, RailTables
from wheel_rail.compiled import Array, compiled, inlined
from wheel_rail.recovery import CONDITION, DEGRADED, ENERGY, MU0, RECOVERED, SAND, TAU

NO_KIND = -1.0
"""In place of a row of `RailTables.curves`: other curves."""

_BACKWARD_MPS = -0.05  # faster backwards than this, a wheel meets what lies behind it


@compiled
def _speed_factor(curves: Array, row: int, speed_mps: float) -> float:
    """mu0 at this speed over mu0 at 100 km/h, that peak adhesion may follow Curtius and Kniffler."""
    v = abs(speed_mps)
    u = min(math.sqrt(v / FIRST_SPEED_MPS), SPEEDS - 1.001)
    k = int(u)
    low, high = curves[row, SPEED_CORRECTION + k], curves[row, SPEED_CORRECTION + k + 1]
    return (low + (u - k) * (high - low)) * curtius_kniffler(KMH_PER_MPS * v)


@compiled
def _sanded(mu0: float, sanded: float, share: float) -> float:
    """Friction on sand: moves from mu0 towards that of plenty of sand, and never down."""
    return mu0 + share * (sanded - mu0) if sanded > mu0 else mu0


@compiled
def _treated(
    degraded: float, recovered: float, curves: Array, row: int, speed_mps: float, sand_gpm: float
) -> tuple[float, float]:
    """mu0 of the degraded and of the recovered curve, after the speed law and the sand."""
    if curves[row, SPEED_LAW] > 0.0:
        factor = _speed_factor(curves, row, speed_mps)
        degraded *= factor
        recovered *= factor
    if sand_gpm > 0.0:
        share = 1.0 - math.exp(-sand_gpm / curves[row, SAND_SCALE])
        degraded = _sanded(degraded, curves[row, SANDED], share)
        recovered = _sanded(recovered, curves[row, SANDED + 1], share)
    return degraded, recovered


@inlined
def _places(s_m: float, speed_mps: float, rail: RailTables) -> tuple[int, float, int, float]:
    """Cell of the rail's state ahead of a wheel at `s_m` and how far on to the next; the same of the line's places."""
    w = max(s_m / rail.state_cell_m, 0.0)
    m = int(w)
    w -= m
    m += -2 if speed_mps < _BACKWARD_MPS else 1
    m = min(max(m, 0), rail.state.shape[1] - 2)
    u = max(s_m / rail.cell_m, 0.0)
    k = int(u)
    last = rail.places.shape[1] - 2
    if k > last:
        k = last
        u = last + 1.0
    return m, w, k, u - k


@inlined
def _kept(place: tuple[int, float, int, float], side: int, rail: RailTables) -> tuple[float, float]:
    """Energy and sand that the rail has kept, at what `_places` has found."""
    m, w, _, _ = place
    state = rail.state
    energy = state[side, m, ENERGY_KEPT] + w * (state[side, m + 1, ENERGY_KEPT] - state[side, m, ENERGY_KEPT])
    return energy, state[side, m, SAND_KEPT] + w * (state[side, m + 1, SAND_KEPT] - state[side, m, SAND_KEPT])


@inlined
def _fill(
    place: tuple[int, float, int, float], side: int, speed_mps: float, kept: tuple[float, float], rail: RailTables,
    wheel: int, conditions: Array, kind: float,
) -> float:  # fmt: skip
    """`rail_condition` at what `_places` has found, into a column of `conditions`; what kind of rail stands there now.

    Where that was `kind`, its curves stand there already. Taken into its callers: handing over tables costs as much.
    """
    (_, _, k, u), (energy, sand) = place, kept
    places, curves = rail.places, rail.curves
    mu0 = places[side, k, 0] + u * (places[side, k + 1, 0] - places[side, k, 0])
    here, there = int(places[side, k, 1]), int(places[side, k + 1, 1])
    if kind != here:
        for j in range(TAU + 1):
            conditions[j, wheel] = curves[here, j]
    kind = here
    degraded, recovered = mu0, curves[here, RECOVERED + MU0] + curves[here, RATIO] * mu0
    # asked here, since a call with an array costs more than all the rest
    if sand > 0.0 or curves[here, SPEED_LAW] > 0.0:
        degraded, recovered = _treated(degraded, recovered, curves, here, speed_mps, sand)
    if there != here:
        for j in range(TAU + 1):
            conditions[j, wheel] += u * (curves[there, j] - conditions[j, wheel])
        kind = NO_KIND
        recovered_there = curves[there, RECOVERED + MU0] + curves[there, RATIO] * mu0
        degraded_there, recovered_there = _treated(mu0, recovered_there, curves, there, speed_mps, sand)
        degraded += u * (degraded_there - degraded)
        recovered += u * (recovered_there - recovered)
    conditions[DEGRADED + MU0, wheel] = degraded
    conditions[RECOVERED + MU0, wheel] = recovered
    conditions[ENERGY, wheel] = energy
    conditions[SAND, wheel] = sand
    return kind


@compiled
def rail_condition(s_m: float, side: int, speed_mps: float, rail: RailTables, condition: Array) -> None:
    """Fill `condition` (CONDITION,) for a wheel at `s_m` on rail `side` (0 left, 1 right) at `speed_mps` (signed).

    Where two kinds of rail meet, they blend over one cell. Energy and sand are those of the rail ahead, which this
    wheel has not touched: linear between the centres of the next cell and of the one behind it, so that the wheel does
    not meet its own work, which its force accounts for already.
    """
    place = _places(s_m, speed_mps, rail)
    _fill(place, side, speed_mps, _kept(place, side, rail), rail, 0, condition.reshape((CONDITION, 1)), NO_KIND)


@inlined
def rail_conditions(
    wheelset: int, s_m: float, speed_mps: float, rail: RailTables, conditions: Array, kinds: Array
) -> None:
    """`rail_condition` for the left and the right wheel of a wheelset, into its columns of `conditions` (CONDITION,
    LANES).

    `kinds` (LANES,): whose curves stand in each column, from call to call: rows of `rail.curves`, or NO_KIND.
    """
    place = _places(s_m, speed_mps, rail)
    for side in range(2):
        w = 2 * wheelset + side
        kinds[w] = _fill(place, side, speed_mps, _kept(place, side, rail), rail, w, conditions, kinds[w])


@compiled
def past_conditions(
    s_m: Array, speed_mps: Array, energy_jpm: Array, sand_gpm: Array, rail: RailTables, conditions: Array, kinds: Array
) -> None:
    """`rail_conditions` for four wheelsets (4,) at a time when the rails had kept what `energy_jpm` and `sand_gpm`
    (LANES,) say."""
    for i in range(4):
        place = _places(s_m[i], speed_mps[i], rail)
        for side in range(2):
            w = 2 * i + side
            kept = energy_jpm[w], sand_gpm[w]
            kinds[w] = _fill(place, side, speed_mps[i], kept, rail, w, conditions, kinds[w])
