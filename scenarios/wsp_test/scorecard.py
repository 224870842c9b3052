"""The figures of one stop, from its recorded truth alone: arrays in, frozen records out.

Rows run at the record period; a row holds until the next one. "Stop" means from the last rise of the brake demand
before standstill (the application itself; with a drag brake before it, the full application at its end) to standstill.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from scenarios.metrics import LOCKED_RIM_SHARE, SLIP_COUNTS_ABOVE_MPS, adhesion_utilisation, locked, stop_span
from scenarios.truth import Truth
from scenarios.units import KMH_PER_MPS
from scenarios.wsp_test.spans import longest_s, merged_spans_s, spans
from wsp import FILL, VENT

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SLIP_BINS = (-1.0, 0.0, 0.01, 0.02, 0.05, 0.10, 0.15, 0.20, 0.30, 0.50, 0.90, 1.01)
"""Borders of the slip histogram; rims faster than the train and locked wheels have bins of their own."""


class ScoringParameters(BaseModel):
    """[scoring]: where the figures of a stop draw their lines."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    slide_slip: float = Field(default=0.05, gt=0.0, lt=1.0, description="a wheelset slides above this slip")
    slide_above_kmh: float = Field(default=5.0, ge=0.0, le=50.0, description="and while the train is faster than this")
    merge_gap_s: float = Field(default=1.0, ge=0.0, le=60.0, description="slides no farther apart are one event")
    control_bar: float = Field(
        default=0.2, gt=0.0, le=2.0, description="cylinder this far below the distributor: the WSP is at work on it"
    )
    settled_share: float = Field(
        default=0.02, gt=0.0, lt=0.5, description="distributor within this share of where it goes: brake built up"
    )


@dataclass(frozen=True)
class WheelsetScore:
    """One wheelset over the whole record.

    `sliding_distance_m`: integral of its speed while it slides. `slip_error`: mean over time of |slip - slip at which
    its adhesion peaks|, over the time in which it slides or the WSP keeps its cylinder below the distributor, above
    10 km/h; None without any. The peak is the rail's as this wheelset meets it: a controller's own set slip, which may
    be wrong, does not count. `locked_s`, `longest_lock_s`: rim below 5 % of a train's speed above 30 km/h, in sum and
    without a break. `largest_slip` above 10 km/h. `friction_energy_kj`: dissipated in the left and right contact, the
    wheelset's energy shared as the work of the longitudinal forces. `flat_risk_mnm`: integral of wheel load x train
    speed over the time with the rim below 5 % of the train's speed, that above 5 km/h, left and right; a measure to
    compare with, no length of a flat. `valve_operations`: how often its hold and its vent valve were energised, in sum.
    `longest_unfilled_s`: longest time without FILL, `longest_vent_s` of VENT without a break, as the valves were
    energised, under brake demand above 5 km/h; `longest_unfilled_command_s` as they were commanded. `safety_timer_s`:
    time in which the valves' safety timer had taken the axle from the controller. `slip_histogram_s`: time under brake
    demand above 10 km/h in each of SLIP_BINS.
    """

    sliding_distance_m: float
    slip_error: float | None
    locked_s: float
    longest_lock_s: float
    largest_slip: float | None
    friction_energy_kj: tuple[float, float]
    flat_risk_mnm: tuple[float, float]
    valve_operations: int
    longest_unfilled_s: float
    longest_unfilled_command_s: float
    longest_vent_s: float
    safety_timer_s: float
    slip_histogram_s: tuple[float, ...]


@dataclass(frozen=True)
class BrakeStretch:
    """A stretch of constant demand above 0, from the brake built up (or eased) to the stretch's end or to 10 km/h.

    `braking_ratio`: mean over time of the wheels' brake force over their load. Speeds at begin and end of the demand.
    """

    begin_s: float
    duration_s: float
    demand: float
    braking_ratio: float
    first_speed_kmh: float
    last_speed_kmh: float


@dataclass(frozen=True)
class Score:
    """One stop. None where the stop has no such figure: no standstill, no slide, no reference speed.

    `distance_m` from the begin of the stop to standstill, `shortest_distance_m` that of a point mass that uses all the
    adhesion found (scenarios.shortest_stop; with a sound brake). `adhesion_utilisation` as in metrics.json.
    `reference_error_*_kmh`: reference minus true speed under brake demand above 5 km/h. `air_nl` drawn over the whole
    record. `slide_events`: spans with any wheelset sliding, those at most 1 s apart as one; `sliding_s` their sum.
    `drag_speed_change_kmh`: largest change of speed over a stretch of constant demand before the stop begins.
    """

    ended: str
    initial_speed_kmh: float | None
    distance_m: float | None
    shortest_distance_m: float | None
    adhesion_utilisation: float | None
    reference_error_rms_kmh: float | None
    reference_error_worst_kmh: float | None
    air_nl: float
    least_reservoir_bar: float
    hottest_disc_degc: float
    slide_events: int
    sliding_s: float
    drag_speed_change_kmh: float | None
    stretches: tuple[BrakeStretch, ...]
    wheelsets: tuple[WheelsetScore, ...]


