"""INS/ODO: wheels while they roll, inertia while they slide, and bounds that hold."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from estimators import EstimateStream, Initial, InsOdo, InsOdoParameters, Sample, Scmt, ScmtParameters
from tests.estimators.synthetic_run import (
    Run,
    Slip,
    alike,
    drive,
    etcs_speed_limit_mps,
    low_adhesion_stop,
    observe,
    preset_imu,
    quiet_imu,
    ramp,
)

Array = NDArray[np.float64]


def ins_odo(**changes: object) -> InsOdo:
    return InsOdo(InsOdoParameters.model_validate(changes))


def speed_error(run: Run, estimate: EstimateStream) -> Array:
    return estimate.speed_mps - run.at(run.speed_mps, estimate.t_s)


def etcs_share(run: Run, estimate: EstimateStream) -> float:
    """Largest speed error as a share of the ETCS limit."""
    limit = etcs_speed_limit_mps(run.at(run.speed_mps, estimate.t_s))
    return float(np.max(np.abs(speed_error(run, estimate)) / limit))


SLIDES: dict[str, Slip] = {
    "swinging": alike(62.0, 0.15, 0.5, 2.5),
    "steady": alike(62.0, 0.2, 0.0),
    "slow": alike(62.0, 0.15, 0.8, 8.0),
    "locked": alike(62.0, 1.0, 0.0),
}


@pytest.mark.parametrize("slide", sorted(SLIDES))
def test_speed_stays_in_the_etcs_band_while_all_wheels_slide_alike(slide: str) -> None:
    run = low_adhesion_stop(SLIDES[slide])
    estimate = run.estimate(ins_odo())
    assert etcs_share(run, estimate) < 1.0
    assert etcs_share(run, run.estimate(Scmt(ScmtParameters()))) > 2.0
    standing = estimate.t_s > 120.0
    np.testing.assert_allclose(estimate.speed_mps[standing], 0.0, atol=1e-3)
    assert np.ptp(estimate.position_m[standing]) < 1e-2


def test_errors_over_sensor_seeds_are_consistent_with_the_bounds() -> None:
    """Within the band on nearly every board, and within the filter's own 3 sigma."""
    shares, outside, normalised = [], [], []
    for seed in range(20, 30):
        run = low_adhesion_stop(SLIDES["swinging"], seed)
        estimate = run.estimate(ins_odo())
        truth = run.at(run.speed_mps, estimate.t_s)
        shares.append(etcs_share(run, estimate))
        outside.append(np.mean((truth < estimate.speed_lower_mps) | (truth > estimate.speed_upper_mps)))
        sliding = (estimate.t_s > 64.0) & (estimate.t_s < 95.0)
        sd = (estimate.speed_upper_mps - estimate.speed_lower_mps) / 6.0
        normalised.append((speed_error(run, estimate) / sd)[sliding])
    assert np.mean(np.array(shares) < 1.0) > 0.9
    assert np.mean(outside) < 0.02
    rms = float(np.sqrt(np.mean(np.square(normalised))))
    assert 0.2 < rms < 1.5


def test_rolling_wheels_give_the_speed_without_bias() -> None:
    own = lambda t: -0.3 if t > 20.0 else 0.0  # noqa: E731
    run = observe(drive(60.0, 30.0, own, gradient_permille=ramp(300.0, 100.0, 8.0)), imu=preset_imu())
    error = speed_error(run, run.estimate(ins_odo()))[20:]
    assert abs(np.mean(error)) < 0.01
    assert np.std(error) < 0.03


def test_a_noise_only_imu_leaves_errors_of_mean_zero_in_a_slide() -> None:
    noise_only = quiet_imu().model_dump()
    noise_only["accelerometer"]["noise_density_mps2_per_rthz"] = 6.96e-4
    noise_only["gyroscope"]["noise_density_radps_per_rthz"] = 2.47e-4
    imu = type(quiet_imu()).model_validate(noise_only)
    at_75_s = []
    truth = drive(75.5, 33.0, lambda t: -0.6 if t > 60.0 else 0.0)
    for seed in range(40, 56):
        run = observe(truth, slip=alike(60.5, 0.2), imu=imu, seed=seed)
        at_75_s.append(speed_error(run, run.estimate(ins_odo()))[749])
    assert abs(np.mean(at_75_s)) < 3.0 * np.std(at_75_s) / 4.0 + 0.02
    assert np.std(at_75_s) < 0.25


