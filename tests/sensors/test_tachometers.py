"""Tachometers: edges against the wheel's angle, speeds against their resolution, in the loop and afterwards."""

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydantic import ValidationError

from sensors import AxleSpeedReadings, TachometerParameters, TachometerReadings, Tachometers, axle_speeds

RADIUS_M = 0.46
PITCH_M = 2.0 * math.pi * RADIUS_M / 100
EXACT = TachometerParameters(pitch_error_share=0.0, eccentricity_share=0.0, hysteresis_share=0.0)

Array = NDArray[np.float64]


def turned(
    tick_s: Array, angle_rad: Array, speed_radps: Array, parameters: TachometerParameters = EXACT, seed: int = 1
) -> tuple[TachometerReadings, AxleSpeedReadings]:
    tachometers = Tachometers(parameters, np.random.default_rng(seed))
    speed, valid = [], []
    for t, angle, omega in zip(tick_s, angle_rad, speed_radps, strict=True):
        tachometers.advance(float(t), angle, omega)
        speed.append(tachometers.axle_speed_mps.copy())
        valid.append(tachometers.valid.copy())
    return tachometers.readings(), AxleSpeedReadings(t_s=tick_s, axle_speed_mps=np.array(speed), valid=np.array(valid))


def steady(speed_mps: float, duration_s: float) -> tuple[Array, Array, Array]:
    tick_s = 0.01 * np.arange(round(duration_s * 100) + 1)
    omega = np.full((len(tick_s), 4), speed_mps / RADIUS_M)
    return tick_s, omega * tick_s[:, None] + np.array([0.0, 0.1, 0.2, 0.3]), omega


def wandering(duration_s: float, seed: int = 2) -> tuple[Array, Array, Array]:
    """Wheels that speed up, slow down, stop and turn round; angle and angular speed by formula."""
    rng = np.random.default_rng(seed)
    tick_s = 0.01 * np.arange(round(duration_s * 100) + 1)
    size, pace, phase = rng.uniform(5.0, 60.0, 4), rng.uniform(0.3, 2.0, 4), rng.uniform(0.0, 6.0, 4)
    course = pace * tick_s[:, None] + phase
    return tick_s, size / pace * np.sin(course), size * np.cos(course)


def test_the_pitch_of_a_100_tooth_wheel_is_28_9_mm() -> None:
    assert pytest.approx(28.9e-3, abs=0.05e-3) == PITCH_M


def test_count_equals_angle_within_one() -> None:
    tick_s, angle, omega = wandering(20.0)
    edges, _ = turned(tick_s, angle, omega)
    for wheelset in range(1, 5):
        mine = (edges.wheelset == wheelset) & (edges.t_s > 0.0)
        for k in (137, 700, 1500, 2000):
            net = edges.direction[mine & (edges.t_s <= tick_s[k])].astype(int).sum()
            pulses = (angle[k, wheelset - 1] - angle[0, wheelset - 1]) * 100 / (2.0 * math.pi)
            assert abs(net - pulses) < 1.0 + 1e-9


def test_edges_lie_where_the_angle_passes_a_tooth() -> None:
    tick_s, angle, omega = wandering(10.0)
    edges, _ = turned(tick_s, angle, omega, EXACT.model_copy(update={"clock_resolution_s": 1e-9}))
    rng = np.random.default_rng(2)
    size, pace, phase = rng.uniform(5.0, 60.0, 4), rng.uniform(0.3, 2.0, 4), rng.uniform(0.0, 6.0, 4)
    i = edges.wheelset - 1
    at_edge = (size[i] / pace[i] * np.sin(pace[i] * edges.t_s + phase[i])) * 100 / (2.0 * math.pi)
    late = edges.t_s > 0.0
    # The Hermite cubic misses the sine by h^4/384 of its fourth derivative: far below a thousandth of a pitch.
    assert np.max(np.abs(at_edge - np.round(at_edge))[late]) < 1e-4


