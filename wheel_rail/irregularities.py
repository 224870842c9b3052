"""Irregularities of the rails: drawn from a spectrum or measured, as offsets of each rail that wheels run over.

Between its nodes the table is read as cubic splines, so that slopes and curvatures of the rails have no jumps: on a
contact as stiff as 1e8 N/m a kink would be a blow.
"""

import math
from typing import Self

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import oaconvolve

from wheel_rail.compiled import Array, compiled, inlined
from wheel_rail.irregularity_files import read_measured
from wheel_rail.irregularity_parameters import IrregularityParameters
from wheel_rail.irregularity_spectra import QUANTITIES, SPECTRA, Spectrum
from wheel_rail.lane_arrays import lanes_at, put_lanes
from wheel_rail.lane_functions import over_root
from wheel_rail.lanes import Lanes
from wheel_rail.splines import between_nodes, hermite

Three = tuple[Lanes, Lanes, Lanes]
Frame = tuple[Three, Three, Three, Lanes, Lanes]
"""Tangent, left, up, roll slope (rad/m), curvature (rad/m)."""

# columns of the table: lateral offset (to the left) of the left and of the right rail, vertical ones (up); their slopes
ASIDE, UP, SLOPES, OFFSETS = 0, 2, 4, 8  # how many in all
_EDGE = 1.25  # over this ratio of wavelengths the amplitude falls to nothing at either end of the band
_KERNEL_WAVES = 32  # length of the filter in longest wavelengths
_SMOOTHEST_FADE = np.polynomial.Polynomial([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])  # no jump of slope or curvature


class Irregularities:
    """Values of the four quantities at nodes of equal spacing, and the rails' offsets made of them.

    `values_m` (n, 4): longitudinal level, alignment, cross level, gauge (see `irregularity_spectra`); `table` (n, 8):
    offsets in m and their slopes, to be read by the compiled `rail_offsets`; nothing beyond its ends.
    """

    def __init__(self, first_m: float, cell_m: float, values_m: np.ndarray) -> None:
        self.first_m = first_m
        self.cell_m = cell_m
        self.values_m = values_m
        level, alignment, cross, gauge = values_m.T
        offsets = np.stack(
            [alignment + 0.5 * gauge, alignment - 0.5 * gauge, level - 0.5 * cross, level + 0.5 * cross], axis=1
        )
        slopes = CubicSpline(cell_m * np.arange(len(offsets)), offsets, bc_type="clamped").derivative()
        self.table = np.concatenate([offsets, slopes(cell_m * np.arange(len(offsets)))], axis=1)

    @property
    def position_m(self) -> np.ndarray:
        """Places of the nodes along the track."""
        return self.first_m + self.cell_m * np.arange(len(self.values_m))

    @classmethod
    def of(cls, parameters: IrregularityParameters, length_m: float, rng: np.random.Generator | None) -> Self:
        """Those of a line of that length.

        Raises ValueError, with the key, if the file does not fit or there is no random stream to draw from.
        """
        begin_m, end_m = parameters.span_m(length_m)
        if parameters.file is not None:
            key = f"irregularities.file = {parameters.file}"
            position_m, values_m = read_measured(parameters.file, key)
            cell_m = float((position_m[-1] - position_m[0]) / (len(position_m) - 1))
            if position_m[0] > begin_m + cell_m or position_m[-1] < end_m - cell_m:
                raise ValueError(
                    f"{key}: measured from {position_m[0]:g} to {position_m[-1]:g} m, asked for from "
                    f"from_m = {begin_m:g} to to_m = {end_m:g}"
                )
            first_m = float(position_m[0])
        elif rng is not None and parameters.spectrum is not None:
            first_m, cell_m = 0.0, parameters.cell_m
            values_m = drawn(SPECTRA[parameters.spectrum], parameters, length_m, rng)
        else:
            raise ValueError("irregularities.spectrum: is drawn at random; a random stream is needed")
        places = first_m + cell_m * np.arange(len(values_m))
        # down to nothing at the outermost nodes in any case, beyond which the rails are smooth
        begin_m, end_m = max(begin_m, first_m), min(end_m, float(places[-1]))
        inside = np.clip(np.minimum(places - begin_m, end_m - places) / parameters.fade_m, 0.0, 1.0)
        return cls(first_m, cell_m, parameters.scale * _SMOOTHEST_FADE(inside)[:, None] * values_m)


