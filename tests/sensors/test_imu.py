"""The IMU mask, term by term: each against its formula or its Allan deviation."""

import itertools
import math
import tomllib
from typing import Any

import allantools
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sensors import IMU_PRESETS, Imu, ImuParameters, Kinematics, gravity_calibration, mounting_rotation

G = 9.81


def parameters(**changes: Any) -> ImuParameters:
    """No errors but those asked for; a dictionary is merged into its table."""
    tree: dict[str, Any] = {
        "rate_hz": 100.0,
        "bandwidth_hz": 40.0,
        "accelerometer": {"noise_density_mps2_per_rthz": 0.0, "range_mps2": 100.0},
        "gyroscope": {"noise_density_radps_per_rthz": 0.0, "range_radps": 10.0},
    }
    for name, value in changes.items():
        tree[name] = tree.get(name, {}) | value if isinstance(value, dict) else value
    return ImuParameters.model_validate(tree)


def at_rest(n: int, period_s: float = 0.01) -> Kinematics:
    return Kinematics(
        t_s=period_s * np.arange(n),
        specific_force_mps2=np.tile([0.0, 0.0, G], (n, 1)),
        angular_rate_radps=np.zeros((n, 3)),
        angular_acceleration_radps2=np.zeros((n, 3)),
    )


def moving(n: int, period_s: float = 0.005) -> Kinematics:
    rng = np.random.default_rng(4)
    return Kinematics(
        t_s=period_s * np.arange(n),
        specific_force_mps2=rng.normal(0.0, 2.0, (n, 3)),
        angular_rate_radps=rng.normal(0.0, 0.1, (n, 3)),
        angular_acceleration_radps2=rng.normal(0.0, 0.1, (n, 3)),
    )


def preset(name: str) -> ImuParameters:
    return ImuParameters.model_validate(tomllib.loads(IMU_PRESETS[name].read_text()))


def test_level_sensor_without_errors_reads_gravity_on_z() -> None:
    readings = Imu(parameters(), 0.01, 1).process(at_rest(50))
    np.testing.assert_allclose(readings.specific_force_mps2, np.tile([0.0, 0.0, G], (50, 1)), atol=1e-12)
    np.testing.assert_array_equal(readings.angular_rate_radps, 0.0)


def test_lever_arm_on_a_turntable_that_speeds_up() -> None:
    """About z at w = alpha t: tangential alpha r, towards the axis w^2 r; a filter of 40 Hz lags 5.6 ms behind."""
    arm, alpha, n = 3.0, 0.2, 400
    t = 0.005 * np.arange(n)
    rate = np.column_stack([np.zeros(n), np.zeros(n), alpha * t])
    truth = Kinematics(
        t_s=t,
        specific_force_mps2=np.tile([0.0, 0.0, G], (n, 1)),
        angular_rate_radps=rate,
        angular_acceleration_radps2=np.tile([0.0, 0.0, alpha], (n, 1)),
    )
    readings = Imu(parameters(lever_arm_m=(arm, 0.0, 0.0)), 0.005, 1).process(truth)
    np.testing.assert_allclose(readings.specific_force_mps2[:, 1], alpha * arm, rtol=1e-9)
    late = 2.0 * 0.7071 / (2.0 * math.pi * 40.0)
    expected = -((alpha * (readings.t_s - late)) ** 2) * arm
    np.testing.assert_allclose(readings.specific_force_mps2[20:, 0], expected[20:], atol=1e-3)


@given(st.floats(-math.pi, math.pi), st.floats(-1.5, 1.5), st.floats(-math.pi, math.pi))
def test_mounting_is_a_proper_rotation_with_the_published_second_column(roll: float, pitch: float, yaw: float) -> None:
    rotation = mounting_rotation(roll, pitch, yaw)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    k = (
        -math.cos(pitch) * math.sin(yaw),
        math.cos(yaw) * math.cos(roll) - math.sin(yaw) * math.sin(pitch) * math.sin(roll),
        math.cos(yaw) * math.sin(roll) + math.sin(yaw) * math.sin(pitch) * math.cos(roll),
    )
    np.testing.assert_allclose(rotation[:, 1], k, atol=1e-12)


def test_mounting_turns_both_triads() -> None:
    mounted = parameters(mounting_roll_deg=4.8, mounting_pitch_deg=-18.45, mounting_yaw_deg=15.687)
    level = Imu(parameters(), 0.005, 1).process(moving(200))
    turned = Imu(mounted, 0.005, 1).process(moving(200))
    back = mounting_rotation(*np.radians([4.8, -18.45, 15.687])).T
    np.testing.assert_allclose(turned.specific_force_mps2 @ back.T, level.specific_force_mps2, atol=1e-9)
    np.testing.assert_allclose(turned.angular_rate_radps @ back.T, level.angular_rate_radps, atol=1e-9)


