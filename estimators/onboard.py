"""Readings of a run made into what the on-board computer has at each of its ticks."""

import math
from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.interface import Sample
from sensors.readings import AxleSpeedReadings, BaliseReadings, ImuReadings
from sensors.streams import BoolArray, FloatArray

_TOLERANCE_S = 1e-6  # ticks and readings are multiples of periods, within rounding


def believed_rotation(imu_roll_rad: float, imu_pitch_rad: float) -> FloatArray:
    """Rotation matrix R_bs (3, 3) from the IMU's axes into the carbody's, as the train believes: the inverse of
    Rx(roll) Ry(pitch). The yaw of the mounting is unknown and stays as an error."""
    return Rotation.from_euler("XYZ", [imu_roll_rad, imu_pitch_rad, 0.0]).as_matrix().T


def samples(
    imu: ImuReadings,
    axle_speeds: AxleSpeedReadings,
    balises: BaliseReadings,
    period_s: float = 0.1,
    direction: int = 1,
) -> Iterator[Sample]:
    """Samples at `period_s`, `2 period_s`, ... as long as there are readings.

    IMU: mean over (t - period, t], in the sensor's axes; axle speeds: the last at or before t; balise: the last one
    passed in (t - period, t]. Raises ValueError where a tick has no IMU reading or no axle speed yet.
    """
    end_s = min(imu.t_s[-1], axle_speeds.t_s[-1]) if len(imu) and len(axle_speeds) else 0.0
    ticks = period_s * np.arange(0, math.floor((end_s + _TOLERANCE_S) / period_s) + 1)
    imu_row = np.searchsorted(imu.t_s, ticks + _TOLERANCE_S)
    speed_row = np.searchsorted(axle_speeds.t_s, ticks + _TOLERANCE_S) - 1
    balise_row = np.searchsorted(balises.t_s, ticks, side="right")
    for k in range(1, len(ticks)):
        if speed_row[k] < 0:
            raise ValueError(f"samples: no axle speed up to t = {ticks[k]:g} s")
        yield sample_of(
            float(ticks[k]),
            imu.rows(slice(imu_row[k - 1], imu_row[k])),
            axle_speeds.axle_speed_mps[speed_row[k]],
            axle_speeds.valid[speed_row[k]],
            balises.rows(slice(balise_row[k - 1], balise_row[k])),
            direction,
        )


def sample_of(
    t_s: float,
    imu: ImuReadings,
    axle_speed_mps: FloatArray,
    valid: BoolArray,
    balises: BaliseReadings,
    direction: int = 1,
) -> Sample:
    """The sample at a tick from what came since the tick before: IMU readings, axle speeds (4,) with their validity at
    the tick, balises. Raises ValueError without an IMU reading."""
    if not len(imu):
        raise ValueError(f"samples: no IMU reading up to t = {t_s:g} s, its rate is too low")
    passed = len(balises) > 0
    return Sample(
        t_s=t_s,
        axle_speed_mps=axle_speed_mps,
        valid=valid,
        specific_force_mps2=imu.specific_force_mps2.mean(axis=0),
        angular_rate_radps=imu.angular_rate_radps.mean(axis=0),
        balise_position_m=float(balises.position_m[-1]) if passed else math.nan,
        balise_age_s=float(t_s - balises.t_s[-1]) if passed else math.nan,
        direction=direction,
    )
