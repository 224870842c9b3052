"""Which slip brakes best, found while braking: two axles compared with a third at one and the same place of the rail.

Adhesion changes along the line by more than slip changes it, so that a force now and a force a second ago say little.
But all axles roll over the same places one after the other. Counted in the direction of travel, the second axle's
adhesion is kept by place; divided by it, the third's and the fourth's adhesion are free of the rail's changes. Now and
then the third axle tries another slip level for as long as it takes to measure

    own(level)       what this level does to the axle's own adhesion
    cleaned(level)   what it does to the adhesion of the next axle, which comes to the place after it

both relative to the lowest level. An axle with n axles behind it then takes the level with the largest own + n cleaned:
where slip cleans the rail the leading axles scrub it and the last one brakes at its own best, where it does not all
stay at the peak of their curve. The next level above those in use is tried only from there, so that a rail whose
adhesion falls with slip costs no more than a look over the lowest step.
"""

from typing import Any

import numpy as np

from wsp.compiled import Record
from wsp.controllers.axle_release import NO_AXLE
from wsp.controllers.interface import AXLES
from wsp.controllers.limits import sighted
from wsp.controllers.records import part_of_tick
from wsp.controllers.slip_search_parameters import LEVELS, SlipSearchParameters

_BINS, _BIN_M = 64, 0.5
_BEFORE, _TRYING, _AFTER = range(3)
_THIRD = 2  # its place in the train, the one that tries
_NO_LEVEL = -1
_SLOWER = 1.5  # factor on the interval of trials that bring no news

# a slip counts as even when it keeps its set-point within this
_EVEN_MPS, _EVEN_SHARE = 0.06, 0.15


def slip_search_constants(p: SlipSearchParameters, period_s: float) -> dict[str, Any]:
    """Constants by name, besides the slip law's; times without a unit in their name are in ticks."""
    times = ("settling", "measuring", "longest_trial", "first_interval", "last_interval", "scout_interval")
    return {
        "level_offset_mps": p.slip_offset_mps,
        "level_share": p.slip_share,
        "largest_slip_mps": p.largest_slip_mps,
        "axle_position_m": p.axle_position_m,
        "search_above_mps": p.search_above_mps,
        "scout_level": p.scout_level,
        "figures_kept": p.figures_kept,
        "margin": p.margin,
        "persistence": p.persistence,
        **{name: getattr(p, f"{name}_s") / period_s for name in times},
    }


def slip_search_state(p: SlipSearchParameters, period_s: float) -> dict[str, Any]:
    """The search as it begins: all at the lowest level, nothing measured."""
    return {
        # what is known of each level, and how often it was measured; the level of each place in the train
        "own": np.zeros(LEVELS),
        "cleaned": np.zeros(LEVELS),
        "times": np.zeros(LEVELS),
        "level": np.zeros(AXLES, np.int64),
        # way of the train and the second axle's adhesion by place
        "travel_m": 0.0,
        "second_mps2": np.full(_BINS, np.nan),
        # what is being done, for how many ticks; way from which and ticks of even slip after which figures count
        "doing": _BEFORE,
        "doing_for": 0,
        "counts_from_m": np.nan,
        "settled": 0,
        # ratios of third and fourth axle before, in and after a trial, and how many ticks they are the means of
        "third": np.zeros(3),
        "fourth": np.zeros(3),
        "count": np.zeros(3),
        "trial": _NO_LEVEL,
        "trial_interval": p.first_interval_s / period_s,
        "scout_in": 0.0,
        "scout_every": p.scout_interval_s / period_s,
    }


@part_of_tick
def _set_point_mps(s: Record, c: Record, level: int) -> float:
    return min(c.level_offset_mps + c.level_share[level] * s.reference_mps, c.largest_slip_mps)


@part_of_tick
def _even(s: Record, c: Record, axle: int) -> bool:
    """Whether an axle slips as it is to, so that its adhesion belongs to that slip."""
    slip_set = s.slip_set_mps[axle]
    error = abs(s.reference_mps - s.speed_mps[axle] - slip_set)
    return s.since_vent[axle] < c.quiet and axle != s.relieved and error < _EVEN_MPS + _EVEN_SHARE * slip_set


@part_of_tick
def _keep_by_place(s: Record, c: Record, adhesion_mps2: float) -> None:
    """The second axle's adhesion (nan: not to be used) into every bin of the way of this tick."""
    before = int(s.travel_m / _BIN_M)
    s.travel_m += s.reference_mps * c.period_s
    for place in range(before + 1, int(s.travel_m / _BIN_M) + 1):
        s.second_mps2[place % _BINS] = adhesion_mps2


@part_of_tick
def _second_axle_at(s: Record, behind_m: float) -> float:
    if s.travel_m <= behind_m:
        return np.nan
    return s.second_mps2[int((s.travel_m - behind_m) / _BIN_M) % _BINS]


@part_of_tick
def _choose_levels(s: Record, c: Record) -> bool:
    """Give every place in the train its best level; whether any has changed."""
    changed = False
    for place in range(AXLES):
        best, highest = 0, -np.inf
        now = s.level[place]
        for level in range(LEVELS):
            if level > 0 and s.times[level] == 0.0:
                continue
            worth = s.own[level] + (AXLES - 1 - place) * s.cleaned[level] - c.margin * level
            if level == now:
                worth += c.persistence
            if worth > highest:
                best, highest = level, worth
        if best != now:
            s.level[place] = best
            changed = True
            if place == 1:
                s.second_mps2[:] = np.nan
    return changed


