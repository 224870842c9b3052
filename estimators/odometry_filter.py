"""INS/ODO Kalman filter of Malvezzi et al. 2014 along the track: state [p, v, a], constant acceleration.

z = [gravity-compensated acceleration, wheel speed, balise position], H = [[0,0,1],[0,1,0],[1,0,0]]; rows without a
reading are left out. The noise of the source is white; what goes wrong in practice is not: a pitch that is off stays
off, and so does a wheel radius. So the variance of the speed grows by (sd + d)^2 - sd^2 with d = sd_acceleration Ts
each tick, that of the position likewise with the radius, and the bounds keep their word over a long slide.
"""

import math

import numpy as np
from filterpy.kalman import KalmanFilter

from estimators.interface import Initial
from sensors.streams import FloatArray

P, V, A = 0, 1, 2


class OdometryFilter:
    """Position, speed and acceleration along the track with their covariance."""

    def __init__(self, period_s: float, acceleration_walk_mps2_per_rts: float) -> None:
        ts = period_s
        self._period_s = period_s
        self.kalman = KalmanFilter(dim_x=3, dim_z=3)
        self.kalman.F = np.array([[1.0, ts, 0.5 * ts**2], [0.0, 1.0, ts], [0.0, 0.0, 1.0]])
        self._noise: FloatArray = acceleration_walk_mps2_per_rts**2 * np.array(
            [
                [ts**5 / 20.0, ts**4 / 8.0, ts**3 / 6.0],
                [ts**4 / 8.0, ts**3 / 3.0, ts**2 / 2.0],
                [ts**3 / 6.0, ts**2 / 2.0, ts],
            ]
        )

    def reset(self, initial: Initial) -> None:
        """Start from believed position and speed."""
        self.kalman.x = np.array([[initial.position_m], [initial.speed_mps], [0.0]])
        self.kalman.P = np.diag([initial.position_sd_m**2, initial.speed_sd_mps**2, 1.0])

    @property
    def position_m(self) -> float:
        return float(self.kalman.x[P, 0])

    @property
    def speed_mps(self) -> float:
        return float(self.kalman.x[V, 0])

    @property
    def acceleration_mps2(self) -> float:
        return float(self.kalman.x[A, 0])

    @property
    def position_sd_m(self) -> float:
        return math.sqrt(float(self.kalman.P[P, P]))

    @property
    def speed_sd_mps(self) -> float:
        return math.sqrt(float(self.kalman.P[V, V]))

    def predict(self, acceleration_sd_mps2: float, speed_share: float) -> None:
        """One tick on. Lasting errors: of the acceleration that is integrated, and of the speed as a share of it."""
        noise = self._noise.copy()
        dv = acceleration_sd_mps2 * self._period_s
        noise[V, V] += dv * (2.0 * self.speed_sd_mps + dv)
        dp = speed_share * abs(self.speed_mps) * self._period_s
        noise[P, P] += dp * (2.0 * self.position_sd_m + dp)
        self.kalman.predict(Q=noise)

    def update(self, rows: list[tuple[int, float, float]]) -> None:
        """Observations of this tick: (state observed, value, standard deviation) each."""
        pattern = np.zeros((len(rows), 3))
        pattern[np.arange(len(rows)), [state for state, _, _ in rows]] = 1.0
        z = np.array([[value] for _, value, _ in rows])
        self.kalman.update(z, R=np.diag([sd**2 for _, _, sd in rows]), H=pattern)
