"""A short memory of wheel speed and IMU, to compare accelerations that belong to the same moment.

The slope of a wheel's speed between two ticks is far too rough to measure gravity with (see `slope_noise_mps2`), so the
acceleration is the least-squares slope over a window. That slope is a weighted mean of the accelerations within, with
weights that form a parabola; the same weights on the accelerometer give a specific force of the same moment, and what
is left of their difference is gravity, whatever the jerk.
"""

import dataclasses
import math
from collections import deque

import numpy as np

from sensors.streams import FloatArray


def slope_noise_mps2(speed_sd_mps: float, period_s: float, speeds: int) -> float:
    """Standard deviation of the least-squares slope over a number of speeds: sd / (T sqrt((n^3 - n)/12))."""
    return speed_sd_mps / (period_s * math.sqrt((speeds**3 - speeds) / 12.0))


@dataclasses.dataclass(frozen=True, slots=True)
class WindowReading:
    """Wheel acceleration (nan without valid wheel), specific force (3,) of the same moment `delay_s` ago, mean rate."""

    wheel_acceleration_mps2: float
    specific_force_mps2: FloatArray
    angular_rate_radps: FloatArray
    delay_s: float


class WheelWindow:
    """The last ticks: wheel speeds, specific forces and angular rates (carbody axes)."""

    def __init__(self, period_s: float, smoothing_s: float) -> None:
        intervals = max(round(smoothing_s / period_s), 1)
        self._delay_s = 0.5 * intervals * period_s
        place = np.arange(intervals + 1) - 0.5 * intervals
        self._slope = place / (period_s * float(np.sum(place**2)))
        self._weights = period_s * np.cumsum(self._slope[::-1])[::-1][1:]
        self._speeds: deque[float] = deque(maxlen=intervals + 1)
        self._forces: deque[FloatArray] = deque(maxlen=intervals)
        self._rates: deque[FloatArray] = deque(maxlen=intervals)

    def push(self, speed_mps: float, specific_force_mps2: FloatArray, angular_rate_radps: FloatArray) -> None:
        """The next tick; a nan speed (no valid wheel) leaves the window without slope until it has passed through."""
        self._speeds.append(speed_mps)
        self._forces.append(specific_force_mps2)
        self._rates.append(angular_rate_radps)

    def reading(self) -> WindowReading:
        """What the window shows now; a plain mean of the forces while it fills."""
        full = len(self._speeds) == len(self._slope)
        forces = np.array(self._forces)
        return WindowReading(
            wheel_acceleration_mps2=float(self._slope @ np.array(self._speeds)) if full else math.nan,
            specific_force_mps2=self._weights @ forces if len(forces) == len(self._weights) else forces.mean(axis=0),
            angular_rate_radps=np.array(self._rates).mean(axis=0),
            delay_s=self._delay_s,
        )