@part_of_tick
def _learn(s: Record, c: Record) -> None:
    """Evaluate a trial of the third axle against the mean of before and after, so that slow drifts cancel."""
    usual = s.level[_THIRD]
    own = 2.0 * s.third[_TRYING] / (s.third[_BEFORE] + s.third[_AFTER]) - 1.0
    cleaned = 2.0 * s.fourth[_TRYING] / (s.fourth[_BEFORE] + s.fourth[_AFTER]) - 1.0
    level = s.trial
    if level == 0:  # all counts from the lowest level: what the trial says is what the usual level gives
        own, cleaned = -own, -cleaned
        level = usual
    else:
        own += s.own[usual]
        cleaned += s.cleaned[usual]
    s.times[level] = min(s.times[level] + 1.0, c.figures_kept)
    s.own[level] += (own - s.own[level]) / s.times[level]
    s.cleaned[level] += (cleaned - s.cleaned[level]) / s.times[level]
    if s.trial == c.scout_level:
        in_vain = s.own[level] + (AXLES - 1) * s.cleaned[level] < 0.0
        s.scout_every = 2.0 * s.scout_every if in_vain else c.scout_interval
        s.scout_in = s.scout_every


@part_of_tick
def _next_trial(s: Record, c: Record) -> int:
    """Scouting when its time has come; else in turn, up to one level above the highest in use."""
    usual = s.level[_THIRD]
    if s.scout_in <= 0.0 and usual != c.scout_level:
        return int(c.scout_level)
    top = 1
    for place in range(AXLES):
        top = max(top, s.level[place] + 1)
    top = min(top, LEVELS - 1)
    level = s.trial - 1
    for _ in range(LEVELS):
        if level < 0:
            level = top
        if level != usual and level <= top:
            break
        level -= 1
    return int(level)


@part_of_tick
def _begin(s: Record, doing: int) -> None:
    s.doing = doing
    s.doing_for = 0
    s.counts_from_m = np.nan
    s.third[doing] = s.fourth[doing] = s.count[doing] = 0.0


@part_of_tick
def _measured(s: Record, c: Record, next_axle_m: float, third: float, fourth: float) -> bool:
    """Take the ratios of a tick (nan: they do not count) into the means; whether enough have been taken."""
    doing = s.doing
    if np.isnan(third) or np.isnan(fourth):
        return False
    if np.isnan(s.counts_from_m):
        s.counts_from_m = s.travel_m + next_axle_m
        s.settled = 0
    s.settled += 1
    if s.travel_m < s.counts_from_m or s.settled <= c.settling:
        return False
    s.count[doing] = min(s.count[doing] + 1.0, c.measuring)
    s.third[doing] += (third - s.third[doing]) / s.count[doing]
    s.fourth[doing] += (fourth - s.fourth[doing]) / s.count[doing]
    return bool(s.count[doing] >= c.measuring)


@part_of_tick
def _evaluate(s: Record, c: Record) -> None:
    """A trial has been measured, and what followed: learn, choose, go on."""
    _learn(s, c)
    if _choose_levels(s, c):
        s.trial_interval = c.first_interval
        _begin(s, _BEFORE)
        return
    s.trial_interval = min(_SLOWER * s.trial_interval, c.last_interval)
    # what was after one trial is before the next
    s.doing, s.doing_for = _BEFORE, 0
    s.third[_BEFORE], s.fourth[_BEFORE], s.count[_BEFORE] = s.third[_AFTER], s.fourth[_AFTER], s.count[_AFTER]


@part_of_tick
def _go_round(s: Record, c: Record, next_axle_m: float, third: float, fourth: float) -> None:
    """A tick of the round before - trial - after."""
    s.doing_for += 1
    s.scout_in -= 1.0
    measured = _measured(s, c, next_axle_m, third, fourth)
    if s.doing == _BEFORE:
        due = measured and s.doing_for >= s.trial_interval and s.relieved == NO_AXLE
        if due and s.reference_mps > c.search_above_mps:
            s.trial = _next_trial(s, c)
            _begin(s, _TRYING)
    elif s.doing == _TRYING:
        if measured:
            _begin(s, _AFTER)
    elif measured:
        _evaluate(s, c)
    if s.doing != _BEFORE and s.doing_for >= c.longest_trial:
        _begin(s, _BEFORE)
        s.trial_interval = min(_SLOWER * s.trial_interval, c.last_interval)
        s.scout_in = max(s.scout_in, s.trial_interval)


@part_of_tick
def _distance_m(c: Record, axle: int, other: int) -> float:
    return abs(c.axle_position_m[axle] - c.axle_position_m[other])


@part_of_tick
def search_slips(s: Record, c: Record, at_work: bool, direction: int) -> None:
    """Set every axle's slip set-point (s.slip_set_mps); once a tick, after `observe_adhesion`."""
    step, first = (1, 0) if direction >= 0 else (-1, AXLES - 1)
    second, third, fourth = first + step, first + 2 * step, first + 3 * step
    seen = at_work
    for axle in range(AXLES):
        seen = seen and sighted(s, axle)
    _keep_by_place(s, c, s.adhesion_mps2[second] if seen and _even(s, c, second) else np.nan)
    if seen:
        ratio_3 = ratio_4 = np.nan
        if _even(s, c, third) and _even(s, c, fourth):
            ratio_3 = s.adhesion_mps2[third] / _second_axle_at(s, _distance_m(c, third, second))
            ratio_4 = s.adhesion_mps2[fourth] / _second_axle_at(s, _distance_m(c, fourth, second))
        _go_round(s, c, _distance_m(c, fourth, third), ratio_3, ratio_4)
    else:
        _begin(s, _BEFORE)
    for place in range(AXLES):
        level = s.level[place] if seen else 0
        if seen and place == _THIRD and s.doing == _TRYING:
            level = s.trial
        s.slip_set_mps[first + step * place] = _set_point_mps(s, c, level)