def drawn(
    spectrum: Spectrum, parameters: IrregularityParameters, length_m: float, rng: np.random.Generator
) -> np.ndarray:
    """The four quantities (n, 4) in m at nodes from 0 to `length_m`, `parameters.cell_m` apart.

    White noise, drawn from place to place, through a filter whose gain is the root of the spectrum. A longer line has
    the same rails as far as a shorter one goes (to rounding).
    """
    cell_m = parameters.cell_m
    count = math.ceil(length_m / cell_m) + 1
    taps = 2 * round(0.5 * _KERNEL_WAVES * parameters.longest_wavelength_m / cell_m)
    frequency = np.fft.rfftfreq(taps, cell_m)
    gain = _band(frequency, 1.0 / parameters.longest_wavelength_m, 1.0 / parameters.shortest_wavelength_m)
    white = rng.standard_normal((count + taps, len(QUANTITIES)))
    values = np.empty((count, len(QUANTITIES)))
    for k, quantity in enumerate(QUANTITIES):
        density = np.zeros_like(frequency)
        density[1:] = spectrum.per_cycle(quantity, frequency[1:])
        # white noise of unit variance has the one-sided density 2 cell_m
        kernel = np.fft.fftshift(np.fft.irfft(gain * np.sqrt(density / (2.0 * cell_m)), taps))
        values[:, k] = oaconvolve(white[:, k], kernel, mode="valid")[:count]
    return values


def _band(frequency: np.ndarray, low: float, high: float) -> np.ndarray:
    """Gain 1 from `low` to `high`, falling as half a cosine of the logarithm to 0 a factor `_EDGE` further."""
    with np.errstate(divide="ignore"):
        beyond = np.maximum(np.log(low / frequency), np.log(frequency / high)) / math.log(_EDGE)
    return 0.5 + 0.5 * np.cos(np.pi * np.clip(beyond, 0.0, 1.0))


@compiled
def rail_offsets(s_m: float, first_m: float, cell_m: float, table: Array, offsets: Array) -> None:
    """Write the offsets at s into `offsets` (8,), in the order of the table's columns; zero beyond the table."""
    u = (s_m - first_m) / cell_m
    if u < 0.0 or u >= table.shape[0] - 1:
        for j in range(8):
            offsets[j] = 0.0
        return
    k = int(u)
    at = OFFSETS * k
    both = between_nodes(lanes_at(table, at), lanes_at(table, at + OFFSETS), hermite(u - k, cell_m))
    put_lanes(offsets, 0, both)


@inlined
def displaced_frame(place: Three, track: Frame, offset: tuple[Lanes, Lanes, Lanes, Lanes]) -> tuple[Three, Frame]:
    """The track frame displaced and turned as a rail has it: its origin and its frame; for floats and lanes.

    `place`: that of a wheel from the track frame's origin, up to a millimetre before or behind it: the rail's origin is
    brought abreast of it, for on a slope of the rail that is a height. `track`: tangent, left, up, roll slope and
    curvature. `offset`: the rail's to the left and up at the wheel, and their slopes. In a cant ramp the rail turns
    with the track plane about the centreline, in a curve with the tangent on the way there.
    """
    (x, y, z), ((tx, ty, tz), (nx, ny, nz), (bx, by, bz), twist, curvature) = place, track
    aside, up, aside_slope, up_slope = offset
    ahead = x * tx + y * ty + z * tz
    # the derivative of position + aside left + up up, where the plane's left is turned by its roll from the level
    heading = curvature * ahead
    turn = aside_slope - twist * up + heading * bz
    climb = up_slope + twist * aside - heading * nz
    scale = over_root(turn * turn + climb * climb)
    across = over_root(turn * turn)
    origin = (
        ahead * tx + aside * nx + up * bx, ahead * ty + aside * ny + up * by, ahead * tz + aside * nz + up * bz
    )  # fmt: skip
    cx, cy, cz = (
        (tx + turn * nx + climb * bx) * scale, (ty + turn * ny + climb * by) * scale,
        (tz + turn * nz + climb * bz) * scale,
    )  # fmt: skip
    lx, ly, lz = (nx - turn * tx) * across, (ny - turn * ty) * across, (nz - turn * tz) * across
    above = (cy * lz - cz * ly, cz * lx - cx * lz, cx * ly - cy * lx)
    return origin, ((cx, cy, cz), (lx, ly, lz), above, twist, curvature)
