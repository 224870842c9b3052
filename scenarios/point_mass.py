"""The longitudinal simulator of M. E. Lemma's thesis: a point mass on a line, the reduced model of the coach.

    a = (F - W m g/1000)/((1 + rho) m) - g sin(atan(i/1000))/(1 + rho),   W = r0 + r1 V + r2 V^2 in N/kN, V in km/h,

with the force F over time, the gradient i (per mille) given each 100 m and the curve radius R each 50 m, the resistance
W zero at standstill, and the speed clipped to 0..v_max. The acceleration put out is that of the clipped speed. Two
models by name:

- `point-mass`: resistance of the 56 t coach, the wheels' rotation rho, and the specific force that an accelerometer
  feels, a + g sin(atan(i/1000)) along the track;
- `point-mass-as-printed`: resistance as printed (r1 = 0.7 per km/h, far above any real train), no rotation, and a
  longitudinal channel that is g sin(atan(i/1000)) at standstill and at v_max and the kinematic acceleration otherwise,
  so that it jumps and is without gravity on a gradient.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from scenarios.units import KMH_PER_MPS
from sensors.streams import FloatArray, Stream, quantity
from vehicle import GRAVITY_MPS2

SLOPE_SPACING_M = 100.0
RADIUS_SPACING_M = 50.0
SMALLEST_RADIUS_M = 350.0
STEP_S = 0.01


@dataclass(frozen=True)
class PointMass:
    """One form of the model. `resistance_npkn`: r0, r1, r2; beyond `straight_from_m` a curve counts as straight."""

    resistance_npkn: tuple[float, float, float]
    rotating_share: float
    accelerometer: Literal["sound", "printed"]
    largest_speed_kmh: float = 220.0
    straight_from_m: float = 10_000.0

    def resistance(self, speed_mps: float) -> float:
        """W in N/kN: zero at standstill."""
        if speed_mps == 0.0:
            return 0.0
        kmh = KMH_PER_MPS * speed_mps
        r0, r1, r2 = self.resistance_npkn
        return r0 + kmh * (r1 + kmh * r2)


POINT_MASSES: dict[str, PointMass] = {
    # the coach malvezzi-2014: its resistance per kN of its weight; four wheelsets of 110 kg m2 on wheels of 0.46 m
    "point-mass": PointMass((1.589, 0.009319, 1.1442e-4), 0.037, "sound"),
    "point-mass-as-printed": PointMass((0.78, 0.7, 0.001), 0.0, "printed"),
}


class PointMassStream(Stream):
    """What the model puts out, one row a step; the specific force in the train's axes, z up."""

    t_s: FloatArray = quantity("s", about="time from the start of the run")
    position_m: FloatArray = quantity("m", about="along the track")
    speed_mps: FloatArray = quantity("m/s", about="along the track, clipped")
    acceleration_mps2: FloatArray = quantity("m/s2", about="derivative of the clipped speed")
    gradient_permille: FloatArray = quantity("permille", about="of the track, positive uphill")
    curvature_radpm: FloatArray = quantity("rad/m", about="of the track, positive to the left")
    specific_force_mps2: FloatArray = quantity("m/s2", ("x", "y", "z"), about="what an accelerometer reads")


@dataclass(frozen=True)
class Line:
    """Gradient (per mille, each 100 m from 0 on) and radius (m, each 50 m; inf: straight; positive to the left)."""

    gradient_permille: np.ndarray
    radius_m: np.ndarray

    def __post_init__(self) -> None:
        if len(self.gradient_permille) == 0 or not np.all(np.isfinite(self.gradient_permille)):
            raise ValueError("gradient_permille: at least one value, all of them finite, is needed")
        tight = np.flatnonzero(~(np.abs(self.radius_m) >= SMALLEST_RADIUS_M))
        if len(tight):
            raise ValueError(
                f"radius_m[{tight[0]}] = {self.radius_m[tight[0]]}: at least {SMALLEST_RADIUS_M:g} either way is needed"
            )

    def gradient_at(self, position_m: np.ndarray) -> np.ndarray:
        """Interpolated between the given values, per mille."""
        places = SLOPE_SPACING_M * np.arange(len(self.gradient_permille))
        return np.interp(position_m, places, self.gradient_permille)

    def curvature_at(self, position_m: np.ndarray, straight_from_m: float) -> np.ndarray:
        """1/R of the value given for the 50 m; zero where |R| is larger than `straight_from_m`. rad/m."""
        if len(self.radius_m) == 0:
            return np.zeros(np.shape(position_m))
        row = np.clip((np.asarray(position_m) / RADIUS_SPACING_M).astype(int), 0, len(self.radius_m) - 1)
        radius = self.radius_m[row]
        return np.where(np.abs(radius) > straight_from_m, 0.0, 1.0 / radius)


def simulate_point_mass(
    model: PointMass, mass_kg: float, force_n: np.ndarray, line: Line, initial_speed_mps: float = 0.0
) -> PointMassStream:
    """Run the model under `force_n` (n,), the force in each step of 10 ms; n + 1 rows.

    Trapezoidal in position; a step ends at the clipped speed, and the acceleration is what led there.
    """
    largest_mps = model.largest_speed_kmh / KMH_PER_MPS
    position, speed = np.zeros(len(force_n) + 1), np.zeros(len(force_n) + 1)
    speed[0] = min(max(initial_speed_mps, 0.0), largest_mps)
    effective_kg = (1.0 + model.rotating_share) * mass_kg
    weight_n = mass_kg * GRAVITY_MPS2
    last = len(line.gradient_permille) - 1
    for k in range(len(force_n)):
        v = speed[k]
        u = min(position[k] / SLOPE_SPACING_M, float(last))
        i = min(int(u), max(last - 1, 0))
        here, there = line.gradient_permille[i], line.gradient_permille[min(i + 1, last)]
        pull_n = weight_n * math.sin(math.atan((here + (u - i) * (there - here)) / 1000.0))
        a = (force_n[k] - pull_n - model.resistance(v) * weight_n / 1000.0) / effective_kg
        speed[k + 1] = min(max(v + a * STEP_S, 0.0), largest_mps)
        position[k + 1] = position[k] + 0.5 * (v + speed[k + 1]) * STEP_S
    return readings(model, position, speed, line)


def readings(model: PointMass, position_m: np.ndarray, speed_mps: np.ndarray, line: Line) -> PointMassStream:
    """The stream of a run at `position_m`, `speed_mps` (n,), one row each 10 ms."""
    acceleration = np.diff(speed_mps, append=speed_mps[-1]) / STEP_S
    gradient = line.gradient_at(position_m)
    angle = np.arctan(gradient / 1000.0)
    curvature = line.curvature_at(position_m, model.straight_from_m)
    along_mps2 = GRAVITY_MPS2 * np.sin(angle)
    if model.accelerometer == "sound":
        longitudinal = acceleration + along_mps2
    else:
        clipped = (speed_mps <= 0.0) | (speed_mps >= model.largest_speed_kmh / KMH_PER_MPS)
        longitudinal = np.where(clipped, along_mps2, acceleration)
    return PointMassStream(
        t_s=STEP_S * np.arange(len(speed_mps), dtype=np.float64),
        position_m=position_m,
        speed_mps=speed_mps,
        acceleration_mps2=acceleration,
        gradient_permille=gradient,
        curvature_radpm=curvature,
        specific_force_mps2=np.stack([longitudinal, speed_mps**2 * curvature, GRAVITY_MPS2 * np.cos(angle)], axis=1),
    )
