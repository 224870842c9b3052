"""Orientation Kalman filter of Malvezzi et al. 2014: roll, pitch and yaw from gyroscope, wheel and accelerometer.

State [psi, psi', theta, theta', phi, phi'], an angle and its rate for roll, pitch, yaw; each rate a random walk.
Observed are the three gyro rates, z4, a roll of zero, and while the gradient is steady (`steady_gradient`) a pitch rate
of zero; the rows of the rates are evaluated at the predicted angles. R adapts.

In our axes theta > 0 is nose down and the body sees gravity g sin(theta) along x, so that
    wheel acceleration - f_x = +g theta,
which is row 4 in its sound form: true whenever the wheel rolls, wrong by no more than the accelerometer's bias over g.
The forms printed in the source are kept by name: `z4 = "printed"` takes the wheel acceleration alone, while coasting
only; `gravity_sign = "printed"` puts -g into row 4, which with these gyro rows settles at the opposite pitch.
"""

import math
from typing import Literal

import numpy as np
from filterpy.kalman import KalmanFilter
from pydantic import BaseModel, ConfigDict, Field

from estimators.interface import Initial
from estimators.steady_gradient import SteadyGradient
from estimators.wheel_window import WindowReading
from sensors.streams import FloatArray

GRAVITY_MPS2 = 9.81

_CURVE_S = 30.0  # how long the lateral force of a curve lasts, in order of magnitude
_HELD_SD_RADPS, _FREE_SD_RADPS = 1e-5, 1e3

PSI, THETA, THETA_RATE, PHI = 0, 2, 3, 4