def test_speed_is_never_reset_to_a_sliding_wheel() -> None:
    """Slip of 15 % kept steady for 40 s: the wheel agrees in acceleration, and is off in speed all the time."""
    run = low_adhesion_stop(alike(62.0, 0.15, 0.0))
    estimate = run.estimate(ins_odo())
    truth = run.at(run.speed_mps, estimate.t_s)
    wheel = run.at(run.wheel_mps[:, 3], estimate.t_s)
    sliding = (estimate.t_s > 64.0) & (truth - wheel > 1.0)
    assert np.all(np.abs(estimate.speed_mps - truth)[sliding] < 0.5 * (truth - wheel)[sliding])


def test_a_slide_that_creeps_in_is_noticed() -> None:
    """5 % of slip in 20 s: 0.08 m/s2 that eta_ad cannot see, but the speed of five seconds ago can."""

    def creeping(t: Array, v: Array) -> Array:
        course = 0.05 * np.clip((t - 62.0) / 20.0, 0.0, 1.0)
        return np.repeat(course[:, None], 4, axis=1)

    run = low_adhesion_stop(creeping)
    assert etcs_share(run, run.estimate(ins_odo())) < 1.0


def test_wheels_that_roll_again_are_trusted_again() -> None:
    def passing(t: Array, v: Array) -> Array:
        return np.where((t > 62.0) & (t < 75.0), 0.25, 0.0)[:, None] * np.ones((1, 4))

    def rolled(t: float) -> float:
        return -0.6 if 60.0 < t < 76.0 else -0.03

    run = observe(drive(100.0, 33.0, rolled), slip=passing, imu=preset_imu())
    estimator = ins_odo()
    estimator.reset(run.initial)
    trusted, error = [], []
    for sample in run.samples:
        estimate = estimator.step(sample)
        trusted.append(estimator.wheel_trusted)
        error.append(estimate.speed_mps - run.speed_mps[round(sample.t_s / 0.005)])
    t = np.array([sample.t_s for sample in run.samples])
    assert not np.any(np.array(trusted)[(t > 63.5) & (t < 74.5)])
    assert np.all(np.array(trusted)[(t > 80.0)])
    assert np.max(np.abs(np.array(error)[t > 80.0])) < 0.1


def test_a_free_wheel_is_believed_against_a_pitch_that_is_far_off() -> None:
    run = observe(drive(60.0, 25.0, lambda t: -0.02, gradient_permille=lambda s: 20.0), imu=preset_imu())
    wrong = dataclasses.replace(run.initial, pitch_rad=0.05, pitch_sd_rad=1e-3)
    estimate = run.estimate(ins_odo(), wrong)
    late = estimate.t_s > 30.0
    assert np.max(np.abs(speed_error(run, estimate)[late])) < 0.1
    assert np.mean(estimate.gradient_permille[late]) == pytest.approx(20.0, abs=2.0)


def test_standing_train_sits_still() -> None:
    run = observe(drive(60.0, 0.0, lambda t: 0.0), imu=preset_imu())
    estimate = run.estimate(ins_odo())
    late = estimate.t_s > 5.0
    assert np.max(np.abs(estimate.speed_mps[late])) < 1e-3
    assert np.ptp(estimate.position_m[late]) < 1e-3
    assert np.max(np.abs(estimate.acceleration_mps2[late])) < 1e-2


def test_locked_wheels_that_slide_downhill_evenly_are_no_standstill() -> None:
    """20 per mille down against a friction of 0.02 g: wheels at zero, no acceleration, 15 m/s."""
    own = lambda t: -0.196 if t > 15.0 else 0.0  # noqa: E731
    fall = ramp(100.0, 60.0, -20.0)
    run = observe(drive(50.0, 12.0, own, gradient_permille=fall), slip=alike(16.0, 1.0, 0.0), imu=preset_imu())
    error = speed_error(run, run.estimate(ins_odo()))
    assert np.max(np.abs(error)) < 0.6


@pytest.mark.parametrize(("slip", "slope_permille"), [(1.0, 0.0), (1.0, 10.0), (0.4, 10.0)])
def test_wheels_that_slide_almost_without_force_are_not_believed(slip: float, slope_permille: float) -> None:
    """Adhesion of 0.012: the IMU feels as little as of a coach that rolls freely."""
    own = lambda t: -0.118 if t > 30.0 else 0.0  # noqa: E731
    slope = ramp(200.0, 100.0, slope_permille)
    run = observe(drive(70.0, 30.0, own, gradient_permille=slope), slip=alike(31.0, slip, 0.0), imu=preset_imu())
    estimator = ins_odo()
    error = speed_error(run, run.estimate(estimator))
    assert not estimator.wheel_trusted
    assert np.max(np.abs(error)) < 0.8


