"""A synthetic run, made of formulas: a point train on a line with gradient, curve and cant, with wheels that slip.

It stands in for the coach so that the estimators are tested against something that shares no code with them.
"""

import dataclasses
import functools
import math
import tomllib
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from estimators import EstimateStream, Estimator, Initial, Sample, samples
from sensors import (
    IMU_PRESETS,
    AxleSpeedReadings,
    BaliseParameters,
    Balises,
    Imu,
    ImuParameters,
    Kinematics,
    TachometerParameters,
    Tachometers,
    gravity_calibration,
)

STEP_S = 0.005
WHEEL_RADIUS_M = 0.46

Profile = Callable[[float], float]
Slip = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


@dataclasses.dataclass
class Run:
    """Truth every 5 ms, and what the on-board computer has of it."""

    position_m: NDArray[np.float64]
    speed_mps: NDArray[np.float64]
    gradient_permille: NDArray[np.float64]
    roll_rad: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]
    wheel_mps: NDArray[np.float64]
    samples: list[Sample]
    initial: Initial

    def estimate(self, estimator: Estimator, initial: Initial | None = None) -> EstimateStream:
        """Run an estimator over the samples."""
        estimator.reset(initial or self.initial)
        return EstimateStream.of(estimator.step(sample) for sample in self.samples)

    def at(self, values: NDArray[np.float64], t_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Truth at the estimator's ticks."""
        return values[np.round(t_s / STEP_S).astype(int)]


def quiet_imu() -> ImuParameters:
    """An IMU without errors, level in the carbody's centre."""
    return ImuParameters.model_validate(
        {
            "bandwidth_hz": 40.0,
            "accelerometer": {"noise_density_mps2_per_rthz": 0.0, "range_mps2": 100.0},
            "gyroscope": {"noise_density_radps_per_rthz": 0.0, "range_radps": 10.0},
        }
    )


def preset_imu(name: str = "malvezzi-2014") -> ImuParameters:
    """A preset as it comes."""
    return ImuParameters.model_validate(tomllib.loads(IMU_PRESETS[name].read_text()))


def ramp(start: float, length: float, height: float) -> Profile:
    """From 0 to a height over a length, rounded at both ends."""

    def value(s: float) -> float:
        share = min(max((s - start) / length, 0.0), 1.0)
        return height * (share - math.sin(2.0 * math.pi * share) / (2.0 * math.pi))

    return value


def total(*profiles: Profile) -> Profile:
    """The sum of profiles."""
    return lambda s: sum(profile(s) for profile in profiles)


def level(_: float) -> float:
    return 0.0


@dataclasses.dataclass
class Drive:
    """True motion of a train without its wheels."""

    kinematics: Kinematics
    position_m: NDArray[np.float64]
    speed_mps: NDArray[np.float64]
    gradient_permille: NDArray[np.float64]
    roll_rad: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]


def drive(
    duration_s: float,
    speed_mps: float,
    own_acceleration: Profile,
    *,
    gradient_permille: Profile = level,
    curvature_radpm: Profile = level,
    cant_rad: Profile = level,
) -> Drive:
    """A train that starts at a speed; it accelerates by `own_acceleration(t)` minus gravity, and can stand still."""
    n = round(duration_s / STEP_S) + 1
    t = STEP_S * np.arange(n)
    s, v, a = np.zeros(n), np.zeros(n), np.zeros(n)
    v[0] = speed_mps
    for k in range(n - 1):
        own = own_acceleration(t[k])
        a[k] = own - 9.81 * math.sin(math.atan(1e-3 * gradient_permille(s[k])))
        if own <= 0.0 and v[k] + a[k] * STEP_S <= 0.0:
            a[k] = -v[k] / STEP_S
        v[k + 1] = v[k] + a[k] * STEP_S
        s[k + 1] = s[k] + STEP_S * 0.5 * (v[k] + v[k + 1])
    gradient = np.array([gradient_permille(x) for x in s])
    pitch = -np.arctan(1e-3 * gradient)
    roll = -np.array([cant_rad(x) for x in s])
    yaw_rate = v * np.array([curvature_radpm(x) for x in s])
    pitch_rate, roll_rate = np.gradient(pitch, STEP_S), np.gradient(roll, STEP_S)
    rate = np.column_stack(
        [
            roll_rate - yaw_rate * np.sin(pitch),
            pitch_rate * np.cos(roll) + yaw_rate * np.cos(pitch) * np.sin(roll),
            -pitch_rate * np.sin(roll) + yaw_rate * np.cos(pitch) * np.cos(roll),
        ]
    )
    across, upward = v * yaw_rate * np.cos(pitch), -v * pitch_rate
    acceleration = np.column_stack(
        [a, across * np.cos(roll) + upward * np.sin(roll), -across * np.sin(roll) + upward * np.cos(roll)]
    )
    gravity = -9.81 * np.column_stack([-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)])
    return Drive(
        kinematics=Kinematics(
            t_s=t,
            specific_force_mps2=acceleration - gravity,
            angular_rate_radps=rate,
            angular_acceleration_radps2=np.gradient(rate, STEP_S, axis=0),
        ),
        position_m=s,
        speed_mps=v,
        gradient_permille=gradient,
        roll_rad=roll,
        yaw_rad=np.concatenate([[0.0], np.cumsum(0.5 * STEP_S * (yaw_rate[1:] + yaw_rate[:-1]))]),
    )


