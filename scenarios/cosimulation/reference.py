"""An estimator in the loop: its speed is the outside reference of the wheel slide protection."""

import math

import numpy as np

from estimators.onboard import sample_of
from scenarios.known_start import known_start
from scenarios.schema import Scenario
from sensors import AxleSpeedReadings, Balises, Imu, Kinematics


class EstimatedReference:
    """Feeds an estimator as the run goes, tick by tick, with what the sensors on board give.

    It sees the sample of t_k at tick k+1: its answer is one tick old when a controller first reads it, and goes on by
    the estimated acceleration until the next. Readings, and so estimates, are those that `scenarios.observe` gets from
    the same run afterwards.
    """

    def __init__(self, scenario: Scenario, name: str) -> None:
        self._scenario = scenario
        seed = scenario.onboard_seed
        self._estimator = scenario.make_estimators()[name]
        self._imu = Imu(scenario.imu, scenario.simulation.record_period_s, seed)
        self._balises = Balises(scenario.balises, seed)
        self._next_s = math.nan
        self._last_row: np.ndarray | None = None
        self._speed_mps, self._acceleration_mps2, self._since_s = math.nan, 0.0, 0.0

    def at(self, t_s: float) -> float:
        """The reference speed at a tick, m/s; nan as long as there is none."""
        return self._speed_mps + self._acceleration_mps2 * (t_s - self._since_s)

    def due(self, tick_s: float) -> bool:
        """Whether the estimator has a tick at `tick_s`, or has yet to begin."""
        return not tick_s < self._next_s - 1e-6

    def step(self, tick_s: float, rows: np.ndarray, axle_speed_mps: np.ndarray, valid: np.ndarray) -> None:
        """The estimator's tick at `tick_s`: what was recorded since the last one (`rows`, dtype OBSERVATION, the last
        of `tick_s`), axle speeds and validity (4,) at it."""
        readings = self._imu.process(
            Kinematics(
                t_s=rows["t_s"].copy(),
                specific_force_mps2=rows["specific_force_mps2"].copy(),
                angular_rate_radps=rows["angular_rate_radps"].copy(),
                angular_acceleration_radps2=rows["angular_acceleration_radps2"].copy(),
            )
        )
        if self._last_row is None:
            self._begin(rows, axle_speed_mps, valid)
        else:
            path = np.concatenate([self._last_row, rows])
            sample = sample_of(
                tick_s,
                readings,
                axle_speed_mps,
                valid,
                self._balises.passed(path["t_s"], path["position_m"]),
            )
            estimate = self._estimator.step(sample)
            if estimate.valid and math.isfinite(estimate.speed_mps):
                acceleration = estimate.acceleration_mps2
                self._speed_mps, self._since_s = estimate.speed_mps, tick_s
                self._acceleration_mps2 = acceleration if math.isfinite(acceleration) else 0.0
        self._last_row = rows[-1:].copy()
        self._next_s = tick_s + self._estimator.period_s

    def _begin(self, rows: np.ndarray, axle_speed_mps: np.ndarray, valid: np.ndarray) -> None:
        first = AxleSpeedReadings(
            t_s=rows["t_s"][:1].copy(), axle_speed_mps=axle_speed_mps[None].copy(), valid=valid[None].copy()
        )
        self._estimator.reset(known_start(self._scenario, float(rows["t_s"][0]), float(rows["position_m"][0]), first))