def test_a_long_run_has_its_edges_once_in_some_bytes_each() -> None:
    """A time and a byte for wheelset and direction, twice for a moment. Six blocks of them."""
    tick_s = 0.01 * np.arange(101)
    omega = np.array([150.0, -150.0, 140.0, -130.0])
    tachometers = Tachometers(TachometerParameters(pulses_per_revolution=4096), np.random.default_rng(3))
    tracemalloc.start()
    try:
        for t in tick_s:
            tachometers.advance(float(t), omega * t, omega)
        held, _ = tracemalloc.get_traced_memory()
        edges = tachometers.readings()
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    count = len(edges)
    print(f"{count} edges: {held / count:.1f} bytes each in the run, {peak / count:.1f} at the peak")
    assert count == pytest.approx(570.0 * 4096 / (2.0 * math.pi), rel=0.02)
    assert held < 10.0 * count
    assert peak < 24.0 * count
    assert np.all(np.diff(edges.t_s) >= 0.0)
    for wheelset, speed in enumerate(omega, start=1):
        mine = edges.rows(edges.wheelset == wheelset)
        assert np.all(mine.direction == np.sign(speed))
        assert len(mine) == pytest.approx(abs(speed) * 4096 / (2.0 * math.pi), abs=3.0)
    again = tachometers.readings()
    np.testing.assert_array_equal(again.t_s, edges.t_s)
    np.testing.assert_array_equal(again.wheelset, edges.wheelset)


def test_one_pulse_each_208_ms_at_half_a_kmh() -> None:
    edges, _ = turned(*steady(0.5 / 3.6, 10.0))
    first = edges.t_s[edges.wheelset == 1]
    np.testing.assert_allclose(np.diff(first), 0.208, atol=0.0005)


def test_steady_speed_is_as_good_as_the_clock() -> None:
    """Timing with 1 us: at 160 km/h 1 us in the 10 ms between the counted edges, and at worst two of them."""
    speed_mps = 160.0 / 3.6
    _, speeds = turned(*steady(speed_mps, 5.0))
    assert np.all(speeds.valid)
    assert np.max(np.abs(speeds.axle_speed_mps / speed_mps - 1.0)) < 2.2e-4


def test_tooth_errors_show_once_per_revolution_in_the_expected_size() -> None:
    """Two edges about 11.5 pitches apart, each off by 0.5 % of a pitch: sqrt(2) 0.005 / 11.5 of the speed."""
    speed_mps = 120.0 / 3.6
    toothed = EXACT.model_copy(update={"pitch_error_share": 0.005})
    _, speeds = turned(*steady(speed_mps, 20.0), toothed)
    expected = math.sqrt(2.0) * 0.005 / (speed_mps * 0.01 / PITCH_M)
    # The errors of four wheels of 100 teeth are one draw: 400 values, so some 5 % of the deviation.
    assert np.std(speeds.axle_speed_mps / speed_mps) == pytest.approx(expected, rel=0.15)
    edges, _ = turned(*steady(speed_mps, 20.0), toothed)
    spacing = np.diff(edges.t_s[edges.wheelset == 2])
    np.testing.assert_allclose(spacing[5:305], spacing[105:405], atol=2.1e-6)  # the same teeth each revolution


def test_eccentricity_swings_the_speed_once_per_revolution() -> None:
    speed_mps, share = 20.0, 0.002
    _, speeds = turned(*steady(speed_mps, 10.0), EXACT.model_copy(update={"eccentricity_share": share}))
    assert np.std(speeds.axle_speed_mps[1:] / speed_mps) == pytest.approx(share / math.sqrt(2.0), rel=0.05)


def test_reversal_changes_the_direction_and_the_sign() -> None:
    tick_s = 0.01 * np.arange(1001)
    omega = np.repeat((10.0 - 2.0 * tick_s)[:, None], 4, axis=1)
    angle = np.repeat((10.0 * tick_s - tick_s**2)[:, None], 4, axis=1)
    edges, speeds = turned(tick_s, angle, omega)
    mine = edges.rows(edges.wheelset == 1)
    assert np.all(mine.direction[mine.t_s < 5.0] == 1)
    assert np.all(mine.direction[mine.t_s > 5.0] == -1)
    assert np.all(speeds.axle_speed_mps[tick_s < 4.9] > 0.0)
    assert np.all(speeds.axle_speed_mps[tick_s > 5.4] < 0.0)
    # The speed is that of the time between edges: late by a tick or by the wait for an edge; turning round takes two.
    rolling = np.abs(tick_s - 5.0) > 0.4
    late = 0.02 + 2.0 * PITCH_M / (np.abs(omega[rolling, 0]) * RADIUS_M)
    error = np.abs(speeds.axle_speed_mps[rolling, 0] - omega[rolling, 0] * RADIUS_M)
    assert np.all(error <= 2.0 * RADIUS_M * late + 1e-3)


