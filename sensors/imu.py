"""The IMU mask: true motion of the carbody in, readings of a triaxial accelerometer and gyroscope out.

Order of the terms: motion of the sensing point (lever arm), mounting rotation, bandwidth, then scale factor, cross
axis, offset, drift, temperature curve and white noise, then quantisation, then saturation.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.signal import butter
from scipy.spatial.transform import Rotation

from sensors.imu_core import STATE_SIZE, process
from sensors.imu_parameters import AccelerometerParameters, GyroscopeParameters, ImuParameters
from sensors.random_streams import CONSTANT_TERM, DRIFT_TERM, IMU_SENSOR, WHITE_TERM, random_stream
from sensors.readings import ImuReadings, Kinematics
from sensors.streams import FloatArray


class Calibration(NamedTuple):
    """What the train believes of the IMU's mounting; it knows nothing of the yaw."""

    imu_roll_rad: float
    imu_pitch_rad: float


def mounting_rotation(roll_rad: float, pitch_rad: float, yaw_rad: float = 0.0) -> FloatArray:
    """Rotation matrix R_sb (3, 3) that turns carbody components into sensor components: Rx(roll) Ry(pitch) Rz(yaw)."""
    return Rotation.from_euler("XYZ", [roll_rad, pitch_rad, yaw_rad]).as_matrix()


def gravity_calibration(parameters: ImuParameters, rng: np.random.Generator) -> Calibration:
    """Roll and pitch of the mounting as found at a level standstill: the true angles and a normal residual each."""
    residual = parameters.calibration_residual_rad * rng.standard_normal(2)
    return Calibration(
        math.radians(parameters.mounting_roll_deg) + float(residual[0]),
        math.radians(parameters.mounting_pitch_deg) + float(residual[1]),
    )


