"""The figures of a run, from its recorded streams: the stop, the wheelsets, the estimators.

Each block is a frozen record whose field names are the keys of metrics.json; None (null) where a run has no figure.
"""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators.interface import EstimateStream
from scenarios.etcs import distance_limit_m, speed_limit_kmh
from scenarios.truth import MotionStream, SolveRecord, Truth, WheelsetStream
from scenarios.units import KMH_PER_MPS
from sensors.readings import BaliseReadings

STANDSTILL_MPS = 0.02
SLIDE_SLIP = 0.03
SLIP_COUNTS_ABOVE_MPS = 10.0 / KMH_PER_MPS
LOCK_COUNTS_ABOVE_MPS = 30.0 / KMH_PER_MPS
LOCKED_RIM_SHARE = 0.05
SHARES_PERIOD_S = 0.1

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclasses.dataclass(frozen=True)
class StopMetrics:
    """The stop: from the brake demand that ends in standstill. None without such a stop (`air_nl` excepted).

    `shortest_distance_m`: of a point mass that uses all the adhesion found. `adhesion_utilisation`: brake force of the
    wheels over peak adhesion times load, both integrated over distance from the first slip above 3 % to 10 km/h.
    """

    distance_m: float | None
    shortest_distance_m: float | None
    adhesion_utilisation: float | None
    air_nl: float


@dataclasses.dataclass(frozen=True)
class WheelsetMetrics:
    """One wheelset: slip counts above 10 km/h; it is locked with the rim below 5 % of a train's speed above 30 km/h."""

    largest_slip: float | None
    locked_s: float
    friction_energy_kj: float


@dataclasses.dataclass(frozen=True)
class EstimatorMetrics:
    """One estimator at 10 Hz from first to last motion; magnitudes of the errors.

    `distance_error_m` is that at the end. The shares are those of time in which the error of the speed, or of the
    position since the last balise, lies outside the ETCS limit. None where the estimator has no such output.
    """

    speed_rms_kmh: float | None
    speed_max_kmh: float | None
    distance_error_m: float | None
    outside_etcs_share: float | None
    outside_etcs_distance_share: float | None
    gradient_rms_permille: float | None


@dataclasses.dataclass(frozen=True)
class EstimatorErrors:
    """Errors of one estimator, estimate minus truth, at 10 Hz from first to last motion, and the ETCS limits there."""

    t_s: Array
    position_m: Array
    speed_kmh: Array
    distance_m: Array
    gradient_permille: Array
    speed_limit_kmh: Array
    distance_limit_m: Array


def stop_span(truth: Truth) -> tuple[int, int] | None:
    """Rows of the motion in which the stop begins (brake demand above 0) and ends (standstill); None without a stop."""
    motion, brake = truth.motion, truth.brake
    moving = np.flatnonzero(np.abs(motion.speed_mps) > STANDSTILL_MPS)
    if len(moving) == 0 or (moving[-1] + 1 == len(motion) and truth.solve.ended != "standstill"):
        return None
    end = min(int(moving[-1]) + 1, len(motion) - 1)
    demanded = np.interp(motion.t_s[:end], brake.t_s, brake.demand) > 0.0
    if not demanded[-1]:
        return None
    released = np.flatnonzero(~demanded)
    return (int(released[-1]) + 1 if len(released) else 0), end


def stop_metrics(truth: Truth, shortest_distance_m: float | None) -> StopMetrics:
    """The figures of the stop; `shortest_distance_m` is computed elsewhere and passed through."""
    motion, brake = truth.motion, truth.brake
    span = stop_span(truth)
    air_nl = float(brake.air_nl[-1] - brake.air_nl[0])
    if span is None:
        return StopMetrics(None, None, None, air_nl)
    start, end = span
    distance_m = float(motion.position_m[end] - motion.position_m[start])
    return StopMetrics(distance_m, shortest_distance_m, adhesion_utilisation(motion, truth.wheelsets, start), air_nl)


def adhesion_utilisation(motion: MotionStream, wheelsets: WheelsetStream, start: int) -> float | None:
    """Integral of the wheels' brake force over that of peak adhesion x load, by distance, after row `start`.

    It begins with the first slip above 3 % and ends at 10 km/h; None if no wheelset slid.
    """
    fast = motion.speed_mps > SLIP_COUNTS_ABOVE_MPS
    after_start = np.arange(len(motion)) >= start
    slid = np.flatnonzero(after_start & fast & (wheelsets.slip > SLIDE_SLIP).any(axis=1))
    slow = np.flatnonzero(after_start & ~fast)
    if len(slid) == 0:
        return None
    begin = int(slid[0])
    last = int(slow[slow > begin][0]) if (slow > begin).any() else len(motion) - 1
    rows = slice(begin, last + 1)
    load_n = wheelsets.normal_force_n.reshape(-1, 4, 2).sum(axis=2)
    used_n = -wheelsets.longitudinal_force_n[rows].sum(axis=1)
    offered_n = (wheelsets.peak_adhesion[rows] * load_n[rows]).sum(axis=1)
    offered_j = np.trapezoid(offered_n, motion.position_m[rows])
    return float(np.trapezoid(used_n, motion.position_m[rows]) / offered_j) if offered_j > 0.0 else None


