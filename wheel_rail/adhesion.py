"""Adhesion along the rail: which friction holds at which place.

A rail is a row of stretches, with patches laid over them; each has a kind (the shape of its friction curve, or two
curves where cleaning restores it) and a peak adhesion that is constant, varies as a random field, or is read from a
file. The kinds and the levels along the line are tabulated once; what the rail keeps of each train is in `RailState`.
"""

import numpy as np

from wheel_rail.adhesion_curves import REFERENCE_LOAD_N, REFERENCE_SPEED_MPS, PeakSearch, RailKind, rail_kind
from wheel_rail.adhesion_fields import random_fields_of_rails, read_peak_field
from wheel_rail.adhesion_parameters import AdhesionParameters, AdhesionStretch, RailSurface
from wheel_rail.adhesion_state import STATE_CELL_M, RailState, RailTables
from wheel_rail.contact_table import Contact
from wheel_rail.sanding import SandEffect

__all__ = ["CELL_M", "REFERENCE_LOAD_N", "REFERENCE_SPEED_MPS", "Adhesion", "AdhesionParameters"]

CELL_M = 0.5


class Adhesion:
    """Friction over both rails, tabulated in cells of 0.5 m.

    `places` (2, n, 2): mu0 of the degraded curve at s = k * 0.5 m on left and right rail, to be interpolated linearly,
    and the row of `curves` (kinds of rail) that holds there. `peak` (2, n): peak adhesion as found, at 68.7 kN and
    100 km/h.
    """

    def __init__(
        self,
        parameters: AdhesionParameters,
        length_m: float,
        contact: Contact,
        rng: np.random.Generator,
        sand: SandEffect | None = None,
    ) -> None:
        """`contact` gives the ellipse at 68.7 kN and the creep law whose peak counts.

        Raises ValueError, which names the key, for what does not fit the line: files that do not cover their stretch or
        are bad, peaks that a surface cannot give or that lie above its recovered curve. What lies beyond the end of
        the line does not count.
        """
        self.length_m = length_m
        self._parameters = parameters
        self._sand = SandEffect() if sand is None else sand
        self._search = PeakSearch(
            contact.law,
            contact.at_load(REFERENCE_LOAD_N).patch,
            contact.parameters.shear_modulus_pa,
        )
        n = int(np.ceil(length_m / CELL_M)) + 2
        self.s_m = np.arange(n) * CELL_M
        self.peak = np.empty((2, n))
        self.places = np.empty((2, n, 2))
        self._rows: list[np.ndarray] = []
        self._lay_stretches(rng)
        self._lay_patches()
        self.curves = np.array(self._rows)

    def tables(self, state: RailState) -> RailTables:
        """What compiled code reads, together with the `state` that it reads and writes."""
        if state.length_m != self.length_m:
            raise ValueError(f"the rail state belongs to a line of {state.length_m} m, this one has {self.length_m} m")
        memory = self._parameters.memory
        return RailTables(
            CELL_M,
            self.places,
            self.curves,
            STATE_CELL_M,
            state.table,
            self._sand.left_share,
            memory.distance_m if memory else 0.0,
            memory.lowest_slip_mps if memory else 0.0,
        )

    def _lay_stretches(self, rng: np.random.Generator) -> None:
        stretches = self._parameters.stretches
        starts = [stretch.from_m for stretch in stretches] + [np.inf]
        # a stream for each stretch, and the field drawn over the whole line: changing one stretch, or moving its
        # border, leaves the rest of the rail alone
        streams = rng.spawn(len(stretches))
        for k, stretch in enumerate(stretches):
            key = f"adhesion.stretches.{k}"
            kind = self._kind(stretch, key)
            inside = (self.s_m >= starts[k]) & (self.s_m < starts[k + 1])
            if np.any(inside):
                self._lay(key, kind, inside, (0, 1), self._peaks(stretch, kind, inside, key, streams[k]))

    def _lay_patches(self) -> None:
        for k, patches in enumerate(self._parameters.patches):
            key = f"adhesion.patches.{k}"
            kind = self._kind(patches, key)
            inside = np.zeros(len(self.s_m), dtype=bool)
            for start, end in patches.spans_m:
                inside |= (self.s_m >= start) & (self.s_m < end)
            if np.any(inside):
                peak = np.full((2, int(inside.sum())), kind.nominal_peak)
                self._lay(key, kind, inside, patches.sides, peak)

    def _kind(self, surface: RailSurface, key: str) -> RailKind:
        try:
            kind = rail_kind(surface, self._search, self._sand)
        except ValueError as error:
            raise ValueError(f"{key}.peak_adhesion = {surface.peak_adhesion}: {error}") from None
        self._rows.append(kind.row)
        return kind

    def _peaks(
        self, stretch: AdhesionStretch, kind: RailKind, inside: np.ndarray, key: str, rng: np.random.Generator
    ) -> np.ndarray:
        """Peak adhesion of both rails at the `inside` places, (2, m)."""
        if stretch.file is not None:
            s_m = self.s_m[inside]
            try:
                # the last cells of the table lie beyond the end of the line
                return read_peak_field(stretch.file).at(np.minimum(s_m, self.length_m))
            except ValueError as error:
                raise ValueError(f"{key}.file = {stretch.file}: {error}") from None
        if stretch.spread > 0.0:
            field = random_fields_of_rails(
                len(self.s_m), CELL_M, stretch.correlation_length_m, stretch.rails_correlation, rng
            )
            return kind.nominal_peak + stretch.spread * field[:, inside]
        return np.full((2, int(inside.sum())), kind.nominal_peak)

    def _lay(self, key: str, kind: RailKind, inside: np.ndarray, sides: tuple[int, ...], peak: np.ndarray) -> None:
        highest = float(np.max(peak))
        if kind.recovered_peak is not None and highest > kind.recovered_peak:
            raise ValueError(
                f"{key}.peak_adhesion: reaches {highest:.4g}, above the {kind.recovered_peak:.4g} to which its rail "
                'recovers; a higher recovered.mu0, or recovered_level = "relative", would do'
            )
        try:
            mu0 = self._search.mu0_of(peak, kind.surface)
        except ValueError as error:
            raise ValueError(f"{key}.peak_adhesion: reaches {highest:.4g}; {error}") from None
        for side in sides:
            self.peak[side, inside] = peak[side]
            self.places[side, inside, 0] = mu0[side]
            self.places[side, inside, 1] = len(self._rows) - 1