def score_stop(truth: Truth, shortest_distance_m: float | None, scoring: ScoringParameters) -> Score:
    """All figures of one stop; `shortest_distance_m` is computed elsewhere and passed through."""
    span = application(truth)
    motion, brake = truth.motion, truth.brake
    distance_m = utilisation = initial_kmh = None
    begin_s = float(motion.t_s[-1])
    if span is not None:
        start, end = span
        begin_s = float(motion.t_s[start])
        distance_m = float(motion.position_m[end] - motion.position_m[start])
        initial_kmh = KMH_PER_MPS * float(motion.speed_mps[start])
        utilisation = adhesion_utilisation(motion, truth.wheelsets, start)
    events = slide_events_s(truth, scoring)
    rms_kmh, worst_kmh = reference_errors_kmh(truth, scoring)
    stretches = brake_stretches(truth, scoring)
    drags = [stretch for stretch in stretches if stretch.begin_s < begin_s]
    changes = [abs(stretch.last_speed_kmh - stretch.first_speed_kmh) for stretch in drags]
    return Score(
        ended=truth.solve.ended,
        initial_speed_kmh=initial_kmh,
        distance_m=distance_m,
        shortest_distance_m=shortest_distance_m,
        adhesion_utilisation=utilisation,
        reference_error_rms_kmh=rms_kmh,
        reference_error_worst_kmh=worst_kmh,
        air_nl=float(brake.air_nl[-1] - brake.air_nl[0]),
        least_reservoir_bar=float(brake.reservoir_pressure_bar.min()),
        hottest_disc_degc=float(brake.disc_temperature_degc.max()),
        slide_events=len(events),
        sliding_s=sum(end_s - begin_s for begin_s, end_s in events),
        drag_speed_change_kmh=max(changes, default=None),
        stretches=stretches,
        wheelsets=tuple(_wheelset_score(truth, i, scoring) for i in range(4)),
    )


def application(truth: Truth) -> tuple[int, int] | None:
    """Rows in which the stop begins (last rise of the demand before standstill) and ends; None without standstill."""
    span = stop_span(truth)
    if span is None:
        return None
    start, end = span
    rises = np.flatnonzero(np.diff(truth.brake.demand[start : end + 1]) > 0.0)
    return (start + int(rises[-1]) + 1 if len(rises) else start), end


def sliding(truth: Truth, scoring: ScoringParameters) -> Mask:
    """(n, 4): whether the wheelset slides: slip above 5 % while the train is faster than 5 km/h."""
    fast = truth.motion.speed_mps * KMH_PER_MPS > scoring.slide_above_kmh
    return np.asarray((truth.wheelsets.slip > scoring.slide_slip) & fast[:, None])


def slide_events_s(truth: Truth, scoring: ScoringParameters) -> list[tuple[float, float]]:
    """Begin and end of every time in which any wheelset slides, merged over gaps of up to 1 s."""
    any_slides = np.asarray(sliding(truth, scoring).any(axis=1))
    return merged_spans_s(truth.motion.t_s, any_slides, scoring.merge_gap_s)


def under_control(truth: Truth, scoring: ScoringParameters) -> Mask:
    """(n, 4): the wheelset slides, or its cylinder is kept below the distributor, under demand above 10 km/h."""
    brake = truth.brake
    kept_low = brake.cylinder_pressure_bar < (brake.distributor_pressure_bar - scoring.control_bar)[:, None]
    at_work = kept_low | sliding(truth, scoring)
    return np.asarray(at_work & _counts(truth, SLIP_COUNTS_ABOVE_MPS)[:, None])


def reference_errors_kmh(truth: Truth, scoring: ScoringParameters) -> tuple[float | None, float | None]:
    """Root mean square and largest magnitude of reference minus true speed, under demand above 5 km/h."""
    rows = _counts(truth, scoring.slide_above_kmh / KMH_PER_MPS) & np.isfinite(truth.brake.reference_speed_mps)
    if not rows.any():
        return None, None
    error = KMH_PER_MPS * (truth.brake.reference_speed_mps[rows] - truth.motion.speed_mps[rows])
    return float(np.sqrt(np.mean(error**2))), float(np.abs(error).max())


def braking_ratio(truth: Truth) -> Array:
    """(n,): brake force of all wheels over their load."""
    load_n = np.maximum(truth.wheelsets.normal_force_n.sum(axis=1), 1.0)
    return np.asarray(-truth.wheelsets.longitudinal_force_n.sum(axis=1) / load_n)


