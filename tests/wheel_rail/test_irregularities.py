"""Irregular rails: drawn reproducibly, read from files, and smooth under the wheels."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pyarrow import parquet
from pydantic import ValidationError

from wheel_rail import Irregularities, Track, TrackParameters
from wheel_rail.compiled import Array, compiled
from wheel_rail.irregularities import ASIDE, SLOPES, UP, displaced_frame, rail_offsets
from wheel_rail.irregularity_parameters import IrregularityParameters
from wheel_rail.irregularity_spectra import QUANTITIES, SPECTRA
from wheel_rail.track_frame import track_frame


def drawn(length_m: float = 3000.0, seed: int = 1, **values: object) -> Irregularities:
    parameters = IrregularityParameters.model_validate({"spectrum": "erri-b176-low", **values})
    return Irregularities.of(parameters, length_m, np.random.default_rng(seed))


def offsets_at(rough: Irregularities, s_m: float) -> np.ndarray:
    offsets = np.empty(8)
    rail_offsets(s_m, rough.first_m, rough.cell_m, rough.table, offsets)
    return offsets


@compiled
def displaced_one(wheel: Array, track: Array, offsets: Array, rail: int, moved: Array) -> None:
    """One rail's frame (14,) where a wheel stands, from the track's and the offsets of both rails."""
    origin, (ahead, left, up, twist, curvature) = displaced_frame(
        (wheel[0] - track[0], wheel[1] - track[1], wheel[2] - track[2]),
        ((track[3], track[4], track[5]), (track[6], track[7], track[8]), (track[9], track[10], track[11]), track[12],
         track[13]),
        (offsets[ASIDE + rail], offsets[UP + rail], offsets[SLOPES + ASIDE + rail], offsets[SLOPES + UP + rail]),
    )  # fmt: skip
    for j in range(3):
        moved[j] = track[j] + origin[j]
        moved[3 + j], moved[6 + j], moved[9 + j] = ahead[j], left[j], up[j]
    moved[12], moved[13] = twist, curvature


def test_the_seed_decides_the_rails_and_the_length_of_the_line_does_not() -> None:
    one, again, other, longer = drawn(), drawn(), drawn(seed=2), drawn(length_m=4000.0)
    assert one.table.tobytes() == again.table.tobytes()
    assert np.corrcoef(one.values_m[:, 0], other.values_m[:, 0])[0, 1] < 0.5
    undisturbed = one.position_m < 2950.0  # before it fades out
    assert longer.values_m[: len(one.values_m)][undisturbed] == pytest.approx(one.values_m[undisturbed], abs=1e-15)


def test_quantities_are_independent_and_scale() -> None:
    one = drawn(length_m=20_000.0)
    coupling = np.corrcoef(one.values_m.T) - np.eye(len(QUANTITIES))
    assert np.abs(coupling).max() < 0.15
    assert drawn(scale=0.5).values_m == pytest.approx(0.5 * drawn().values_m)


def test_wavelengths_outside_the_band_are_missing() -> None:
    one = drawn(length_m=20_000.0, shortest_wavelength_m=4.0, longest_wavelength_m=40.0)
    power = np.abs(np.fft.rfft(one.values_m[:, 0])) ** 2
    frequency = np.fft.rfftfreq(len(one.values_m), one.cell_m)
    outside = (frequency < 1.0 / 52.0) | (frequency > 1.0 / 3.1)
    assert power[outside].sum() < 2e-3 * power.sum()


def test_rails_lie_where_the_four_quantities_put_them() -> None:
    values = np.zeros((200, 4))
    values[100] = 0.004, 0.003, 0.002, 0.001
    rough = Irregularities(0.0, 0.25, values)
    left_y, right_y, left_z, right_z = offsets_at(rough, 25.0)[:SLOPES]
    assert 0.5 * (left_z + right_z) == pytest.approx(0.004)
    assert 0.5 * (left_y + right_y) == pytest.approx(0.003)
    assert right_z - left_z == pytest.approx(0.002)  # right rail raised, as cant is
    assert left_y - right_y == pytest.approx(0.001)  # wider


def test_rails_fade_in_and_out_and_are_smooth_beyond() -> None:
    rough = drawn(from_m=500.0, to_m=2000.0, fade_m=100.0)
    outside = (rough.position_m <= 500.0) | (rough.position_m >= 2000.0)
    assert not np.any(rough.values_m[outside])
    for s in (-40.0, -1e-9, 3000.0, 3030.0, 1e9):
        assert not np.any(offsets_at(rough, s))
    full, part = drawn(), rough
    inside = (rough.position_m > 600.0) & (rough.position_m < 1900.0)
    assert part.values_m[inside] == pytest.approx(full.values_m[inside])
    half = np.searchsorted(rough.position_m, 550.0)
    assert part.values_m[half] == pytest.approx(0.5 * full.values_m[half])


def test_slopes_and_curvatures_of_the_rails_have_no_jumps() -> None:
    rough = drawn(length_m=400.0)
    h = 0.005
    read = np.array([offsets_at(rough, s) for s in np.arange(100.0, 200.0, h)])
    slopes = np.diff(read[:, :4], axis=0) / h
    assert slopes == pytest.approx(0.5 * (read[1:, 4:] + read[:-1, 4:]), abs=1e-6)
    curvature = np.diff(read[:, 4:], axis=0) / h
    # it moves linearly over the 50 steps from node to node: a jump would be a whole one
    assert np.abs(np.diff(curvature, axis=0)).max() < 0.1 * np.abs(curvature).max()


def test_a_wave_is_read_as_a_wave() -> None:
    cell, length = 0.25, 3.0
    place = cell * np.arange(400)
    wave = 1e-3 * np.sin(2.0 * np.pi * place / length)
    rough = Irregularities(0.0, cell, np.stack([wave, 0.0 * wave, 0.0 * wave, 0.0 * wave], axis=1))
    for s in np.linspace(30.0, 60.0, 500):
        found = offsets_at(rough, s)
        assert found[UP] == pytest.approx(1e-3 * np.sin(2.0 * np.pi * s / length), abs=1e-6)
        assert found[SLOPES + UP] == pytest.approx(2e-3 * np.pi / length * np.cos(2.0 * np.pi * s / length), abs=1e-5)


@settings(max_examples=100, deadline=None)
@given(st.floats(120.0, 900.0), st.floats(-9e-4, 9e-4), st.integers(0, 1))
@example(174.0, 0.000576, 0)  # 8 mm aside in the steep cant ramp
def test_a_rails_frame_runs_along_the_rail(
    curved: tuple[Track, Irregularities], s_m: float, ahead: float, rail: int
) -> None:
    """Its origin is on the rail's line abreast of the wheel, its tangent that line's derivative."""
    track, rough = curved

    def place(s: float) -> np.ndarray:
        frame = np.empty(14)
        track_frame(s, track.origin_m, track.table, frame)
        aside, up = offsets_at(rough, s)[[ASIDE + rail, UP + rail]]
        return frame[:3] + aside * frame[6:9] + up * frame[9:12]

    frame, moved = np.empty(14), np.empty(14)
    track_frame(s_m, track.origin_m, track.table, frame)
    wheel = frame[:3] + ahead * frame[3:6] + 0.002 * frame[6:9] + 0.46 * frame[9:12]
    displaced_one(wheel, frame, offsets_at(rough, s_m + ahead), rail, moved)
    axes = moved[3:12].reshape(3, 3)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    # within a millimetre the track turns by 3e-6 rad, on which an offset of some mm is not taken along
    assert moved[:3] == pytest.approx(place(s_m + ahead), abs=3e-8)
    along = place(s_m + ahead + 1e-4) - place(s_m + ahead - 1e-4)
    # all that is left out is that the rail inside of a curve is shorter: its slope times curvature times offset
    assert axes[0] == pytest.approx(along / np.linalg.norm(along), abs=1e-7)


@pytest.fixture(scope="module")
def curved() -> tuple[Track, Irregularities]:
    curve = {"start_m": 100.0, "transition_m": 80.0, "length_m": 300.0, "radius_m": 300.0, "cant_mm": 120.0}
    parameters = TrackParameters.model_validate(
        {"length_m": 1000.0, "curves": [curve], "irregularities": {"spectrum": "erri-b176-high"}}
    )
    track = Track(parameters, np.random.default_rng(3))
    assert track.irregularities is not None
    return track, track.irregularities


# --- measured ones

MEASURED = np.stack([0.25 * np.arange(4001), *np.random.default_rng(5).normal(0.0, 1.0, (4, 4001))])
NAMES = ("position_m", *(f"{quantity}_mm" for quantity in QUANTITIES))


def csv(columns: dict[str, np.ndarray]) -> str:
    rows = [",".join("" if np.isnan(x) else f"{x:.6f}" for x in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join([",".join(columns), *rows])


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_measured_rails_are_those_of_the_file(ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"rail.{ending}"
    columns = dict(zip((*NAMES, "temperature_degc"), [*MEASURED, MEASURED[1]], strict=True))
    if ending == "csv":
        file.write_text(csv(columns), encoding="utf-8")
    else:
        parquet.write_table(pa.table(columns), file)
    rough = Irregularities.of(IrregularityParameters(file=str(file), scale=2.0), 1000.0, None)
    assert (rough.cell_m, rough.first_m) == (pytest.approx(0.25), 0.0)
    inside = slice(200, 3800)
    assert rough.values_m[inside] == pytest.approx(2e-3 * MEASURED[1:, inside].T, abs=1e-8)
    part = csv({name: columns[name] for name in ("alignment_mm", "position_m")})
    (tmp_path / "part.csv").write_text(part, encoding="utf-8")
    rough = Irregularities.of(IrregularityParameters(file=str(tmp_path / "part.csv")), 1000.0, None)
    assert rough.values_m[inside, 1] == pytest.approx(1e-3 * MEASURED[2, inside], abs=1e-8)
    assert not np.any(rough.values_m[:, [0, 2, 3]])


def changed(row: int, column: str, value: float) -> dict[str, np.ndarray]:
    columns = {name: values.copy() for name, values in zip(NAMES, MEASURED, strict=True)}
    columns[column][row] = value
    return columns


WITH_GAP = {name: np.delete(values, slice(800, 808)) for name, values in zip(NAMES, MEASURED, strict=True)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must have the column position_m and at least one of longitudinal_level_mm"),
        ("position_m\n0\n1", "must have the column position_m and at least one"),
        ("position_m,gauge_mm,gauge_mm\n", "a column stands there twice"),
        ("position_m,gauge_mm\n0,0.1\n0.25,x\n", "cannot be read"),
        ("position_m,gauge_mm\n0,0.1\n0.25,0.2\n", "2 rows, at least 10"),
        (csv(changed(7, "gauge_mm", np.nan)), r"row 8: gauge_mm is not a finite number \(gaps"),
        (csv(changed(7, "alignment_mm", 300.0)), "row 8: alignment_mm = 300: at most 100"),
        (csv(changed(9, "position_m", 2.0)), "row 10: position_m = 2 comes after 2"),
        (csv(changed(9, "position_m", 2.26)), "row 10: an unequal step of 0.26 m after position_m = 2,"),
        (csv(WITH_GAP), "row 801: a gap of 2.25 m after position_m = 199.75"),
        (csv({**WITH_GAP, "position_m": 8.0 * WITH_GAP["position_m"]}), "values every 2 m"),
        (csv({name: v[:2000] for name, v in zip(NAMES, MEASURED, strict=True)}), "measured from 0 to 499.75 m, asked"),
    ],
)
def test_bad_measurements_are_refused_with_file_and_row(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "bad.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=message) as refusal:
        Irregularities.of(IrregularityParameters(file=str(file)), 1000.0, None)
    assert str(refusal.value).startswith(f"irregularities.file = {file}: ")


def test_a_file_that_is_not_there_or_no_parquet_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.parquet").write_text("no", encoding="utf-8")
    for name in ("none.csv", "text.parquet"):
        with pytest.raises(ValueError, match=f"irregularities.file = .*{name}: cannot be read"):
            Irregularities.of(IrregularityParameters(file=str(tmp_path / name)), 1000.0, None)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({}, "spectrum: either it or file"),
        ({"spectrum": "aar-6", "file": "x.csv"}, "spectrum: either it or file"),
        ({"spectrum": "aar-7"}, "'erri-b176-low', 'erri-b176-high', 'aar-5' or 'aar-6'"),
        ({"spectrum": "aar-6", "shortest_wavelength_m": 0.8}, "shortest_wavelength_m = 0.8: must be at least 4 cells"),
        (
            {"spectrum": "aar-6", "longest_wavelength_m": 4.0},
            "longest_wavelength_m = 4.0: must be at least one and a h",
        ),
        ({"spectrum": "aar-6", "scale": 0.0}, "greater than 0"),
        ({"spectrum": "aar-6", "to_m": 1200.0}, "irregularities.to_m = 1200.0: beyond length_m = 1000"),
        ({"spectrum": "aar-6", "from_m": 950.0}, "irregularities.from_m = 950.0: they end at 1000 m, too soon"),
    ],
)
def test_bad_irregularities_are_refused(values: dict, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        TrackParameters.model_validate({"length_m": 1000.0, "irregularities": values})


def test_random_rails_need_a_stream() -> None:
    parameters = TrackParameters.model_validate({"length_m": 1000.0, "irregularities": {"spectrum": "aar-6"}})
    with pytest.raises(ValueError, match="irregularities.spectrum: .* a random stream is needed"):
        Track(parameters)


@pytest.mark.parametrize("name", SPECTRA)
def test_spectra_fall_with_the_wave_number_where_rails_are_measured(name: str) -> None:
    frequency = np.geomspace(0.02, 0.3, 50)
    spectrum = SPECTRA[name]  # type: ignore[index]
    for quantity in QUANTITIES[:2]:
        density = spectrum.per_cycle(quantity, frequency)
        assert np.all(density > 0.0)
        assert np.all(np.diff(density) < 0.0)
    # independent rails: half the difference of their heights is as rough as their mean at short wavelengths
    ratio = 0.25 * spectrum.per_cycle("cross_level", frequency) / spectrum.per_cycle("longitudinal_level", frequency)
    assert ratio[-1] == pytest.approx(1.0, abs=0.2)
    assert np.all(np.diff(ratio) > 0.0)
