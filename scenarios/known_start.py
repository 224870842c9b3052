"""What a train knows when its estimators start."""

import math

import numpy as np

from estimators.interface import Initial
from scenarios.schema import Scenario
from sensors import CALIBRATION_TERM, IMU_SENSOR, AxleSpeedReadings, gravity_calibration, random_stream

START_SENSOR = 3
"""Number of the knowledge of the starting position in the spawn keys of the random streams."""

SPEED_SD_MPS = 0.5


def known_start(scenario: Scenario, t_s: float, position_m: float, axle_speeds: AxleSpeedReadings) -> Initial:
    """Its position as from a balise just read, its speed from the first reading of the tachometers, the IMU's roll and
    pitch from the gravity calibration, and nothing of the gradient."""
    seed = scenario.onboard_seed
    accuracy_m = scenario.balises.accuracy_m
    calibration = gravity_calibration(scenario.imu, random_stream(seed, IMU_SENSOR, CALIBRATION_TERM))
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
