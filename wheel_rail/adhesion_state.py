"""What the rail keeps: energy of friction and sand, in cells of 0.1 m along either rail."""

from collections.abc import Mapping
from typing import NamedTuple, Self

import numpy as np

from wheel_rail.compiled import Array, Record, address_of, array_at, compiled, inlined

STATE_CELL_M = 0.1
ENERGY_KEPT, SAND_KEPT = range(2)
_COLUMNS = ("energy_left_jpm", "energy_right_jpm", "sand_left_gpm", "sand_right_gpm")


class RailTables(NamedTuple):
    """Everything that compiled code reads (and, in `state`, writes) of the rail; one argument that holds arrays.

    `places` (2, n, 2): mu0 of the degraded curve at s = k * cell_m, linear in between, and the row of `curves` that
    holds there; `curves` (m, CURVE): see `adhesion_curves`; `state` (2, n, 2): J/m and g/m in cells of `state_cell_m`;
    `sand_left_share`: of the sand in a cell, what a passing wheel leaves; `memory_distance_m`: 0 without a memory.
    """

    cell_m: float
    places: Array
    curves: Array
    state_cell_m: float
    state: Array
    sand_left_share: float
    memory_distance_m: float
    memory_lowest_slip_mps: float


# where the arrays of RailTables stand, for a compiled function that is called with addresses
RAIL = np.dtype(
    [
        ("places_at", "i8"),
        ("places", "i8"),
        ("curves_at", "i8"),
        ("kinds", "i8"),
        ("curve", "i8"),
        ("state_at", "i8"),
        ("cells", "i8"),
        ("cell_m", "f8"),
        ("state_cell_m", "f8"),
        ("sand_left_share", "f8"),
        ("memory_distance_m", "f8"),
        ("memory_lowest_slip_mps", "f8"),
    ]
)


def rail_record(rail: RailTables) -> np.ndarray:
    """Record of dtype `RAIL`, shape (); whoever holds it keeps the arrays of `rail` alive."""
    record = np.zeros((), RAIL)
    record["places_at"], record["places"] = address_of(rail.places), rail.places.shape[1]
    record["curves_at"], (record["kinds"], record["curve"]) = address_of(rail.curves), rail.curves.shape
    record["state_at"], record["cells"] = address_of(rail.state), rail.state.shape[1]
    for name in ("cell_m", "state_cell_m", "sand_left_share", "memory_distance_m", "memory_lowest_slip_mps"):
        record[name] = getattr(rail, name)
    return record


@compiled
def rail_of(record: Record) -> RailTables:
    """The tables that `record` (RAIL) points to."""
    return RailTables(
        record.cell_m,
        array_at(record.places_at, (2, record.places, 2)),
        array_at(record.curves_at, (record.kinds, record.curve)),
        record.state_cell_m,
        array_at(record.state_at, (2, record.cells, 2)),
        record.sand_left_share,
        record.memory_distance_m,
        record.memory_lowest_slip_mps,
    )