def brake_stretches(truth: Truth, scoring: ScoringParameters) -> tuple[BrakeStretch, ...]:
    """The stretches of constant demand in their order, those left out in which the brake never built up."""
    motion, brake = truth.motion, truth.brake
    ratio = braking_ratio(truth)
    moving = _counts(truth, SLIP_COUNTS_ABOVE_MPS)
    changes = np.flatnonzero(np.diff(brake.demand)) + 1
    found = []
    for begin, end in zip([0, *changes], [*changes, len(motion)], strict=True):
        rows = np.arange(begin, end)
        rows = rows[moving[begin:end]]
        if len(rows) == 0:
            continue
        first, last = int(rows[0]), int(rows[-1])
        pressure_bar = brake.distributor_pressure_bar[rows]
        rises = begin == 0 or brake.demand[begin] > brake.demand[begin - 1]
        # a reservoir that runs low may take the pressure down again later
        built_up = (
            pressure_bar >= (1.0 - scoring.settled_share) * pressure_bar.max()
            if rises
            else pressure_bar <= (1.0 + scoring.settled_share) * pressure_bar.min()
        )
        settled = rows[int(np.argmax(built_up)) :]
        if len(settled) < 2:
            continue
        duration_s = float(motion.t_s[settled[-1]] - motion.t_s[settled[0]])
        found.append(
            BrakeStretch(
                begin_s=float(motion.t_s[settled[0]]),
                duration_s=duration_s,
                demand=float(brake.demand[begin]),
                braking_ratio=float(np.trapezoid(ratio[settled], motion.t_s[settled])) / duration_s,
                first_speed_kmh=KMH_PER_MPS * float(motion.speed_mps[first]),
                last_speed_kmh=KMH_PER_MPS * float(motion.speed_mps[last]),
            )
        )
    return tuple(found)


def valve_operations(valve: NDArray[np.int8]) -> int:
    """How often the hold valve (HOLD and VENT energise it) and the vent valve were energised, in sum; `valve` (n,)."""
    return len(spans(valve != FILL)) + len(spans(valve == VENT))


def _counts(truth: Truth, above_mps: float) -> Mask:
    return np.asarray((truth.brake.demand > 0.0) & (truth.motion.speed_mps > above_mps))


def _wheelset_score(truth: Truth, i: int, scoring: ScoringParameters) -> WheelsetScore:
    motion, wheelsets, brake = truth.motion, truth.wheelsets, truth.brake
    t_s, speed_mps = motion.t_s, motion.speed_mps
    held_s = np.diff(t_s, append=t_s[-1])
    slides = sliding(truth, scoring)[:, i]
    controlled_s = held_s * under_control(truth, scoring)[:, i]
    off_peak = np.abs(wheelsets.slip[:, i] - wheelsets.peak_slip[:, i])
    is_locked = locked(motion, wheelsets)[:, i]
    fast = _counts(truth, SLIP_COUNTS_ABOVE_MPS)
    braked = _counts(truth, scoring.slide_above_kmh / KMH_PER_MPS)
    histogram_s, _ = np.histogram(
        np.clip(wheelsets.slip[:, i], SLIP_BINS[0], 1.0), bins=SLIP_BINS, weights=held_s * fast
    )
    grinds = (np.abs(wheelsets.rim_speed_mps[:, i]) < LOCKED_RIM_SHARE * speed_mps) & (
        speed_mps * KMH_PER_MPS > scoring.slide_above_kmh
    )
    wheels = slice(2 * i, 2 * i + 2)
    risk_nm = (wheelsets.normal_force_n[:, wheels] * (held_s * speed_mps * grinds)[:, None]).sum(axis=0)
    return WheelsetScore(
        sliding_distance_m=float((held_s * speed_mps * slides).sum()),
        slip_error=float((controlled_s * off_peak).sum() / controlled_s.sum()) if controlled_s.any() else None,
        locked_s=float((held_s * is_locked).sum()),
        longest_lock_s=longest_s(t_s, is_locked),
        largest_slip=float(wheelsets.slip[fast, i].max()) if fast.any() else None,
        friction_energy_kj=_energy_kj(truth, i),
        flat_risk_mnm=(float(risk_nm[0]) / 1e6, float(risk_nm[1]) / 1e6),
        valve_operations=valve_operations(brake.valve[:, i]),
        longest_unfilled_s=longest_s(t_s, (brake.valve[:, i] != FILL) & braked),
        longest_unfilled_command_s=longest_s(t_s, (brake.valve_command[:, i] != FILL) & braked),
        longest_vent_s=longest_s(t_s, (brake.valve[:, i] == VENT) & braked),
        safety_timer_s=float((held_s * (brake.safety_timer_fired[:, i] > 0)).sum()),
        slip_histogram_s=tuple(map(float, histogram_s)),
    )


def _energy_kj(truth: Truth, i: int) -> tuple[float, float]:
    """Friction energy of the left and the right wheel of wheelset `i`."""
    wheelsets = truth.wheelsets
    force_n = np.abs(wheelsets.longitudinal_force_n[:, 2 * i : 2 * i + 2])
    both = force_n.sum(axis=1)
    left = np.where(both > 0.0, force_n[:, 0] / np.where(both > 0.0, both, 1.0), 0.5)
    power_w = wheelsets.friction_power_w[:, i]
    left_kj = float(np.trapezoid(left * power_w, wheelsets.t_s)) / 1000.0
    return left_kj, float(np.trapezoid(power_w, wheelsets.t_s)) / 1000.0 - left_kj
