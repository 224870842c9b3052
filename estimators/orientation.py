"""Estimator `orientation`: the orientation filter by itself, with its own judgement of adhesion."""

import math

from estimators.confirmation import Confirmation
from estimators.interface import Estimate, Initial, Sample
from estimators.onboard import believed_rotation
from estimators.orientation_filter import GRAVITY_MPS2, OrientationFilter, OrientationParameters
from estimators.wheel_window import WheelWindow

_SIGMAS = 4.0  # how far gravity may be off by the filter's own account before a wheel is blamed


class Orientation:
    """Roll, pitch, yaw and gradient; acceleration as f_x + (R_nb g)_x; no speed or position.

    The wheel is trusted while its acceleration agrees with the accelerometer's within eta_ad; after a disagreement only
    once they have agreed for `confirmation_s`.
    """

    Parameters = OrientationParameters

    def __init__(self, parameters: OrientationParameters) -> None:
        self.parameters = parameters
        self.period_s = parameters.period_s
        self.filter = OrientationFilter(parameters)
        self.reset(Initial())

    def reset(self, initial: Initial) -> None:
        """Start anew."""
        self._rotation = believed_rotation(initial.imu_roll_rad, initial.imu_pitch_rad)
        self._window = WheelWindow(self.period_s, self.parameters.smoothing_s)
        self._confirmation = Confirmation(self.period_s, self.parameters.confirmation_s)
        self._trusted = True
        self.filter.reset(initial)

    def step(self, sample: Sample) -> Estimate:
        """One tick."""
        force = self._rotation @ sample.specific_force_mps2
        rate = self._rotation @ sample.angular_rate_radps
        wheel = self.parameters.wheelset - 1
        self._window.push(float(sample.axle_speed_mps[wheel]) if sample.valid[wheel] else math.nan, force, rate)
        window = self._window.reading()
        margin = max(self.parameters.adhesion_acceleration_mps2, _SIGMAS * GRAVITY_MPS2 * self.filter.pitch_sd_rad)
        agrees = abs(self.filter.disagreement_mps2(window)) < margin  # without wheel that is nan: no agreement
        self._trusted = self._confirmation.agreed(agrees) or (self._trusted and agrees)
        self.filter.step(rate, window, self._trusted)
        return Estimate(
            t_s=sample.t_s,
            position_m=math.nan,
            position_lower_m=math.nan,
            position_upper_m=math.nan,
            speed_mps=math.nan,
            speed_lower_mps=math.nan,
            speed_upper_mps=math.nan,
            acceleration_mps2=float(force[0]) + self.filter.gravity_x_mps2,
            gradient_permille=-1000.0 * math.tan(self.filter.pitch_rad),
            roll_rad=self.filter.roll_rad,
            pitch_rad=self.filter.pitch_rad,
            yaw_rad=self.filter.yaw_rad,
            direction=sample.direction,
            valid=True,
        )
