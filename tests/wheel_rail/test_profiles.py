"""Profiles: true to their drawings, smooth, and refused with the reason when they cannot be used."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wheel_rail.profile_files import ProfileError, read_profile_points
from wheel_rail.profiles import (
    RAIL_PROFILES,
    SMOOTHING_M,
    WHEEL_PROFILES,
    gauge_point_y_m,
    rail_profile,
    smooth_profile,
    wheel_profile,
)


def written(path: Path, points: np.ndarray) -> Path:
    path.write_text("# y z\n" + "\n".join(f"{y:.6f} {z:.6f}" for y, z in points), encoding="utf-8")
    return path


def coarse(points: np.ndarray, step_mm: float = 0.2) -> np.ndarray:
    """A profile as a measuring device gives it: points at even steps of y without the steep ends."""
    y = np.arange(points[0, 0] + 1.0, points[-1, 0] - 1.0, step_mm)
    return np.stack([y, np.interp(y, points[:, 0], points[:, 1])], axis=1)


@pytest.mark.parametrize(("table", "name"), [(WHEEL_PROFILES, n) for n in WHEEL_PROFILES])
def test_wheels_pass_through_the_tape_circle_with_28_mm_flanges(table: dict, name: str) -> None:
    profile = wheel_profile(name)
    assert np.interp(0.0, profile.y_m, profile.z_m) == pytest.approx(0.0, abs=2e-6)
    assert np.max(profile.z_m) == pytest.approx(0.028, abs=2e-5)
    # the flange face stands at 70 degrees
    assert np.degrees(np.max(-profile.angle_rad[profile.y_m > -0.05])) == pytest.approx(70.0, abs=0.1)


@pytest.mark.parametrize("name", [*WHEEL_PROFILES, *RAIL_PROFILES])
def test_smoothing_stays_near_the_drawing(name: str) -> None:
    """Away from corners the smoothed curve stays within a few micrometres."""
    worst = 0.0
    for table in (WHEEL_PROFILES, RAIL_PROFILES):
        if name not in table:
            continue
        points = table[name]() / 1000.0
        profile = smooth_profile(table[name]())
        y = points[(points[:, 0] > profile.y_m[0] + 0.004) & (points[:, 0] < 0.028)]
        worst = max(worst, float(np.max(np.abs(np.interp(y[:, 0], profile.y_m, profile.z_m) - y[:, 1]))))
    print(f"{name}: {1e6 * worst:.2f} um from the drawing, allowed 5")
    assert worst < 5e-6


def test_uic60_has_its_radii_and_width() -> None:
    rail = rail_profile("uic60")
    for y_m, radius_m in ((0.0, 0.3), (0.007, 0.3), (0.015, 0.08), (0.022, 0.08), (0.032, 0.013)):
        for side in (-1.0, 1.0):
            assert 1.0 / np.interp(side * y_m, rail.y_m, rail.curvature_1pm) == pytest.approx(radius_m, rel=2e-3)
    # 60E1: the head is 72 mm wide 14 mm below its top
    assert gauge_point_y_m(rail) == pytest.approx(-0.036, abs=2e-5)


def test_the_standards_rail_a_is_its_uic60_turned_by_a_twentieth() -> None:
    """Laid upon each other by the centres of the crowns, which are not moved by a wrong width of the crown."""
    drawn = RAIL_PROFILES["en15302-a"]()
    y, z = RAIL_PROFILES["uic60-en15302"]().T
    c, s = np.cos(0.05), np.sin(0.05)
    y, z = c * y + s * z, c * z - s * y
    # the crown's centre stands 300 mm below the top of the upright head; that of rail A is in the standard
    y, z = y + 17.5966 - 300.0 * s, z + 299.48349 - 300.0 * c
    error = np.abs(np.interp(drawn[:, 0], y, z) - drawn[:, 1])
    assert np.max(error[(drawn[:, 0] > -23.0) & (drawn[:, 0] < 28.5)]) < 1e-4  # mm; with a crown of 10.25 mm 0.04
    assert np.max(error[(drawn[:, 0] > -32.5) & (drawn[:, 0] < 39.0)]) < 2e-3  # the flanks are steep


@pytest.mark.parametrize("inclination", [0.0, 1 / 40, 1 / 20])
def test_an_inclined_rail_leans_towards_the_track(inclination: float) -> None:
    rail = rail_profile("uic60", inclination)
    top = int(np.argmin(rail.z_m))
    assert rail.z_m[top] == 0.0
    # the radius of 300 mm turned by the angle puts its highest point there
    inside = min(0.3 * np.sin(np.arctan(inclination)), 0.01025 + 0.08)
    if inclination < 1 / 30:
        assert rail.y_m[top] == pytest.approx(inside, abs=3e-5)
    # the gauge side falls off sooner than the other side
    assert np.interp(-0.02, rail.y_m, rail.z_m) >= np.interp(0.02, rail.y_m, rail.z_m) - 1e-6


def test_derivatives_are_those_of_the_curve() -> None:
    for profile in (wheel_profile("s1002"), rail_profile("uic60", 1 / 40)):
        inner = slice(50, -50)
        length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(profile.y_m), np.diff(profile.z_m)))])
        slope = np.arctan2(np.gradient(profile.z_m, length), np.gradient(profile.y_m, length))
        assert np.max(np.abs(slope - profile.angle_rad)[inner]) < 2e-4
        bend = np.gradient(profile.angle_rad, length)
        assert np.max(np.abs(bend - profile.curvature_1pm)[inner]) < 0.5
        # continuous: from R80 to R13 curvature passes within a millimetre, not within a node
        assert np.max(np.abs(np.diff(profile.curvature_1pm))[inner]) < 12.0


@given(radius_mm=st.floats(10.0, 400.0), smoothing_m=st.floats(1.5e-4, 1e-3))
@settings(max_examples=15, deadline=None)
def test_an_arc_keeps_its_radius(radius_mm: float, smoothing_m: float) -> None:
    angle = np.linspace(-0.8, 0.8, 6000) * min(1.0, 40.0 / radius_mm)
    arc = radius_mm * np.stack([np.sin(angle), 1.0 - np.cos(angle)], axis=1)
    profile = smooth_profile(arc, smoothing_m)
    middle = len(profile.y_m) // 2
    assert 1000.0 / profile.curvature_1pm[middle] == pytest.approx(radius_mm, rel=2e-3)
    assert profile.z_m[middle] == pytest.approx(0.0, abs=2e-6)


def test_a_file_gives_the_profile_it_was_written_from(tmp_path: Path) -> None:
    """Both orders of the points, blanks or semicolons; noise of 5 um is smoothed to usable curvatures."""
    points = coarse(WHEEL_PROFILES["s1002"]())
    path = written(tmp_path / "worn.txt", points[::-1])
    (tmp_path / "worn.csv").write_text("\n".join(f"{y:.6f};{z:.6f} % c" for y, z in points), encoding="utf-8")
    drawn = wheel_profile("s1002")
    for name in (path, tmp_path / "worn.csv"):
        read = wheel_profile(str(name))
        at = np.linspace(-0.03, 0.05, 200)
        assert np.max(np.abs(np.interp(at, read.y_m, read.z_m) - np.interp(at, drawn.y_m, drawn.z_m))) < 2e-6
    points[:, 1] += 0.005 * np.random.default_rng(1).standard_normal(len(points))
    noisy = smooth_profile(points, 2e-3)
    at = np.linspace(-0.02, 0.025, 200)
    error = np.interp(at, noisy.y_m, noisy.curvature_1pm) - np.interp(at, drawn.y_m, drawn.curvature_1pm)
    assert np.sqrt(np.mean(error**2)) < 0.6


WHEEL = coarse(WHEEL_PROFILES["s1002"]())
LOOP = np.concatenate([WHEEL[:200], WHEEL[190:200][::-1] + np.array([0.03, 0.4]), WHEEL[185:]])
BAD = [
    ("few", WHEEL[::40], "at least 30"),
    ("metres", WHEEL / 1000.0, "in metres"),
    ("inches", WHEEL / 25.4, "in inches"),
    ("micrometres", WHEEL * 1000.0, "in micrometres"),
    ("too narrow", WHEEL[:200], "mm wide"),
    ("not monotone", np.concatenate([WHEEL[:100], WHEEL[99:98:-1] - (0.05, 0.01), WHEEL[100:]]), "not monotone"),
    ("double point", np.concatenate([WHEEL[:100], WHEEL[99:]]), "not monotone"),
    ("crossing", LOOP, "crosses itself"),
    ("gap", np.concatenate([WHEEL[:300], WHEEL[340:]]), "between the points"),
    ("upside down", WHEEL * (1.0, -1.0), "upside down"),
    ("mirrored", WHEEL * (-1.0, 1.0), "mirrored"),
]


@pytest.mark.parametrize(("name", "points", "reason"), BAD, ids=[b[0] for b in BAD])
def test_bad_wheel_profiles_are_refused_with_the_reason(
    name: str, points: np.ndarray, reason: str, tmp_path: Path
) -> None:
    path = written(tmp_path / "bad.txt", points)
    with pytest.raises(ProfileError, match=reason) as error:
        read_profile_points(path, "wheel")
    assert "bad.txt" in str(error.value)


@pytest.mark.parametrize("line", ["1.0 nan", "inf 2", "1.0", "1 2 3", "one two"])
def test_lines_that_are_not_two_numbers_are_named(line: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.txt"
    path.write_text(f"# y z\n0 0\n{line}\n", encoding="utf-8")
    with pytest.raises(ProfileError, match="line 3"):
        read_profile_points(path, "wheel")


def test_missing_files_unknown_names_and_upside_down_rails(tmp_path: Path) -> None:
    with pytest.raises(ProfileError, match="cannot be read"):
        wheel_profile(str(tmp_path / "none.txt"))
    with pytest.raises(ValueError, match="one of s1002"):
        wheel_profile("s1003")
    rail = coarse(RAIL_PROFILES["en15302-a"]())
    with pytest.raises(ProfileError, match="upside down"):
        rail_profile(str(written(tmp_path / "rail.txt", rail * (1.0, -1.0))))
    shallow = rail[rail[:, 0] > -30.0]
    with pytest.raises(ValueError, match="14 mm are needed"):
        gauge_point_y_m(smooth_profile(shallow))
    for bad in (1e-5, 1.0, float("nan")):
        with pytest.raises(ValueError, match="smoothing_m"):
            wheel_profile("s1002", bad)
    assert SMOOTHING_M < 1e-3
