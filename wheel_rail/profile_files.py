"""Measured or worn profiles from text files of two columns, y and z in mm.

y grows from the flange or gauge side outwards (files in the opposite order are read too), z is positive downwards.
Columns are separated by blanks, tabs, commas or semicolons; `#` and `%` start comments.
"""

import re
from pathlib import Path

import numpy as np

FEWEST_POINTS = 30
WIDEST_GAP_MM = 5.0  # between neighbouring points: wider, and the shape between them would be invented
# what the width of a profile may be in mm
WIDTH_MM = {"wheel": (70.0, 200.0), "rail": (40.0, 120.0)}
OTHER_UNITS = {"metres": 1000.0, "centimetres": 10.0, "inches": 25.4, "micrometres": 0.001}


class ProfileError(ValueError):
    """A profile file that cannot be used; the message names file, place and reason."""


def read_profile_points(path: Path, kind: str) -> np.ndarray:
    """Points (n, 2) in mm of a profile file, in order of growing y; `kind` is "wheel" or "rail".

    Raises ProfileError if the file is missing, not two columns of finite numbers, has fewer than 30 points or a gap
    above 5 mm, is not monotone in y, crosses itself, is upside down, mirrored, or in other units than mm.
    """
    points = _parsed(path)
    if len(points) < FEWEST_POINTS:
        raise ProfileError(f"{path}: {len(points)} points, at least {FEWEST_POINTS} are needed")
    _check_units(path, points, kind)
    steps = np.diff(points[:, 0])
    if np.sum(steps < 0.0) > np.sum(steps > 0.0):
        points, steps = points[::-1], -steps[::-1]
    if np.any(steps <= 0.0):
        crossing = _crossing(points) if np.any(steps < 0.0) else None
        if crossing is not None:
            y, z = crossing
            raise ProfileError(f"{path}: the profile crosses itself near y = {y:.3f} mm, z = {z:.3f} mm")
        k = int(np.argmax(steps <= 0.0))
        raise ProfileError(
            f"{path}: y is not monotone: {points[k + 1, 0]:g} comes after {points[k, 0]:g} mm; "
            "cut overhanging parts off and remove double points"
        )
    gaps = np.hypot(*np.diff(points, axis=0).T)
    k = int(np.argmax(gaps))
    if gaps[k] > WIDEST_GAP_MM:
        raise ProfileError(
            f"{path}: {gaps[k]:.2f} mm between the points at y = {points[k, 0]:g} and {points[k + 1, 0]:g} mm, "
            f"at most {WIDEST_GAP_MM:g} mm"
        )
    _check_way_up(path, points, kind)
    return points


def _parsed(path: Path) -> np.ndarray:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:  # ValueError: not UTF-8, or a null character in the path
        raise ProfileError(f"{path}: cannot be read as a profile: {error}") from error
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = re.split(r"[\s,;]+", re.split("[#%]", line)[0].strip())
        if words == [""]:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            row = []
        if len(row) != 2 or not np.all(np.isfinite(row)):
            raise ProfileError(
                f"{path}, line {number}: {line.strip()!r}: two finite numbers, y and z in mm, are needed"
            )
        rows.append(row)
    return np.array(rows, dtype=float).reshape(-1, 2)


def _check_units(path: Path, points: np.ndarray, kind: str) -> None:
    narrowest, widest = WIDTH_MM[kind]
    width = float(np.ptp(points[:, 0]))
    if narrowest <= width <= widest:
        return
    guess = [unit for unit, mm in OTHER_UNITS.items() if narrowest <= width * mm <= widest]
    hint = f"; in {guess[0]}? y and z must be in mm" if guess else ""
    raise ProfileError(
        f"{path}: the profile is {width:g} mm wide, a {kind} profile has {narrowest:g}..{widest:g} mm{hint}"
    )


def _check_way_up(path: Path, points: np.ndarray, kind: str) -> None:
    """A wheel's lowest point is its flange tip at negative y; a rail is highest in the middle."""
    y, z = points.T
    if kind == "wheel":
        flange = int(np.argmax(np.abs(z - np.median(z))))
        if z[flange] < np.median(z):
            raise ProfileError(f"{path}: the wheel profile is upside down: z must be positive towards the flange tip")
        if y[flange] > -20.0:
            raise ProfileError(
                f"{path}: the flange lies at y = {y[flange]:g} mm: y must count from the tape circle and be negative "
                "at the flange (is the profile mirrored?)"
            )
        return
    edge = max(z[0], z[-1])
    middle = float(np.interp(0.5 * (y[0] + y[-1]), y, z))
    if middle >= edge:
        raise ProfileError(f"{path}: the rail profile is upside down: z must be positive downwards, 0 on top")


def _crossing(points: np.ndarray) -> np.ndarray | None:
    """Where two segments of the polygon that are no neighbours cut each other, or None."""
    start, step = points[:-1], np.diff(points, axis=0)
    for k in range(len(step) - 2):
        other, its = start[k + 2 :], step[k + 2 :]
        apart = other - start[k]
        cross = step[k, 0] * its[:, 1] - step[k, 1] * its[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            here = (apart[:, 0] * its[:, 1] - apart[:, 1] * its[:, 0]) / cross
            there = (apart[:, 0] * step[k, 1] - apart[:, 1] * step[k, 0]) / cross
        hit = np.flatnonzero((here >= 0.0) & (here <= 1.0) & (there >= 0.0) & (there <= 1.0))
        if hit.size:
            return start[k] + here[hit[0]] * step[k]
    return None