def test_hysteresis_keeps_a_trembling_wheel_quiet() -> None:
    tick_s = 0.01 * np.arange(501)
    pitch_rad = 2.0 * math.pi / 100
    tremble = 0.008 * pitch_rad
    angle = np.repeat((tremble * np.sin(300.0 * tick_s) + 5.0 * pitch_rad)[:, None], 4, axis=1)
    omega = np.repeat((300.0 * tremble * np.cos(300.0 * tick_s))[:, None], 4, axis=1)
    loud, _ = turned(tick_s, angle, omega)
    quiet, speeds = turned(tick_s, angle, omega, EXACT.model_copy(update={"hysteresis_share": 0.02}))
    assert np.count_nonzero(loud.t_s > 0.0) > 100
    assert np.count_nonzero(quiet.t_s > 0.0) <= 4
    assert np.all(speeds.axle_speed_mps[100:] == 0.0)


def test_stopped_wheel_reads_less_and_less_then_zero_after_the_timeout() -> None:
    tick_s = 0.01 * np.arange(201)
    going = np.minimum(tick_s, 1.0)
    angle = np.repeat((2.0 * going)[:, None], 4, axis=1)
    omega = np.repeat(np.where(tick_s < 1.0, 2.0, 0.0)[:, None], 4, axis=1)
    edges, speeds = turned(tick_s, angle, omega)
    last_s = edges.t_s[-1]
    waiting = (tick_s > last_s + 0.02) & (tick_s < last_s + 0.5)
    bound = PITCH_M / (tick_s[waiting] - last_s)
    assert np.all(speeds.axle_speed_mps[waiting, 0] <= np.minimum(bound, 2.0 * RADIUS_M) + 1e-3)
    assert np.all(speeds.axle_speed_mps[tick_s > last_s + 0.51] == 0.0)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_front_end_over_recorded_edges_gives_the_same_numbers(seed: int) -> None:
    parameters = TachometerParameters(wheel_radius_m=(0.46, 0.45, 0.44, 0.43))
    tick_s, angle, omega = wandering(4.0, seed)
    edges, loop = turned(tick_s, angle, omega, parameters, seed)
    again = axle_speeds(edges, parameters, tick_s)
    np.testing.assert_array_equal(again.axle_speed_mps, loop.axle_speed_mps)
    np.testing.assert_array_equal(again.valid, loop.valid)


def test_edges_hardly_depend_on_the_tick() -> None:
    tick_s, angle, omega = wandering(5.0)
    fine, _ = turned(tick_s, angle, omega)
    coarse, _ = turned(tick_s[::2], angle[::2], omega[::2])
    mine, other = fine.rows(fine.t_s > 0.0), coarse.rows(coarse.t_s > 0.0)
    assert abs(len(mine) - len(other)) <= 8  # at a turning point a tooth may be just touched


def test_same_seed_same_edges_other_seed_others() -> None:
    run = steady(30.0, 2.0)
    first, _ = turned(*run, TachometerParameters(), 5)
    again, _ = turned(*run, TachometerParameters(), 5)
    other, _ = turned(*run, TachometerParameters(), 6)
    assert first.t_s.tobytes() == again.t_s.tobytes()
    assert first.t_s.tobytes() != other.t_s[: len(first.t_s)].tobytes()


def test_the_edge_buffer_grows() -> None:
    edges, _ = turned(*steady(80.0, 8.0))
    assert len(edges) == pytest.approx(4 * 80.0 * 8.0 / PITCH_M, abs=20)
    assert len(edges) > 65536


def test_a_wheel_that_has_stood_is_valid_and_zero_at_once() -> None:
    _, speeds = turned(*steady(0.0, 0.1))
    assert np.all(speeds.valid)
    assert np.all(speeds.axle_speed_mps == 0.0)


def test_time_that_stands_still_and_angles_that_jump_are_refused() -> None:
    tachometers = Tachometers(EXACT, np.random.default_rng(1))
    tachometers.advance(0.0, np.zeros(4), np.zeros(4))
    with pytest.raises(ValueError, match="not after the last tick"):
        tachometers.advance(0.0, np.zeros(4), np.zeros(4))
    with pytest.raises(ValueError, match="angles jump"):
        tachometers.advance(0.01, np.full(4, 1e6), np.zeros(4))


@pytest.mark.parametrize(
    "wrong",
    [
        {"pulses_per_revolution": 2},
        {"wheel_radius_m": (0.46, 0.46, 0.46)},
        {"wheel_radius_m": (0.46, 0.46, 0.46, -0.46)},
        {"clock_resolution_s": 0.0},
        {"timeout_s": math.nan},
        {"teeth": 100},
    ],
)
def test_wrong_parameters_are_refused_by_name(wrong: dict[str, object]) -> None:
    with pytest.raises(ValidationError, match=next(iter(wrong))):
        TachometerParameters.model_validate(wrong)