@pytest.mark.parametrize(("frequency_hz", "gain"), [(1.0, 1.0), (40.0, math.sqrt(0.5))])
def test_bandwidth_is_where_the_power_is_halved(frequency_hz: float, gain: float) -> None:
    n, period_s = 4000, 0.001
    t = period_s * np.arange(n)
    truth = Kinematics(
        t_s=t,
        specific_force_mps2=np.repeat(np.sin(2.0 * math.pi * frequency_hz * t)[:, None], 3, axis=1),
        angular_rate_radps=np.zeros((n, 3)),
        angular_acceleration_radps2=np.zeros((n, 3)),
    )
    readings = Imu(parameters(rate_hz=1000.0), period_s, 1).process(truth)
    assert np.std(readings.specific_force_mps2[2000:, 0]) * math.sqrt(2.0) == pytest.approx(gain, rel=1e-3)


@pytest.mark.parametrize("rate_hz", [50.0, 200.0])
def test_white_noise_has_its_density_at_any_rate(rate_hz: float) -> None:
    density, n = 7e-4, 160_000
    noisy = parameters(
        rate_hz=rate_hz,
        bandwidth_hz=20.0,
        accelerometer={"noise_density_mps2_per_rthz": density},
        gyroscope={"noise_density_radps_per_rthz": 2.0 * density},
    )
    readings = Imu(noisy, 1.0 / rate_hz, 11).process(at_rest(n, 1.0 / rate_hz))
    for values, wanted in ((readings.specific_force_mps2, density), (readings.angular_rate_radps, 2.0 * density)):
        for axis in range(3):
            taus, deviation, _, _ = allantools.oadev(values[:, axis], rate=rate_hz, taus=[0.1], data_type="freq")
            assert deviation[0] * math.sqrt(taus[0]) == pytest.approx(wanted, rel=0.02)


@pytest.mark.parametrize("rate_hz", [10.0, 50.0])
def test_drift_is_a_gauss_markov_process(rate_hz: float) -> None:
    """Allan deviation of a Gauss-Markov process: 0.618 sigma at 1.89 correlation times."""
    sd, time_s = 4e-3, 20.0
    drifting = parameters(
        rate_hz=rate_hz, bandwidth_hz=4.0, accelerometer={"drift_sd_mps2": sd, "drift_time_s": time_s}
    )
    n = round(2000 * time_s * rate_hz / 5)
    readings = Imu(drifting, 1.0 / rate_hz, 3).process(at_rest(n, 1.0 / rate_hz))
    deviations = []
    for axis in range(3):
        values = readings.specific_force_mps2[:, axis]
        _, deviation, _, _ = allantools.oadev(values, rate=rate_hz, taus=[1.89 * time_s], data_type="freq")
        deviations.append(deviation[0])
    assert np.mean(deviations) == pytest.approx(0.618 * sd, rel=0.2)
    assert np.std(readings.specific_force_mps2[:, 0]) == pytest.approx(sd, rel=0.2)


def test_drift_starts_anywhere_in_its_distribution() -> None:
    sd = 4e-3
    drifting = parameters(accelerometer={"drift_sd_mps2": sd, "drift_time_s": 1e6})
    starts = [Imu(drifting, 0.01, seed).process(at_rest(1)).specific_force_mps2[0, :2] for seed in range(200)]
    assert np.std(starts) == pytest.approx(sd, rel=0.15)


def test_quantisation_and_saturation() -> None:
    count, limit = G / 1024, 19.62
    coarse = parameters(
        accelerometer={"resolution_mps2": count, "range_mps2": limit, "noise_density_mps2_per_rthz": 1.0}
    )
    values = Imu(coarse, 0.01, 1).process(at_rest(2000)).specific_force_mps2
    assert np.max(np.abs(values)) == limit
    inside = np.abs(values) < limit
    np.testing.assert_allclose(values[inside] / count, np.round(values[inside] / count), atol=1e-9)


def test_quantisation_error_is_a_twelfth_of_a_count_squared() -> None:
    count = 0.01
    clean = Imu(parameters(), 0.005, 1).process(moving(20000)).specific_force_mps2
    coarse = Imu(parameters(accelerometer={"resolution_mps2": count}), 0.005, 1).process(moving(20000))
    assert np.std(coarse.specific_force_mps2 - clean) == pytest.approx(count / math.sqrt(12.0), rel=0.02)


def test_temperature_curve_over_a_temperature_profile() -> None:
    warming = parameters(
        temperature={"t_s": (0.0, 10.0), "temperature_degc": (20.0, 40.0)},
        temperature_resolution_k=0.5,
        accelerometer={
            "temperature": {
                "temperature_degc": (20.0, 30.0, 50.0),
                "x_mps2": (0.0, 0.1, 0.3),
                "y_mps2": (0.0, 0.0, 0.0),
                "z_mps2": (0.0, -0.1, 0.1),
            }
        },
    )
    readings = Imu(warming, 0.01, 1).process(at_rest(2000))
    temperature = np.minimum(20.0 + 2.0 * readings.t_s, 40.0)
    np.testing.assert_allclose(readings.specific_force_mps2[:, 0], 0.01 * (temperature - 20.0), atol=1e-12)
    assert readings.specific_force_mps2[500, 2] == pytest.approx(G - 0.1)
    assert readings.specific_force_mps2[-1, 2] == pytest.approx(G)
    np.testing.assert_allclose(readings.temperature_degc, np.round(2.0 * temperature) / 2.0)


