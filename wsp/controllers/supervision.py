"""What every controller does at a tick: follow the axles and the train, relieve one axle, keep to the limits.

In a tick a controller calls `observe`, then, if that says that valves may be worked, `guarded` for each axle that is
`sighted` with the valve code it has chosen; then always `command_the_rest` and `request` (wsp.controllers.limits and
.requests).
"""

import math
from typing import Any

import numpy as np

from wsp.compiled import Record
from wsp.controllers.axle_release import NO_AXLE, relieve_in_rotation, take_as_certain
from wsp.controllers.axle_watch import compare_axles, follow_axles, motion_of_rolling_axles
from wsp.controllers.interface import AXLES
from wsp.controllers.records import part_of_tick, ticks
from wsp.controllers.supervision_parameters import SupervisionParameters
from wsp.reference_speed import SOURCES, reference_after

MEAN_OF_AXLES, FASTEST_AXLE, AXLE_RELEASE = range(len(SOURCES))

_FIRST_ERROR_MPS2 = 0.15  # of the deceleration, as long as nothing has shown how well it is known


def supervision_constants(p: SupervisionParameters, period_s: float) -> dict[str, Any]:
    """Constants by name; times without a unit in their name are in ticks."""
    r = p.reference
    return {
        "period_s": period_s,
        "filter_memory": math.exp(-period_s / p.filter_time_s),
        "frozen_after": ticks(p.frozen_after_s, period_s),
        "compare_above_mps": p.compare_above_mps,
        "compare_below_mps2": p.compare_below_mps2,
        "compare_memory": ticks(p.compare_memory_s, period_s),
        "largest_wheel_difference": p.largest_wheel_difference,
        "distrust_after": ticks(p.distrust_after_s, period_s),
        "empty_after": ticks(p.empty_after_s, period_s),
        "cut_off_mps": p.cut_off_mps,
        "releases_for": ticks(p.releases_for_s, period_s),
        "quiet": ticks(p.quiet_s, period_s),
        "watchdog": ticks(p.watchdog_s, period_s),
        "watchdog_refill": ticks(p.watchdog_refill_s, period_s),
        "blind_share": p.blind_share,
        "blind_relief": ticks(p.blind_relief_s, period_s),
        "sand_below_mps2": p.sand_below_mps2,
        "track_brake_below_mps2": p.track_brake_below_mps2,
        "request_after": ticks(p.request_after_s, period_s),
        "request_above_mps": p.request_above_mps,
        "source": SOURCES.index(r.source),
        "margins_mps2": (r.fall_margin_mps2, r.fall_margin_at_work_mps2),
        "jerks_mps3": (r.jerk_limit_mps3, r.jerk_limit_at_work_mps3),
        "fall_limit_mps2": r.fall_limit_mps2,
        "jerk_decline_mps3": r.jerk_decline_mps3,
        "jerk_gain_ps2": r.jerk_gain_ps2,
        "rise_limit_mps2": r.rise_limit_mps2,
        "release_after_s": r.release_after_s,
        "release_error_mps": r.release_error_mps,
        "release_longest": ticks(r.release_longest_s, period_s),
        "rolling_share": 1.0 / ticks(r.rolling_s, period_s),
        "rolling_mps2": r.rolling_mps2,
        "rolling_for": ticks(r.rolling_s, period_s),
    }


def supervision_state(p: SupervisionParameters, period_s: float) -> dict[str, Any]:
    """State by name as a run begins."""
    each_axle = np.zeros(AXLES, np.int64)
    return {
        # axles: filtered speed and acceleration; ticks since the last vent, unfilled, of venting since the last fill,
        # of forced filling left; filling due to a blind axle, ticks of its relief left
        "speed_mps": np.full(AXLES, np.nan),
        "acceleration_mps2": np.zeros(AXLES),
        "since_vent": each_axle + ticks(p.quiet_s, period_s),
        "unfilled": each_axle,
        "vented": each_axle,
        "forced": each_axle,
        "fill_due": np.zeros(AXLES),
        "blind_relief": each_axle,
        # what is believed of their readings; ticks of rolling with the brake out
        "last_reading_mps": np.full(AXLES, np.nan),
        "same_reading": each_axle,
        "wheel_ratio": np.ones(AXLES),
        "noise_mps2": np.zeros(AXLES),
        "compared": 0,
        "judged": each_axle,
        "rolls": each_axle,
        "rolls_from_mps": np.zeros(AXLES),
        "distrusted": each_axle,  # 0 or 1: numba knows no arrays of flags in a record
        # train
        "unasked": ticks(p.releases_for_s, period_s),  # ticks without demand
        "started": False,
        "reference_mps": 0.0,
        "deceleration_mps2": 0.0,
        # release: ticks without an axle up to the prediction, the speed before them and what was reckoned off it since;
        # axle relieved, for how many ticks, its mean acceleration against the train, for how many ticks that was a
        # rolling one's, whether a law that knows its pressures takes it for gripping; error of the deceleration
        "unsupported": 0,
        "supported_mps": 0.0,
        "reckoned_mps": 0.0,
        "relieved": NO_AXLE,
        "relieved_last": AXLES - 1,
        "relieved_ticks": 0,
        "rolling_mps2": 0.0,
        "rolled_ticks": 0,
        "grips": True,
        "unsure_mps2": _FIRST_ERROR_MPS2,
        # ticks of too little deceleration
        "short_of_sand": 0,
        "short_of_track_brake": 0,
    }


