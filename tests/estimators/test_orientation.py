"""The orientation filter: gradient with the right sign, roll in curves, consistent with its own covariance."""

import math

import numpy as np
import pytest

from estimators import Initial, Orientation, OrientationParameters, Sample
from estimators.wheel_window import WheelWindow, slope_noise_mps2
from tests.estimators.synthetic_run import Run, drive, observe, preset_imu, quiet_imu, ramp, total


@pytest.fixture(scope="module")
def coasting_up() -> Run:
    """Coasting from level onto 10 per mille, with the preset IMU."""
    return observe(drive(60.0, 30.0, lambda t: -0.03, gradient_permille=ramp(300.0, 100.0, 10.0)), imu=preset_imu())


def orientation(**changes: object) -> Orientation:
    return Orientation(OrientationParameters.model_validate(changes))


def test_coasting_up_10_permille_reads_10_permille(coasting_up: Run) -> None:
    estimate = coasting_up.estimate(orientation())
    late = estimate.t_s > 25.0
    # The accelerometer's bias of 4.1 mm/s2 is 0.42 per mille, the noise of wheel and gyro about as much.
    assert np.mean(estimate.gradient_permille[late]) == pytest.approx(10.0, abs=1.3)
    assert np.std(estimate.gradient_permille[late]) < 1.0


def test_coasting_up_without_sensor_errors_is_exact() -> None:
    run = observe(drive(40.0, 30.0, lambda t: -0.03, gradient_permille=ramp(200.0, 100.0, 10.0)), imu=quiet_imu())
    estimate = run.estimate(orientation())
    assert np.mean(estimate.gradient_permille[estimate.t_s > 25.0]) == pytest.approx(10.0, abs=0.15)


def test_downhill_keeps_its_sign() -> None:
    run = observe(drive(40.0, 20.0, lambda t: -0.03, gradient_permille=ramp(200.0, 100.0, -25.0)), imu=preset_imu())
    estimate = run.estimate(orientation())
    assert np.mean(estimate.gradient_permille[estimate.t_s > 25.0]) == pytest.approx(-25.0, abs=1.5)


def test_printed_gravity_sign_settles_at_the_opposite_pitch(coasting_up: Run) -> None:
    estimate = coasting_up.estimate(orientation(gravity_sign="printed"))
    assert np.mean(estimate.gradient_permille[estimate.t_s > 40.0]) == pytest.approx(-9.0, abs=1.5)


def test_printed_z4_is_wrong_by_the_force_that_it_leaves_out(coasting_up: Run) -> None:
    """Coasting with 0.03 m/s2 of resistance: z4 = a misses f_x = -0.03, 3.1 per mille; the sound form does not."""
    estimate = coasting_up.estimate(orientation(z4="printed"))
    late = estimate.t_s > 40.0
    assert np.mean(estimate.gradient_permille[late]) == pytest.approx(10.0 + 1000.0 * 0.03 / 9.81, abs=0.8)


def test_braking_on_good_rail_does_not_show_as_gradient() -> None:
    run = observe(drive(40.0, 30.0, lambda t: -0.7 if t > 15.0 else 0.0), imu=preset_imu())
    estimate = run.estimate(orientation())
    assert np.max(np.abs(estimate.gradient_permille[estimate.t_s > 5.0])) < 3.0


def test_roll_and_yaw_follow_a_curve_with_cant() -> None:
    curve = total(ramp(300.0, 100.0, 1e-3), ramp(900.0, 100.0, -1e-3))
    cant = total(ramp(300.0, 100.0, 0.06), ramp(900.0, 100.0, -0.06))
    run = observe(drive(50.0, 30.0, lambda t: 0.0, curvature_radpm=curve, cant_rad=cant), imu=quiet_imu())
    estimate = run.estimate(orientation())
    assert np.max(np.abs(estimate.roll_rad - run.at(run.roll_rad, estimate.t_s))) < 0.006
    assert np.max(np.abs(estimate.yaw_rad - run.at(run.yaw_rad, estimate.t_s))) < 0.01
    assert np.min(estimate.roll_rad) == pytest.approx(-0.06, abs=0.004)  # the right rail is raised: left side down
    # The roll rate lags a tick behind in the transitions; what yaw rate then leaks into pitch is 2 per mille at most.
    assert np.max(np.abs(estimate.gradient_permille)) < 2.5


