"""What characterises a test path: shares of degraded adhesion, speed, yaw rate and slope, and how its wheels slid.

The classes are those of the three tables in M. Malvezzi et al., Proc. IMechE Part F 228(4), 2014, over a whole run,
standstill at its ends included. All from the recorded truth: the carbody's speed, its yaw rate about its own vertical
axis (magnitude, smoothed by nothing), the track's gradient at its centre, and the peak adhesion that the wheels found.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.truth import Truth
from scenarios.units import KMH_PER_MPS

SPEED_BORDERS_KMH = (50.0, 150.0)
YAW_RATE_BORDERS_RADPS = (1e-4, 0.005)
SLOPE_BORDERS_PERMILLE = (5.0, 15.0)
DEGRADED_BELOW = 0.2
"""Peak adhesion midway between the good sections' 0.3 and the degraded ones' 0.1."""
SLIP_COUNTS_ABOVE_MPS = 10.0 / KMH_PER_MPS
_SHORTEST_PHASE_S = 3.0

Array = NDArray[np.float64]
Classes = tuple[float, float, float]


@dataclass(frozen=True)
class Shares:
    """Shares in per cent; each of three classes from low to high."""

    degraded: float
    speed: Classes
    yaw_rate: Classes
    slope: Classes


@dataclass(frozen=True)
class DegradedPhase:
    """Traction or braking on degraded rail: when, where, and the largest slip (magnitude) of each wheelset."""

    kind: str
    from_s: float
    to_s: float
    from_m: float
    to_m: float
    largest_slip: tuple[float, float, float, float]


@dataclass(frozen=True)
class PathFigures:
    """Length of the run, the shares by time and by distance, and the degraded phases in their order."""

    length_km: float
    by_time: Shares
    by_distance: Shares
    phases: tuple[DegradedPhase, ...]


def class_shares(values: Array, borders: tuple[float, float], weight: Array) -> Classes:
    """Shares (%) of `weight` (n,) with the magnitude of `values` (n,) below, between and above the two borders."""
    size, total = np.abs(values), float(np.sum(weight))
    low = float(np.sum(weight[size < borders[0]]))
    high = float(np.sum(weight[size > borders[1]]))
    return 100.0 * low / total, 100.0 * (total - low - high) / total, 100.0 * high / total


def path_figures(truth: Truth) -> PathFigures:
    """All of a recorded run; rows are taken to last until the next one."""
    motion = truth.motion
    degraded = truth.wheelsets.peak_adhesion.mean(axis=1) < DEGRADED_BELOW
    time_s = np.diff(motion.t_s)
    way_m = np.abs(np.diff(motion.position_m))
    return PathFigures(
        length_km=float(motion.position_m[-1] - motion.position_m[0]) / 1000.0,
        by_time=_shares(truth, degraded, time_s),
        by_distance=_shares(truth, degraded, way_m),
        phases=degraded_phases(truth, degraded),
    )


def _shares(truth: Truth, degraded: NDArray[np.bool_], weight: Array) -> Shares:
    motion = truth.motion
    return Shares(
        degraded=100.0 * float(np.sum(weight[degraded[:-1]]) / np.sum(weight)),
        speed=class_shares(KMH_PER_MPS * motion.speed_mps[:-1], SPEED_BORDERS_KMH, weight),
        yaw_rate=class_shares(motion.angular_rate_radps[:-1, 2], YAW_RATE_BORDERS_RADPS, weight),
        slope=class_shares(motion.gradient_permille[:-1], SLOPE_BORDERS_PERMILLE, weight),
    )


def degraded_phases(truth: Truth, degraded: NDArray[np.bool_]) -> tuple[DegradedPhase, ...]:
    """Stretches of time of at least 3 s in which the train is driven, or braked, on degraded rail.

    Slip counts above 10 km/h.
    """
    motion, wheelsets = truth.motion, truth.wheelsets
    braked = np.interp(motion.t_s, truth.brake.t_s, truth.brake.demand) > 0.0
    driven = wheelsets.drive_torque_nm.sum(axis=1) > 0.0
    moving = motion.speed_mps > 0.0
    state = np.where(braked, 2, np.where(driven, 1, 0)) * (degraded & moving)
    begins = np.flatnonzero(np.diff(state, prepend=0) != 0)
    ends = np.append(begins, len(state))[1:]
    slip = np.abs(wheelsets.slip) * (motion.speed_mps > SLIP_COUNTS_ABOVE_MPS)[:, None]
    return tuple(
        DegradedPhase(
            kind=("traction", "braking")[state[begin] - 1],
            from_s=float(motion.t_s[begin]),
            to_s=float(motion.t_s[end - 1]),
            from_m=float(motion.position_m[begin]),
            to_m=float(motion.position_m[end - 1]),
            largest_slip=tuple(float(value) for value in slip[begin:end].max(axis=0)),  # type: ignore[arg-type]
        )
        for begin, end in zip(begins, ends, strict=True)
        if state[begin] > 0 and motion.t_s[end - 1] - motion.t_s[begin] >= _SHORTEST_PHASE_S
    )