def test_offset_scale_and_cross_axis_stay_within_their_size() -> None:
    wrong = parameters(accelerometer={"offset_mps2": 0.5})
    offsets = np.array([Imu(wrong, 0.01, s).process(at_rest(1)).specific_force_mps2[0, 0] for s in range(200)])
    assert np.max(np.abs(offsets)) <= 0.5
    assert np.std(offsets) == pytest.approx(0.5 / math.sqrt(3.0), rel=0.15)
    scaled = parameters(accelerometer={"scale_sd_share": 0.01, "cross_axis_sd_share": 0.005})
    values = np.array([Imu(scaled, 0.01, s).process(at_rest(1)).specific_force_mps2[0] for s in range(300)])
    assert np.std(values[:, 2]) == pytest.approx(0.01 * G, rel=0.15)
    assert np.std(values[:, :2]) == pytest.approx(0.005 * G, rel=0.15)


@settings(max_examples=20, deadline=None)
@given(cuts=st.lists(st.integers(0, 400), max_size=6), name=st.sampled_from(sorted(IMU_PRESETS)))
def test_any_chunking_gives_the_same_bytes(cuts: list[int], name: str) -> None:
    truth = moving(400)
    whole = Imu(preset(name), 0.005, 9).process(truth)
    imu = Imu(preset(name), 0.005, 9)
    edges = [0, *sorted(cuts), 400]
    parts = [imu.process(truth.rows(slice(a, b))) for a, b in itertools.pairwise(edges)]
    for field in ("t_s", "specific_force_mps2", "angular_rate_radps", "temperature_degc"):
        joined = np.concatenate([getattr(part, field) for part in parts])
        assert joined.tobytes() == getattr(whole, field).tobytes()


def test_same_seed_same_bytes_other_seed_others() -> None:
    runs = [Imu(preset("bmi055"), 0.005, seed).process(moving(100)) for seed in (1, 1, 2)]
    assert runs[0].specific_force_mps2.tobytes() == runs[1].specific_force_mps2.tobytes()
    assert not np.any(runs[0].angular_rate_radps == runs[2].angular_rate_radps)


def test_one_term_does_not_shift_the_noise_of_another() -> None:
    noisy = {"noise_density_mps2_per_rthz": 1e-3}
    plain = Imu(parameters(accelerometer=noisy), 0.01, 5).process(at_rest(100))
    drifting = Imu(
        parameters(accelerometer=noisy, gyroscope={"drift_sd_radps": 1e-3, "scale_sd_share": 0.01}), 0.01, 5
    ).process(at_rest(100))
    np.testing.assert_array_equal(plain.specific_force_mps2, drifting.specific_force_mps2)


def test_presets_are_two_independent_things_with_the_published_figures() -> None:
    assert set(IMU_PRESETS) == {"malvezzi-2014", "bmi055"}
    board = preset("malvezzi-2014")
    assert board.accelerometer.noise_density_mps2_per_rthz == pytest.approx(2.2e-3 * math.sqrt(0.1), rel=2e-3)
    assert board.gyroscope.noise_density_radps_per_rthz == pytest.approx(7.8e-4 * math.sqrt(0.1), rel=2e-3)
    chip = preset("bmi055")
    rms_mps2 = chip.accelerometer.noise_density_mps2_per_rthz * math.sqrt(2.0 * 1.57 * 31.25)
    assert rms_mps2 == pytest.approx(1.05e-3 * G, rel=0.02)
    assert chip.accelerometer.resolution_mps2 == pytest.approx(9.80665 / 1024, rel=1e-3)


def test_gravity_calibration_finds_roll_and_pitch_but_for_the_residual() -> None:
    board = preset("malvezzi-2014")
    found = np.array([gravity_calibration(board, np.random.default_rng(seed)) for seed in range(500)])
    np.testing.assert_allclose(found.mean(axis=0), np.radians([2.0, -2.0]), atol=5e-5)
    np.testing.assert_allclose(found.std(axis=0), 2.2e-4, rtol=0.15)


def test_rates_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match=r"imu\.rate_hz = 90"):
        Imu(parameters(rate_hz=90.0), 0.005, 1)
    with pytest.raises(ValueError, match=r"imu\.bandwidth_hz = 40"):
        Imu(parameters(rate_hz=80.0), 0.0125, 1)
    with pytest.raises(ValueError, match="rows must be"):
        Imu(parameters(), 0.005, 1).process(at_rest(3))


@pytest.mark.parametrize(
    "wrong",
    [
        {"rate_hz": -1.0},
        {"bandwidth_hz": math.inf},
        {"lever_arm_m": (1.0, 2.0)},
        {"mounting_pitch_deg": 95.0},
        {"colour": "red"},
        {"temperature": {"t_s": (1.0, 0.0), "temperature_degc": (1.0, 2.0)}},
        {"accelerometer": {"range_mps2": math.nan}},
        {"gyroscope": {"noise_density_radps_per_rthz": -1.0}},
    ],
)
def test_wrong_parameters_are_refused_by_name(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValidationError, match=next(iter(wrong))):
        parameters(**wrong)