def locked(motion: MotionStream, wheelsets: WheelsetStream) -> Mask:
    """(n, 4): whether the wheelset counts as locked."""
    speed_mps = motion.speed_mps[:, None]
    return (np.abs(wheelsets.rim_speed_mps) < LOCKED_RIM_SHARE * speed_mps) & (speed_mps > LOCK_COUNTS_ABOVE_MPS)


def wheelset_metrics(motion: MotionStream, wheelsets: WheelsetStream) -> list[WheelsetMetrics]:
    """The figures of wheelsets 1..4."""
    fast = np.abs(wheelsets.speed_mps) > SLIP_COUNTS_ABOVE_MPS
    held_s = np.diff(wheelsets.t_s, append=wheelsets.t_s[-1])
    locked_s = (locked(motion, wheelsets) * held_s[:, None]).sum(axis=0)
    energy_kj = np.asarray(np.trapezoid(wheelsets.friction_power_w, wheelsets.t_s, axis=0)) / 1000.0
    return [
        WheelsetMetrics(
            largest_slip=float(wheelsets.slip[fast[:, i], i].max()) if fast[:, i].any() else None,
            locked_s=float(locked_s[i]),
            friction_energy_kj=float(energy_kj[i]),
        )
        for i in range(4)
    ]


def estimator_errors(motion: MotionStream, balises: BaliseReadings, estimate: EstimateStream) -> EstimatorErrors:
    """Errors of an estimator on a grid of 10 Hz; between its own ticks its last answer counts."""
    moving = np.flatnonzero(np.abs(motion.speed_mps) > STANDSTILL_MPS)
    first_s, last_s = (motion.t_s[moving[0]], motion.t_s[moving[-1]]) if len(moving) else (math.inf, -math.inf)
    count = math.floor(motion.t_s[-1] / SHARES_PERIOD_S + 1e-6) + 1
    t_s = SHARES_PERIOD_S * np.arange(count)
    held = np.searchsorted(estimate.t_s, t_s + 1e-6, side="right") - 1
    within = (t_s >= first_s - 1e-9) & (t_s <= last_s + 1e-9) & (held >= 0)
    t_s, held = t_s[within], held[within]
    position_m = np.interp(t_s, motion.t_s, motion.position_m)
    speed_kmh = KMH_PER_MPS * np.interp(t_s, motion.t_s, motion.speed_mps)
    return EstimatorErrors(
        t_s=t_s,
        position_m=position_m,
        speed_kmh=KMH_PER_MPS * estimate.speed_mps[held] - speed_kmh,
        distance_m=estimate.position_m[held] - position_m,
        gradient_permille=estimate.gradient_permille[held] - np.interp(t_s, motion.t_s, motion.gradient_permille),
        speed_limit_kmh=speed_limit_kmh(speed_kmh),
        distance_limit_m=distance_limit_m(position_m - _reference_position_m(motion, balises, t_s)),
    )


def estimator_metrics(errors: EstimatorErrors) -> EstimatorMetrics:
    """The figures of one estimator. Where it has an answer at times only, its silence counts as outside the limit."""
    return EstimatorMetrics(
        speed_rms_kmh=_rms(errors.speed_kmh),
        speed_max_kmh=_largest(errors.speed_kmh),
        distance_error_m=_largest(errors.distance_m[-1:]),
        outside_etcs_share=_share_outside(errors.speed_kmh, errors.speed_limit_kmh),
        outside_etcs_distance_share=_share_outside(errors.distance_m, errors.distance_limit_m),
        gradient_rms_permille=_rms(errors.gradient_permille),
    )


def metrics_tree(
    solve: SolveRecord,
    stop: StopMetrics,
    wheelsets: list[WheelsetMetrics],
    estimators: Mapping[str, EstimatorMetrics],
) -> dict[str, Any]:
    """The content of metrics.json."""
    return {
        "solve": {
            "simulated_s": solve.simulated_s,
            "wall_s": solve.wall_s,
            "realtime_factor": solve.realtime_factor,
            "step_s": solve.step_s,
        },
        "stop": dataclasses.asdict(stop),
        "wheelsets": [dataclasses.asdict(wheelset) for wheelset in wheelsets],
        "estimators": {name: dataclasses.asdict(figures) for name, figures in estimators.items()},
    }


def _reference_position_m(motion: MotionStream, balises: BaliseReadings, t_s: Array) -> Array:
    """True position at the last balise read before each time, else at the start."""
    at_m = np.concatenate([[motion.position_m[0]], np.interp(balises.t_s, motion.t_s, motion.position_m)])
    return at_m[np.searchsorted(balises.t_s, t_s, side="right")]


def _rms(errors: Array) -> float | None:
    known = errors[np.isfinite(errors)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else None


def _largest(errors: Array) -> float | None:
    known = errors[np.isfinite(errors)]
    return float(np.abs(known).max()) if len(known) else None


def _share_outside(errors: Array, limits: Array) -> float | None:
    if not np.isfinite(errors).any():
        return None
    return float(np.mean(~(np.abs(errors) <= limits)))
