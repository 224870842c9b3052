"""Peak adhesion that varies along the rail: random fields, and fields read from a file."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

_HEADER = ("position_m", "left", "right")


def random_field(n: int, cell_m: float, correlation_length_m: float, rng: np.random.Generator) -> np.ndarray:
    """Gaussian random field, mean 0 and variance 1, with correlation exp(-(x/L)^2/2); one value per cell, (n,)."""
    reach = int(np.ceil(4.0 * correlation_length_m / cell_m))
    # a Gaussian kernel of width L/sqrt 2 on white noise gives a Gaussian correlation of length L
    kernel = np.exp(-((np.arange(-reach, reach + 1) * cell_m / correlation_length_m) ** 2))
    kernel /= np.sqrt(np.sum(kernel**2))
    white = rng.standard_normal(n + 2 * reach)
    size = 1 << int(np.ceil(np.log2(white.size + kernel.size)))
    return np.fft.irfft(np.fft.rfft(white, size) * np.fft.rfft(kernel, size), size)[2 * reach : 2 * reach + n]


def random_fields_of_rails(
    n: int, cell_m: float, correlation_length_m: float, rails_correlation: float, rng: np.random.Generator
) -> np.ndarray:
    """Fields of the left and the right rail, (2, n), evenly spread over -1..1; correlation as stated before bounding.

    The left rail's field does not depend on the correlation of the rails.
    """
    from scipy.special import erf

    left = random_field(n, cell_m, correlation_length_m, rng)
    right = left
    if rails_correlation < 1.0:
        own = random_field(n, cell_m, correlation_length_m, rng)
        right = rails_correlation * left + math.sqrt(1.0 - rails_correlation**2) * own
    # the normal distribution's own integral bounds the field and spreads it evenly over its range
    return np.asarray(erf(np.stack([left, right]) / np.sqrt(2.0)))


@dataclass(frozen=True)
class PeakField:
    """Peak adhesion of both rails at given places: `position_m` (m,), `peak` (2, m); linear in between."""

    position_m: np.ndarray
    peak: np.ndarray

    def at(self, s_m: np.ndarray) -> np.ndarray:
        """Peak adhesion of left and right rail at `s_m` (n,), (2, n). Raises ValueError where the field has a gap."""
        first, last = float(self.position_m[0]), float(self.position_m[-1])
        if s_m[0] < first or s_m[-1] > last:
            hint = ""
            if s_m[0] / 1000.0 >= first and s_m[-1] / 1000.0 <= last < 0.01 * s_m[-1]:
                hint = "; this looks like kilometres, positions are in metres"
            raise ValueError(
                f"position_m reaches from {first:g} to {last:g}, but must cover {s_m[0]:g} to {s_m[-1]:g}{hint}"
            )
        return np.stack([np.interp(s_m, self.position_m, values) for values in self.peak])


def read_peak_field(path: str | Path) -> PeakField:
    """Read a CSV file with the header `position_m,left,right`.

    Raises ValueError, with the line, unless there are at least two rows of finite numbers, positions that grow from row
    to row, and peak adhesions above 0 and up to 1.
    """
    rows: list[list[float]] = []
    try:
        with Path(path).open(newline="", encoding="utf-8-sig") as file:
            lines = csv.reader(file)
            header = tuple(name.strip() for name in next(lines, []))
            if header != _HEADER:
                raise ValueError(
                    f"line 1: the header must be {','.join(_HEADER)}, here {','.join(header) or 'nothing'}"
                )
            for line in lines:
                if line:
                    rows.append(_row(line, lines.line_num, rows[-1][0] if rows else -math.inf))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"cannot be read as a CSV file: {error}") from None
    if len(rows) < 2:
        raise ValueError(f"must have at least two rows below the header, here {len(rows)}")
    values = np.array(rows)
    return PeakField(values[:, 0], np.ascontiguousarray(values[:, 1:].T))


def _row(line: list[str], number: int, before_m: float) -> list[float]:
    if len(line) != len(_HEADER):
        raise ValueError(f"line {number}: must have {len(_HEADER)} values, here {len(line)}")
    row = []
    for name, text in zip(_HEADER, line, strict=True):
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise ValueError(f"line {number}: {name} = {text.strip() or 'nothing'}: must be a finite number")
        row.append(value)
    if row[0] <= before_m:
        raise ValueError(f"line {number}: position_m = {row[0]:g}: must lie beyond the row before ({before_m:g})")
    for name, value in zip(_HEADER[1:], row[1:], strict=True):
        if not 0.0 < value <= 1.0:
            hint = ", this looks like per cent" if 1.0 < value <= 100.0 else ""
            raise ValueError(
                f"line {number}: {name} = {value:g}: peak adhesion is a share of the load, above 0 and up to 1{hint}"
            )
    return row