class OrientationParameters(BaseModel):
    """Tuning; the defaults suit the low-cost board of the source at 10 Hz.

    The wheel acceleration's figure belongs to white noise per tick. The slope over `smoothing_s` has about 0.014 m/s2
    for speeds good to 15 mm/s, and stays correlated over the window's 10 ticks: times sqrt(10).
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    period_s: float = Field(default=0.1, gt=0.0, le=1.0)
    z4: Literal["sound", "printed"] = "sound"
    gravity_sign: Literal["sound", "printed"] = "sound"
    wheelset: int = Field(default=4, ge=1, le=4, description="the last one runs on the cleanest rail")
    smoothing_s: float = Field(default=1.0, gt=0.0, le=10.0, description="window of the wheel's acceleration")

    # Process: random walk of each rate, as its density.
    roll_rate_walk_radps_per_rts: float = Field(default=1e-2, gt=0.0)
    pitch_rate_walk_radps_per_rts: float = Field(default=1e-3, gt=0.0)
    yaw_rate_walk_radps_per_rts: float = Field(default=1e-2, gt=0.0)

    # R, trusted and distrusted.
    gyro_sd_radps: float = Field(default=7.8e-4, gt=0.0)
    gyro_distrusted_sd_radps: float = Field(default=1.0, gt=0.0, description="sigma_wy beside a trusted printed z4")
    gyro_straight_sd_radps: float = Field(
        default=2e-3, gt=0.0, description="sigma_wx on straight track; a curve's first metres of roll must not be lost"
    )
    wheel_acceleration_sd_mps2: float = Field(default=0.05, gt=0.0, description="sigma_ab, adhesion good")
    wheel_acceleration_loaded_sd_mps2: float = Field(default=0.25, gt=0.0, description="the same, braking or driving")
    wheel_acceleration_distrusted_sd_mps2: float = Field(default=1e3, gt=0.0)
    mounting_yaw_sd_rad: float = Field(default=0.035, ge=0.0, description="yaw of the IMU's mounting, unknown")
    roll_reset_sd_rad: float = Field(default=0.01, gt=0.0, description="sigma_0 on straight track")
    roll_reset_distrusted_sd_rad: float = Field(default=1e2, gt=0.0)

    # Thresholds on means over the window.
    coasting_force_mps2: float = Field(default=0.1, gt=0.0, description="eta_fx: below it no traction and no brake")
    straight_force_mps2: float = Field(default=0.15, gt=0.0, description="eta_fy")
    straight_roll_rate_radps: float = Field(default=2e-3, gt=0.0, description="eta_wx")
    straight_yaw_rate_radps: float = Field(default=1.5e-3, gt=0.0, description="eta_wz")

    # Adhesion, where nobody else judges it.
    adhesion_acceleration_mps2: float = Field(default=0.2, gt=0.0, description="eta_ad")
    confirmation_s: float = Field(default=1.0, ge=0.0, description="agreement before a wheel is trusted again")


class OrientationFilter:
    """The filter itself, on carbody axes; who drives it says whether the wheel may be trusted."""

    def __init__(self, parameters: OrientationParameters) -> None:
        self.parameters = parameters
        ts = parameters.period_s
        block = np.array([[ts**3 / 3.0, ts**2 / 2.0], [ts**2 / 2.0, ts]])
        walks = (
            parameters.roll_rate_walk_radps_per_rts,
            parameters.pitch_rate_walk_radps_per_rts,
            parameters.yaw_rate_walk_radps_per_rts,
        )
        self.kalman = KalmanFilter(dim_x=6, dim_z=6)
        self.kalman.F = np.kron(np.eye(3), np.array([[1.0, ts], [0.0, 1.0]]))
        self.kalman.Q = np.kron(np.diag(np.square(walks)), block)
        self._steady = SteadyGradient(ts, parameters.gyro_sd_radps)
        self._gravity = GRAVITY_MPS2 if parameters.gravity_sign == "sound" else -GRAVITY_MPS2

    def reset(self, initial: Initial) -> None:
        """Start from the believed pitch; level across, yaw counted from here."""
        self.kalman.x = np.zeros((6, 1))
        self.kalman.x[THETA, 0] = initial.pitch_rad
        self._steady.restart()
        self.kalman.P = np.diag([0.05**2, 0.01**2, initial.pitch_sd_rad**2, 0.01**2, 1e-8, 0.01**2])

    @property
    def roll_rad(self) -> float:
        return float(self.kalman.x[PSI, 0])

    @property
    def pitch_rad(self) -> float:
        return float(self.kalman.x[THETA, 0])

    @property
    def yaw_rad(self) -> float:
        return float(self.kalman.x[PHI, 0])

    @property
    def pitch_sd_rad(self) -> float:
        return math.sqrt(float(self.kalman.P[THETA, THETA]))

    @property
    def gravity_x_mps2(self) -> float:
        """(R_nb g)_x, the gravity seen along the carbody's x: +9.81 sin(theta)."""
        return GRAVITY_MPS2 * math.sin(self.pitch_rad)

    def gravity_x_before_mps2(self, delay_s: float) -> float:
        """The same, a delay ago."""
        return GRAVITY_MPS2 * math.sin(self.pitch_rad - delay_s * float(self.kalman.x[THETA_RATE, 0]))

    def doubt_pitch(self, angle_rad: float) -> None:
        """Take the pitch to be off by about this angle."""
        self.kalman.P[THETA, THETA] += angle_rad**2

    def disagreement_mps2(self, window: WindowReading) -> float:
        """By how much wheel acceleration minus f_x misses row 4; nan without wheel."""
        expected = self._gravity * (self.pitch_rad - window.delay_s * float(self.kalman.x[THETA_RATE, 0]))
        return window.wheel_acceleration_mps2 - float(window.specific_force_mps2[0]) - expected

    def step(self, angular_rate_radps: FloatArray, window: WindowReading, wheel_trusted: bool) -> None:
        """Predict over a tick and update with the rates at its end (3,) and the wheel window that ends there."""
        parameters = self.parameters
        self.kalman.predict()
        psi, theta = float(self.kalman.x[PSI, 0]), float(self.kalman.x[THETA, 0])
        acceleration = window.wheel_acceleration_mps2
        force, rate = window.specific_force_mps2, window.angular_rate_radps
        gyro, distrusted = parameters.gyro_sd_radps, parameters.gyro_distrusted_sd_radps

        pitch_rate = float(angular_rate_radps[1]) * math.cos(psi) - float(angular_rate_radps[2]) * math.sin(psi)
        sd_pitch_rate, sd_wheel, z4, delay_s = gyro, parameters.wheel_acceleration_distrusted_sd_mps2, 0.0, 0.0
        held = False
        if parameters.z4 == "sound":
            if wheel_trusted:
                self._steady.restart()
            else:
                self._turn_back(self._steady.step(pitch_rate))
                held = self._steady.holds
            if wheel_trusted and not math.isnan(acceleration):
                # Both are right at once: the gyro carries the quick part, the wheel the slow one. In a curve the
                # unknown yaw of the mounting lets lateral force into f_x, for as long as the curve lasts.
                leak = parameters.mounting_yaw_sd_rad * abs(float(force[1])) * math.sqrt(_CURVE_S / parameters.period_s)
                # A wheel that transmits force may begin to slide, slowly: gravity is best learned from a free one.
                loaded = abs(float(force[0])) > parameters.coasting_force_mps2
                sd_wheel = math.hypot(
                    parameters.wheel_acceleration_loaded_sd_mps2 if loaded else parameters.wheel_acceleration_sd_mps2,
                    leak,
                )
                z4, delay_s = acceleration - float(force[0]), window.delay_s
        elif abs(force[0]) < parameters.coasting_force_mps2 and not math.isnan(acceleration):
            sd_pitch_rate, sd_wheel, z4 = distrusted, parameters.wheel_acceleration_sd_mps2, acceleration

        # The tick's own rates end a straight at once, by twice the threshold for their noise; the window begins one.
        straight = (
            abs(force[1]) < parameters.straight_force_mps2
            and abs(rate[0]) < parameters.straight_roll_rate_radps
            and abs(rate[2]) < parameters.straight_yaw_rate_radps
            and abs(angular_rate_radps[0]) < 2.0 * parameters.straight_roll_rate_radps
            and abs(angular_rate_radps[2]) < 2.0 * parameters.straight_yaw_rate_radps
        )
        if held:
            sd_pitch_rate = distrusted
        sd_roll_rate = parameters.gyro_straight_sd_radps if straight else gyro
        sd_roll = parameters.roll_reset_sd_rad if straight else parameters.roll_reset_distrusted_sd_rad

        g = self._gravity
        sin_psi, cos_psi, sin_theta, cos_theta = math.sin(psi), math.cos(psi), math.sin(theta), math.cos(theta)
        rows = np.array(
            [
                [0.0, 1.0, 0.0, 0.0, 0.0, -sin_theta],
                [0.0, 0.0, 0.0, cos_psi, 0.0, cos_theta * sin_psi],
                [0.0, 0.0, 0.0, -sin_psi, 0.0, cos_theta * cos_psi],
                [0.0, 0.0, g, -g * delay_s, 0.0, 0.0],  # the window's moment is half its length ago
                [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            ]
        )
        z = np.array([[*angular_rate_radps, z4, 0.0, 0.0]]).T
        sd_held = _HELD_SD_RADPS if held else _FREE_SD_RADPS
        sd = np.array([sd_roll_rate, sd_pitch_rate, gyro, sd_wheel, sd_roll, sd_held])
        self.kalman.update(z, R=np.diag(sd**2), H=rows)
        if held:  # the covariance takes no credit for holding: a slow turn may go unnoticed
            self.kalman.P[THETA, THETA] += (gyro * parameters.period_s) ** 2

    def _turn_back(self, angle_rad: float) -> None:
        """Put back a turn that was held: the pitch rate goes with it by the next rows."""
        if angle_rad != 0.0:
            self.kalman.x = self.kalman.x + np.array([[0.0, 0.0, angle_rad, 0.0, 0.0, 0.0]]).T