def test_sigma_ab_against_the_noise_of_the_wheels_acceleration() -> None:
    """Difference of two ticks: too rough to measure 10 per mille (0.098 m/s2) with. Slope over 1 s: good enough."""
    run = observe(drive(60.0, 33.0, lambda t: 0.0))
    speed = np.array([sample.axle_speed_mps[3] for sample in run.samples])
    window, slopes = WheelWindow(0.1, 1.0), []
    for sample, wheel in zip(run.samples, speed, strict=True):
        window.push(float(wheel), sample.specific_force_mps2, sample.angular_rate_radps)
        slopes.append(window.reading().wheel_acceleration_mps2)
    slopes_noise = float(np.nanstd(slopes))
    assert np.std(np.diff(speed)) / 0.1 > 0.1
    assert slopes_noise < 1.2 * slope_noise_mps2(float(np.std(speed)), 0.1, 11)
    # White per tick in the filter, in truth correlated over a window of 10: sqrt(10) makes the same information of it.
    assert slopes_noise * math.sqrt(10.0) < OrientationParameters().wheel_acceleration_sd_mps2 * 1.2


def test_wheel_and_force_of_the_window_belong_to_the_same_moment() -> None:
    """A jerk of 1 m/s3: window slope and window force agree to rounding, whatever the acceleration does."""
    window = WheelWindow(0.1, 1.0)
    for k in range(30):
        t = 0.1 * k
        mean_over_tick = t - 0.05  # of a = t over (t - 0.1, t]
        window.push(0.5 * t * t, np.array([mean_over_tick, 0.0, 0.0]), np.zeros(3))
    reading = window.reading()
    assert reading.wheel_acceleration_mps2 == pytest.approx(reading.specific_force_mps2[0], abs=1e-9)
    assert reading.wheel_acceleration_mps2 == pytest.approx(2.9 - reading.delay_s, abs=1e-9)


def test_innovations_of_the_gyro_are_white_and_of_the_predicted_size() -> None:
    """Level straight track, noise as the filter believes: innovations N(0, S), no correlation from tick to tick."""
    rng = np.random.default_rng(3)
    parameters = OrientationParameters(gyro_straight_sd_radps=7.8e-4)
    estimator = Orientation(parameters)
    estimator.reset(Initial(speed_mps=20.0))
    normalised = []
    for k in range(3000):
        sample = Sample(
            0.1 * (k + 1),
            np.full(4, 20.0),
            np.ones(4, bool),
            np.array([0.0, 0.0, 9.81]),
            7.8e-4 * rng.standard_normal(3),
        )
        estimator.step(sample)
        if k > 100:
            kalman = estimator.filter.kalman
            normalised.append(kalman.y[:3, 0] / np.sqrt(np.diag(kalman.S)[:3]))
    values = np.array(normalised)
    # The filter allows for real motion (Q), of which there is none here: its S is somewhat larger than the noise.
    assert np.all((np.std(values, axis=0) > 0.3) & (np.std(values, axis=0) < 1.05))
    assert np.all(np.abs(np.mean(values, axis=0)) < 0.05)
    pitch = values[:, 1]
    assert abs(np.mean(pitch[1:] * pitch[:-1]) / np.var(pitch)) < 0.5


@pytest.mark.parametrize("wrong", [{"z4": "other"}, {"gyro_sd_radps": 0.0}, {"wheelset": 5}, {"smoothing_s": math.nan}])
def test_wrong_parameters_are_refused_by_name(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        orientation(**wrong)
