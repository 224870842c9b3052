"""Samples from readings, estimates as records, and what `Initial` refuses."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators import ESTIMATORS, EstimateStream, Initial, samples
from estimators.onboard import believed_rotation
from sensors import AxleSpeedReadings, BaliseReadings, ImuReadings, columns, mounting_rotation


def readings(rate_hz: float = 100.0, n: int = 101) -> tuple[ImuReadings, AxleSpeedReadings, BaliseReadings]:
    t_s = np.arange(n) / rate_hz
    imu = ImuReadings(
        t_s=t_s,
        specific_force_mps2=np.outer(t_s, [1.0, 2.0, 3.0]),
        angular_rate_radps=np.zeros((n, 3)),
        temperature_degc=np.zeros(n),
    )
    ticks = 0.01 * np.arange(101)
    speeds = AxleSpeedReadings(t_s=ticks, axle_speed_mps=np.outer(ticks, np.ones(4)), valid=np.ones((101, 4), bool))
    return imu, speeds, BaliseReadings(t_s=[0.25, 0.30], position_m=[7.0, 8.0])


def test_a_sample_holds_the_mean_over_its_tick_and_the_speed_at_its_end() -> None:
    ticks = list(samples(*readings()))
    assert [round(sample.t_s, 9) for sample in ticks] == [round(0.1 * k, 9) for k in range(1, 11)]
    middle_s = np.mean(0.41 + 0.01 * np.arange(10))
    np.testing.assert_allclose(ticks[4].specific_force_mps2, np.array([1.0, 2.0, 3.0]) * middle_s)
    np.testing.assert_allclose(ticks[4].axle_speed_mps, 0.5)


def test_a_balise_belongs_to_the_tick_in_which_it_was_passed() -> None:
    ticks = list(samples(*readings()))
    heard = [k for k, sample in enumerate(ticks) if not math.isnan(sample.balise_position_m)]
    assert heard == [2]  # both in (0.2, 0.3]: the later one counts
    assert ticks[2].balise_position_m == 8.0
    assert ticks[2].balise_age_s == pytest.approx(0.0, abs=1e-9)


def test_an_imu_slower_than_the_estimator_is_refused() -> None:
    with pytest.raises(ValueError, match="IMU"):
        list(samples(*readings(rate_hz=5.0, n=6)))


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_believed_rotation_undoes_the_mounting_but_for_the_yaw(roll: float, pitch: float, yaw: float) -> None:
    left = believed_rotation(roll, pitch) @ mounting_rotation(roll, pitch, yaw)
    np.testing.assert_allclose(left, mounting_rotation(0.0, 0.0, yaw), atol=1e-12)


@pytest.mark.parametrize("wrong", [{"speed_mps": math.nan}, {"position_sd_m": 0.0}, {"direction": 0}])
def test_initial_refuses_by_name(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Initial(**wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(ESTIMATORS))
def test_every_estimator_answers_every_sample_and_starts_anew_on_reset(name: str) -> None:
    estimator = ESTIMATORS[name](ESTIMATORS[name].Parameters())
    ticks = list(samples(*readings()))
    answers = []
    for _ in range(2):
        estimator.reset(Initial(speed_mps=0.0))
        answers.append(EstimateStream.of(estimator.step(sample) for sample in ticks))
    assert len(answers[0]) == len(ticks)
    for first, again in zip(columns(answers[0]), columns(answers[1]), strict=True):
        assert first.values.tobytes() == again.values.tobytes()


@pytest.mark.parametrize("name", sorted(ESTIMATORS))
def test_parameters_refuse_unknown_keys(name: str) -> None:
    with pytest.raises(ValueError, match="colour"):
        ESTIMATORS[name].Parameters(colour="red")