@part_of_tick
def under_control(s: Record, c: Record) -> bool:
    """Whether any axle has been vented lately."""
    return bool(np.min(s.since_vent) < c.quiet)


@part_of_tick
def _speed_to_go_by(s: Record, c: Record) -> float:
    """The fastest or the mean of the axles, as the source says; nan if all are blind."""
    fastest = np.nan
    total = 0.0
    count = 0
    for axle in range(AXLES):
        speed = s.speed_mps[axle]
        if np.isnan(speed):
            continue
        total += speed
        count += 1
        if not speed <= fastest:
            fastest = speed
    if c.source == MEAN_OF_AXLES and count > 0:
        return total / count
    return fastest


@part_of_tick
def _follow_train(s: Record, c: Record, outside_mps: float, braking: bool) -> None:
    """Reference speed and deceleration one tick on; an outside speed replaces the axles' and is taken as is."""
    outside = not np.isnan(outside_mps)
    leading_mps = abs(outside_mps) if outside else _speed_to_go_by(s, c)
    if not s.started:
        if np.isnan(leading_mps):
            return
        s.started = True
        s.reference_mps = leading_mps
        s.deceleration_mps2 = 0.0
        take_as_certain(s)
    at_work = under_control(s, c)
    limits = 1 if at_work else 0
    before_mps2 = s.deceleration_mps2
    predicted = s.reference_mps - before_mps2 * c.period_s
    s.reference_mps, s.deceleration_mps2 = reference_after(
        s.reference_mps,
        before_mps2,
        leading_mps,
        c.period_s,
        c.margins_mps2[limits],
        c.jerks_mps3[limits],
        (c.fall_limit_mps2, c.jerk_decline_mps3, c.jerk_gain_ps2, c.rise_limit_mps2),
    )
    if outside:
        s.reference_mps = leading_mps
    if s.relieved == NO_AXLE and (outside or leading_mps >= predicted):
        take_as_certain(s)
    else:
        if s.relieved != NO_AXLE:  # the deceleration is judged as a whole at its end
            s.deceleration_mps2 = before_mps2
        s.unsupported += 1
        s.reckoned_mps += s.deceleration_mps2 * c.period_s
    if c.source == AXLE_RELEASE:
        relieve_in_rotation(s, c, at_work and braking and not outside)


@part_of_tick
def _settle_contradictions(s: Record, c: Record) -> None:
    """Rolling wheels go at the train's speed, whatever another one says."""
    speed, acceleration = motion_of_rolling_axles(s, c)
    if not np.isnan(speed):
        s.reference_mps = speed
        s.deceleration_mps2 = min(max(-acceleration, 0.0), c.fall_limit_mps2)
        take_as_certain(s)


@part_of_tick
def observe(s: Record, c: Record, inputs: Record) -> bool:
    """Axles and train one tick on; whether valves may be worked at all (neither unbraked nor below the cut-off).

    `inputs`: the tick's, of INPUT. The brakes are taken to be on for as long as they need to release
    after the demand has gone.
    """
    axle_speed_mps, valid, outside_mps = inputs.axle_speed_mps, inputs.valid, inputs.outside_reference_mps
    s.unasked = 0 if inputs.demand > 0.0 else min(s.unasked + 1, c.releases_for)
    braked = s.unasked < c.releases_for
    if not braked:
        compare_axles(s, c, axle_speed_mps, valid)
    follow_axles(s, c, axle_speed_mps, valid, inputs.direction)
    _follow_train(s, c, outside_mps, braked)
    if s.started and np.isnan(outside_mps):
        _settle_contradictions(s, c)
    return braked and s.started and s.reference_mps >= c.cut_off_mps


@part_of_tick
def known_reference(s: Record) -> float:
    """Reference speed in m/s, nan before the first speed came."""
    return s.reference_mps if s.started else np.nan