class Imu:
    """One IMU over one run: feed it the truth in chunks of any length, in order; the readings do not depend on them.

    `truth_period_s` is the period of the kinematics; the first row gives the first reading. Raises ValueError where the
    output rate is no whole fraction of the truth's, or the bandwidth does not fit below half of it.
    """

    def __init__(self, parameters: ImuParameters, truth_period_s: float, seed: int) -> None:
        ratio = 1.0 / (parameters.rate_hz * truth_period_s)
        self._ratio = round(ratio)
        if self._ratio < 1 or abs(ratio - self._ratio) > 1e-6:
            raise ValueError(
                f"imu.rate_hz = {parameters.rate_hz}: no whole fraction of the truth's {1.0 / truth_period_s:g} Hz"
            )
        half_hz = 0.5 / truth_period_s
        if parameters.bandwidth_hz >= half_hz:
            raise ValueError(
                f"imu.bandwidth_hz = {parameters.bandwidth_hz}: must be below {half_hz:g}, half the truth's"
            )
        self._truth_period_s = truth_period_s
        self._last_s = math.nan
        self._rows = 0
        self._white = random_stream(seed, IMU_SENSOR, WHITE_TERM)
        self._drift = random_stream(seed, IMU_SENSOR, DRIFT_TERM)
        constant = random_stream(seed, IMU_SENSOR, CONSTANT_TERM)
        force, rate = parameters.accelerometer, parameters.gyroscope
        self._gain = np.array([_gain(triad, constant) for triad in (force, rate)])
        self._offset = np.array([[force.offset_mps2], [rate.offset_radps]]) * constant.uniform(-1.0, 1.0, (2, 3))
        period_s = self._ratio * truth_period_s
        self._terms = np.array(
            [
                _terms(
                    force.noise_density_mps2_per_rthz, force.drift_sd_mps2, force.drift_time_s,
                    force.resolution_mps2, force.range_mps2, period_s,
                ),
                _terms(
                    rate.noise_density_radps_per_rthz, rate.drift_sd_radps, rate.drift_time_s,
                    rate.resolution_radps, rate.range_radps, period_s,
                ),
            ]
        )  # fmt: skip
        bend, turn = force.temperature, rate.temperature
        self._curves = (
            np.array([bend.temperature_degc, bend.x_mps2, bend.y_mps2, bend.z_mps2]),
            np.array([turn.temperature_degc, turn.x_radps, turn.y_radps, turn.z_radps]),
        )
        self._profile = np.array([parameters.temperature.t_s, parameters.temperature.temperature_degc])
        numerator, denominator = butter(2, parameters.bandwidth_hz, fs=1.0 / truth_period_s)
        self._filter = np.concatenate([numerator, denominator[1:], [parameters.temperature_resolution_k]])
        self._lever_arm_m = np.array(parameters.lever_arm_m)
        self._rotation = mounting_rotation(
            math.radians(parameters.mounting_roll_deg),
            math.radians(parameters.mounting_pitch_deg),
            math.radians(parameters.mounting_yaw_deg),
        )
        self._state = np.zeros(STATE_SIZE)
        self._state[0] = math.nan

    def process(self, kinematics: Kinematics) -> ImuReadings:
        """Readings of the next chunk. Raises ValueError where its rows are not `truth_period_s` apart."""
        t_s = kinematics.t_s
        first = -self._rows % self._ratio
        readings = self.process_arrays(
            t_s,
            kinematics.specific_force_mps2,
            kinematics.angular_rate_radps,
            kinematics.angular_acceleration_radps2,
        )
        return ImuReadings(
            t_s=t_s[first :: self._ratio],
            specific_force_mps2=readings[:, :3],
            angular_rate_radps=readings[:, 3:6],
            temperature_degc=readings[:, 6],
        )

    def process_arrays(
        self,
        t_s: FloatArray,
        specific_force_mps2: FloatArray,
        angular_rate_radps: FloatArray,
        angular_acceleration_radps2: FloatArray,
    ) -> FloatArray:
        """As `process`, for chunks so short that records would cost more than the mask itself.

        Contiguous arrays as in Kinematics; readings (m, 7): specific force, angular rate, temperature.
        """
        if not self._follow(t_s):
            raise ValueError(f"Imu.process: rows must be {self._truth_period_s} s apart and follow the last chunk")
        first = -self._rows % self._ratio
        outputs = len(range(first, len(t_s), self._ratio))
        readings = process(
            t_s,
            specific_force_mps2,
            angular_rate_radps,
            angular_acceleration_radps2,
            self._lever_arm_m,
            self._rotation,
            self._filter,
            first,
            self._ratio,
            self._gain,
            self._offset,
            self._terms,
            self._profile,
            self._curves,
            self._white.standard_normal((outputs, 6)),
            self._drift.standard_normal((outputs, 6)),
            self._state,
        )
        if len(t_s):
            self._last_s = float(t_s[-1])
            self._rows += len(t_s)
        return readings

    def _follow(self, t_s: FloatArray) -> bool:
        """Whether rows at these times come next."""
        period_s = self._truth_period_s
        if self._rows and len(t_s) and abs(float(t_s[0]) - self._last_s - period_s) > 1e-6:
            return False
        return len(t_s) < 2 or bool(np.max(np.abs(np.diff(t_s) - period_s)) <= 1e-6)


def _gain(triad: AccelerometerParameters | GyroscopeParameters, rng: np.random.Generator) -> FloatArray:
    """Identity with scale factor errors on the diagonal and cross-axis coefficients beside it."""
    cross = triad.cross_axis_sd_share * rng.standard_normal((3, 3))
    np.fill_diagonal(cross, 1.0 + triad.scale_sd_share * rng.standard_normal(3))
    return cross


def _terms(
    density: float, drift_sd: float, drift_time_s: float, count: float, limit: float, period_s: float
) -> FloatArray:
    """White noise per sample, decay and drive of the drift per sample and its standard deviation, count, range."""
    drive = drift_sd * math.sqrt(-math.expm1(-2.0 * period_s / drift_time_s))
    return np.array([density / math.sqrt(period_s), math.exp(-period_s / drift_time_s), drive, drift_sd, count, limit])