def rolling(t_s: NDArray[np.float64], _: NDArray[np.float64]) -> NDArray[np.float64]:
    """No slip."""
    return np.zeros((len(t_s), 4))


def observe(
    truth: Drive,
    slip: Slip = rolling,
    imu: ImuParameters | None = None,
    seed: int = 1,
    rolling_radius_m: float = WHEEL_RADIUS_M,
) -> Run:
    """The readings of a drive: IMU (without errors unless given), tachometers, balises every kilometre."""
    t, v = truth.kinematics.t_s, truth.speed_mps
    parameters = imu or quiet_imu()
    calibration = gravity_calibration(parameters, np.random.default_rng(seed))
    wheel = v[:, None] * (1.0 - slip(t, v))
    angle = np.vstack([np.zeros(4), np.cumsum(0.5 * STEP_S * (wheel[1:] + wheel[:-1]), axis=0)]) / rolling_radius_m
    return Run(
        position_m=truth.position_m,
        speed_mps=v,
        gradient_permille=truth.gradient_permille,
        roll_rad=truth.roll_rad,
        yaw_rad=truth.yaw_rad,
        wheel_mps=wheel,
        samples=list(
            samples(
                Imu(parameters, STEP_S, seed).process(truth.kinematics),
                axle_speeds_of(t, angle, wheel / rolling_radius_m, seed),
                Balises(BaliseParameters(first_m=500.0), seed).passed(t, truth.position_m),
            )
        ),
        initial=Initial(
            speed_mps=float(v[0]),
            position_sd_m=3.0,
            speed_sd_mps=0.3,
            imu_roll_rad=calibration.imu_roll_rad,
            imu_pitch_rad=calibration.imu_pitch_rad,
        ),
    )


def axle_speeds_of(
    t_s: NDArray[np.float64], angle_rad: NDArray[np.float64], speed_radps: NDArray[np.float64], seed: int
) -> AxleSpeedReadings:
    """Speeds every 10 ms from tachometers in the loop."""
    tachometers = Tachometers(TachometerParameters(), np.random.default_rng(seed))
    speeds, valid = [], []
    for k in range(0, len(t_s), 2):
        tachometers.advance(t_s[k], angle_rad[k], speed_radps[k])
        speeds.append(tachometers.axle_speed_mps.copy())
        valid.append(tachometers.valid.copy())
    return AxleSpeedReadings(t_s=t_s[::2], axle_speed_mps=np.array(speeds), valid=np.array(valid))


def etcs_speed_limit_mps(speed_mps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Subset-041: 2 km/h up to 30 km/h, then rising to 12 km/h at 500 km/h."""
    return (2.0 + np.maximum(3.6 * speed_mps - 30.0, 0.0) * 10.0 / 470.0) / 3.6


def alike(onset_s: float, depth: float, wave: float = 0.5, period_s: float = 2.5) -> Slip:
    """All four wheels slide alike from a moment on, about a depth that swings by a share `wave`."""

    def slip(t: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        grown = np.clip((t - onset_s) / 0.6, 0.0, 1.0)
        course = depth * grown * (1.0 + wave * np.sin(2.0 * math.pi * (t - onset_s) / period_s))
        return np.repeat(np.minimum(course, 1.0)[:, None], 4, axis=1)

    return slip


BRAKE_ONSET_S = 60.0


def _coast_and_brake(t_s: float) -> float:
    return -0.03 - (0.6 * min((t_s - BRAKE_ONSET_S) / 1.5, 1.0) if t_s > BRAKE_ONSET_S else 0.0)


@functools.cache
def low_adhesion_drive() -> Drive:
    """120 km/h, coasting onto a gradient and through a curve with cant, then 50 s of braking, then standstill."""
    return drive(
        130.0,
        120.0 / 3.6,
        _coast_and_brake,
        gradient_permille=total(ramp(600.0, 120.0, 6.0), ramp(2300.0, 80.0, -4.0)),
        curvature_radpm=total(ramp(900.0, 100.0, 1e-3), ramp(1500.0, 100.0, -1e-3)),
        cant_rad=total(ramp(900.0, 100.0, 0.06), ramp(1500.0, 100.0, -0.06)),
    )


def low_adhesion_stop(slip: Slip, seed: int = 1) -> Run:
    """What sensors say of `low_adhesion_drive` with wheels that slip, from the preset board."""
    return observe(low_adhesion_drive(), slip, preset_imu(), seed)