def test_starting_from_a_standstill_follows_the_wheels() -> None:
    run = observe(drive(40.0, 0.0, lambda t: 0.5 if t > 10.0 else 0.0), imu=preset_imu())
    error = speed_error(run, run.estimate(ins_odo()))
    assert np.max(np.abs(error)) < 0.25
    assert np.max(np.abs(error[200:])) < 0.1


def test_reverse_travel_is_the_same_with_the_sign_turned() -> None:
    """A cab at the rear: wheels turn backward, the train brakes by pushing forward; all wheels slide."""
    forward = observe(drive(80.0, 30.0, lambda t: -0.6 if t > 30.0 else 0.0), slip=alike(31.0, 0.2), imu=quiet_imu())
    backward = [
        Sample(
            s.t_s,
            -s.axle_speed_mps,
            s.valid,
            s.specific_force_mps2 * np.array([-1.0, -1.0, 1.0]),
            s.angular_rate_radps * np.array([-1.0, -1.0, 1.0]),
            -s.balise_position_m,
            s.balise_age_s,
            -1,
        )
        for s in forward.samples
    ]
    one, other = ins_odo(), ins_odo()
    one.reset(forward.initial)
    other.reset(Initial(speed_mps=-30.0, position_sd_m=3.0, speed_sd_mps=0.3, direction=-1))
    for ahead, back in zip(forward.samples, backward, strict=True):
        assert other.step(back).speed_mps == pytest.approx(-one.step(ahead).speed_mps, abs=1e-6)


def test_a_lost_tachometer_leaves_inertial_navigation() -> None:
    run = observe(drive(60.0, 30.0, lambda t: -0.2), imu=preset_imu())
    estimator = ins_odo()
    estimator.reset(run.initial)
    for sample in run.samples:
        lost = Sample(sample.t_s, np.zeros(4), np.zeros(4, bool), sample.specific_force_mps2, sample.angular_rate_radps)
        estimate = estimator.step(lost if 20.0 < sample.t_s < 35.0 else sample)
        assert abs(estimate.speed_mps - run.speed_mps[round(sample.t_s / 0.005)]) < 0.3


def test_balises_correct_the_position() -> None:
    run = observe(drive(90.0, 30.0, lambda t: 0.0), imu=preset_imu(), rolling_radius_m=0.4586)
    with_balises = run.estimate(ins_odo())
    error = np.abs(with_balises.position_m - run.at(run.position_m, with_balises.t_s))
    assert np.max(error) < 12.0
    spread = with_balises.position_upper_m - with_balises.position_m
    assert np.mean(error < spread) > 0.98


def test_printed_balise_disturbs_the_speed_through_the_covariance() -> None:
    """1000 m are passed after 13 s of sliding: z3 = 0 pulls p back by 1000 m, and the speed goes with it."""
    run = observe(drive(50.0, 30.0, lambda t: -0.6 if t > 20.0 else 0.0), alike(22.0, 0.2), preset_imu())
    jumps = {}
    for form in ("sound", "printed"):
        error = speed_error(run, run.estimate(ins_odo(balise=form)))
        jumps[form] = float(np.max(np.abs(np.diff(error))[250:]))
    assert jumps["printed"] > 5.0
    assert jumps["sound"] < 0.5


def test_printed_adhesion_sign_blames_a_rolling_wheel_on_a_gradient() -> None:
    run = observe(drive(60.0, 30.0, lambda t: 0.0, gradient_permille=ramp(300.0, 200.0, 20.0)), imu=quiet_imu())
    distrusted = {}
    for sign in ("sound", "printed"):
        estimator = ins_odo(adhesion_sign=sign)
        estimator.reset(run.initial)
        distrusted[sign] = 0
        for sample in run.samples:
            estimator.step(sample)
            distrusted[sign] += not estimator.wheel_trusted
    assert distrusted["sound"] == 0
    assert distrusted["printed"] > 100


@pytest.mark.parametrize("wrong", [{"balise": "none"}, {"lookback_s": 0.0}, {"orientation": {"z4": 1}}, {"eta_v": 1.0}])
def test_wrong_parameters_are_refused_by_name(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        ins_odo(**wrong)
