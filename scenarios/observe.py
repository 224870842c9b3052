"""From truth to estimates: masks make readings, the on-board computer samples them, estimators answer."""

import math
from dataclasses import dataclass

import numpy as np

from estimators.interface import EstimateStream, Initial, Sample
from estimators.onboard import samples
from scenarios.schema import Scenario
from scenarios.truth import Truth
from sensors import (
    CALIBRATION_TERM,
    IMU_SENSOR,
    AxleSpeedReadings,
    BaliseReadings,
    Balises,
    Calibration,
    Imu,
    ImuReadings,
    Kinematics,
    gravity_calibration,
    random_stream,
)

START_SENSOR = 3
"""Number of the knowledge of the starting position in the spawn keys of the random streams."""

SPEED_SD_MPS = 0.5


@dataclass(frozen=True)
class Observation:
    """What the sensors gave beside the tachometers in the loop, and what each estimator made of it."""

    imu: ImuReadings
    balises: BaliseReadings
    estimates: dict[str, EstimateStream]


def observe(scenario: Scenario, truth: Truth) -> Observation:
    """Readings and estimates of a run. Everything random here hangs on the sensor seed alone."""
    seed = scenario.scenario.sensor_seed
    motion = truth.motion
    kinematics = Kinematics(
        t_s=motion.t_s,
        specific_force_mps2=motion.specific_force_mps2,
        angular_rate_radps=motion.angular_rate_radps,
        angular_acceleration_radps2=motion.angular_acceleration_radps2,
    )
    imu = Imu(scenario.imu, scenario.simulation.record_period_s, seed).process(kinematics)
    balises = Balises(scenario.balises, seed).passed(motion.t_s, motion.position_m)
    initial = known_start(
        float(motion.t_s[0]),
        float(motion.position_m[0]),
        scenario.balises.accuracy_m,
        truth.axle_speeds,
        gravity_calibration(scenario.imu, random_stream(seed, IMU_SENSOR, CALIBRATION_TERM)),
        seed,
    )
    estimates = {}
    sampled: dict[float, list[Sample]] = {}
    for name, estimator in scenario.make_estimators().items():
        period_s = estimator.period_s
        if period_s not in sampled:
            sampled[period_s] = list(samples(imu, truth.axle_speeds, balises, period_s))
        estimator.reset(initial)
        estimates[name] = EstimateStream.of(map(estimator.step, sampled[period_s]))
    return Observation(imu, balises, estimates)


def known_start(
    t_s: float,
    position_m: float,
    accuracy_m: float,
    axle_speeds: AxleSpeedReadings,
    calibration: Calibration,
    seed: int,
) -> Initial:
    """What a train knows when its estimators start: its position as from a balise just read, its speed from the
    tachometers, the IMU's roll and pitch from the gravity calibration, and nothing of the gradient.
    """
    error_m = random_stream(seed, START_SENSOR, 0).uniform(-accuracy_m, accuracy_m)
    first = axle_speeds.rows(slice(0, 1))
    seen = first.axle_speed_mps[first.valid]
    return Initial(
        t_s=t_s,
        position_m=position_m + error_m,
        position_sd_m=max(accuracy_m / math.sqrt(3.0), 0.1),
        speed_mps=float(np.median(seen)) if len(seen) else 0.0,
        speed_sd_mps=SPEED_SD_MPS,
        imu_roll_rad=calibration.imu_roll_rad,
        imu_pitch_rad=calibration.imu_pitch_rad,
    )