class RailState:
    """Energy (J/m) and sand (g/m) on both rails of a line of `length_m`, as trains have left them; zero when made.

    `table` (2, n, 2): left and right rail; energy, sand. Cell k reaches from k * 0.1 m to the next.
    """

    def __init__(self, length_m: float) -> None:
        self.length_m = length_m
        self.table = np.zeros((2, _cells(length_m), 2))

    @property
    def energy_jpm(self) -> np.ndarray:
        """Energy of left and right rail, (2, n)."""
        return self.table[:, :, ENERGY_KEPT]

    @property
    def sand_gpm(self) -> np.ndarray:
        """Sand on left and right rail, (2, n)."""
        return self.table[:, :, SAND_KEPT]

    def as_arrays(self) -> dict[str, np.ndarray]:
        """Columns to be saved, (n,) each: `position_m` (begin of the cell), energy and sand of either rail."""
        values = (*self.energy_jpm, *self.sand_gpm)
        position_m = np.arange(self.table.shape[1]) * STATE_CELL_M
        return {"position_m": position_m, **{n: v.copy() for n, v in zip(_COLUMNS, values, strict=True)}}

    @classmethod
    def from_arrays(cls, length_m: float, arrays: Mapping[str, np.ndarray]) -> Self:
        """The state that `as_arrays` gave, for a line of `length_m`.

        Raises ValueError unless all columns are there, of this line's cells, finite and not negative.
        """
        state = cls(length_m)
        n = state.table.shape[1]
        for name in ("position_m", *_COLUMNS):
            if name not in arrays:
                raise ValueError(f"{name}: the column is missing; a rail state has position_m, {', '.join(_COLUMNS)}")
            kind = np.asarray(arrays[name]).dtype
            if kind.kind not in "fiu":
                raise ValueError(f"{name}: must hold numbers, here {kind}")
        position_m = np.asarray(arrays["position_m"], dtype=float)
        if position_m.ndim != 1 or len(position_m) < 2 or not np.all(np.isfinite(position_m)):
            raise ValueError("position_m: must be a row of at least two finite positions")
        spacing_m = float(position_m[1] - position_m[0])
        if abs(spacing_m - STATE_CELL_M) > 1e-6 or not np.allclose(np.diff(position_m), STATE_CELL_M, atol=1e-6):
            raise ValueError(f"position_m: cells must be {STATE_CELL_M} m long, here the first is {spacing_m:.6g} m")
        if len(position_m) != n or abs(position_m[0]) > 1e-6:
            raise ValueError(
                f"position_m reaches from {position_m[0]:.6g} m over {len(position_m)} cells: the state of another "
                f"line; this one is {length_m:g} m long and has {n} cells from 0"
            )
        for k, name in enumerate(_COLUMNS):
            values = np.asarray(arrays[name], dtype=float)
            if values.shape != (n,):
                raise ValueError(f"{name}: must have {n} values like position_m, here {values.shape}")
            bad = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
            if len(bad):
                raise ValueError(
                    f"{name} = {values[bad[0]]:g} at {position_m[bad[0]]:.1f} m: must be finite and not negative"
                )
            state.table[k % 2, :, k // 2] = values
        return state


def _cells(length_m: float) -> int:
    # two more than the line needs, since wheels look ahead
    return int(np.ceil(length_m / STATE_CELL_M - 1e-9)) + 2


@inlined
def spread(rail: RailTables, kept: int, s0_m: float, s1_m: float, left: float, right: float) -> None:
    """Add amounts to `state[:, :, kept]` of the left and the right rail, evenly over the way from s0 to s1, either
    direction.

    The sum of value x cell grows by the amount, whatever the way: at standstill all goes into the cell at s0, and what
    would fall beyond an end of the line into the last cell there. Amounts that are not positive are ignored.
    """
    left, right = left if left > 0.0 else 0.0, right if right > 0.0 else 0.0
    if left + right == 0.0:
        return
    state = rail.state
    cell = rail.state_cell_m
    n = state.shape[1]
    low = min(max(min(s0_m, s1_m) / cell, 0.0), float(n))
    high = min(max(max(s0_m, s1_m) / cell, 0.0), float(n))
    first, last = min(int(low), n - 1), min(int(high), n - 1)
    for side in range(2):
        amount = left if side == 0 else right
        if first == last:
            state[side, first, kept] += amount / cell
            continue
        per_cell = amount / (high - low) / cell
        state[side, first, kept] += (first + 1.0 - low) * per_cell
        for k in range(first + 1, last):
            state[side, k, kept] += per_cell
        state[side, last, kept] += (high - last) * per_cell


@inlined
def deposit(rail: RailTables, s0_m: float, s1_m: float, left_j: float, right_j: float) -> None:
    """What the wheels of a wheelset dissipated on its way from s0 to s1 stays on their rails."""
    spread(rail, ENERGY_KEPT, s0_m, s1_m, left_j, right_j)


@compiled
def crush_sand(rail: RailTables, side: int, s0_m: float, s1_m: float) -> None:
    """A wheel that passes from s0 to s1 leaves `sand_left_share` of the sand in each cell that it has left."""
    state = rail.state
    n = state.shape[1]
    here = min(max(int(max(s0_m, 0.0) / rail.state_cell_m), 0), n - 1)
    there = min(max(int(max(s1_m, 0.0) / rail.state_cell_m), 0), n - 1)
    while here != there:
        state[side, here, SAND_KEPT] *= rail.sand_left_share
        here += 1 if there > here else -1
