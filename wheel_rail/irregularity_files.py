"""Measured track irregularities from CSV or Parquet files.

Columns, in any order, of which the first must be there and one of the others: position_m, longitudinal_level_mm,
alignment_mm, cross_level_mm, gauge_mm (its deviation from nominal); others are not read. Signs as in
`wheel_rail.irregularity_spectra`. A quantity without a column is zero.
"""

from pathlib import Path

import numpy as np

from wheel_rail.irregularity_spectra import QUANTITIES

COLUMNS = ("position_m", *(f"{quantity}_mm" for quantity in QUANTITIES))
WIDEST_SPACING_M = 1.0
CLOSEST_SPACING_M = 0.05
MOST_UNEQUAL = 0.01  # share of the spacing that a step between values may differ from it
LARGEST_MM = 100.0


def read_measured(name: str, key: str) -> tuple[np.ndarray, np.ndarray]:
    """Places (n,) in m and the four quantities (n, 4) in m of a file; `key` begins the messages.

    Raises ValueError, with the place in the file, if it cannot be read, a column is missing, a value is none or
    implausible, or places do not rise in equal steps of 0.05 to 1 m.
    """
    path = Path(name)
    try:
        columns = _parquet(path) if path.suffix == ".parquet" else _csv(path)
    except (OSError, ValueError) as error:
        raise ValueError(f"{key}: cannot be read: {error}") from error
    given = [column for column in COLUMNS[1:] if column in columns]
    if "position_m" not in columns or not given:
        raise ValueError(
            f"{key}: must have the column position_m and at least one of {', '.join(COLUMNS[1:])}; it has "
            f"{', '.join(columns) or 'none'}"
        )
    position_m = columns["position_m"]
    if len(position_m) < 10:
        raise ValueError(f"{key}: {len(position_m)} rows, at least 10 are needed")
    for column in ("position_m", *given):
        bad = np.flatnonzero(~np.isfinite(columns[column]))
        if bad.size:
            raise ValueError(f"{key}: row {bad[0] + 1}: {column} is not a finite number (gaps must be filled before)")
        bad = np.flatnonzero(np.abs(columns[column]) > LARGEST_MM) if column != "position_m" else bad
        if bad.size:
            value = columns[column][bad[0]]
            raise ValueError(f"{key}: row {bad[0] + 1}: {column} = {value:g}: at most {LARGEST_MM:g} (in mm?)")
    _check_spacing(position_m, key)
    values = np.zeros((len(position_m), len(QUANTITIES)))
    for column in given:
        values[:, COLUMNS.index(column) - 1] = 1e-3 * columns[column]
    return position_m, values


def _check_spacing(position_m: np.ndarray, key: str) -> None:
    steps = np.diff(position_m)
    falling = np.flatnonzero(steps <= 0.0)
    if falling.size:
        k = falling[0]
        raise ValueError(f"{key}: row {k + 2}: position_m = {position_m[k + 1]:g} comes after {position_m[k]:g}")
    usual = float(np.median(steps))
    if not CLOSEST_SPACING_M <= usual <= WIDEST_SPACING_M:
        raise ValueError(
            f"{key}: values every {usual:g} m; {CLOSEST_SPACING_M:g} to {WIDEST_SPACING_M:g} m are needed (in km?)"
        )
    unequal = np.flatnonzero(np.abs(steps - usual) > MOST_UNEQUAL * usual)
    if unequal.size:
        k = unequal[0]
        what = "a gap" if steps[k] > 1.5 * usual else "an unequal step"
        raise ValueError(
            f"{key}: row {k + 2}: {what} of {steps[k]:g} m after position_m = {position_m[k]:g}, where the others are "
            f"{usual:g} m"
        )


def _csv(path: Path) -> dict[str, np.ndarray]:
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    names = [name.strip() for name in lines[0].split(",")] if lines else []
    if len(set(names)) < len(names):
        raise ValueError(f"a column stands there twice: {', '.join(names)}")
    wanted = [k for k, name in enumerate(names) if name in COLUMNS]
    if not wanted:
        return {name: np.zeros(0) for name in names}
    table = np.loadtxt(lines[1:], delimiter=",", usecols=wanted, ndmin=2, converters=_number)
    return {names[k]: table[:, j].copy() for j, k in enumerate(wanted)}


def _number(cell: str) -> float:
    """An empty cell is a gap, told by its place later."""
    return float(cell) if cell.strip() else np.nan


def _parquet(path: Path) -> dict[str, np.ndarray]:
    from pyarrow import parquet  # slow to import, and rarely needed

    table = parquet.read_table(path)
    return {
        name: table[name].to_numpy(zero_copy_only=False).astype(float) for name in table.column_names if name in COLUMNS
    }
