"""Curvature, heading, cant and gradient of a line as closed forms of the place along it."""

from collections.abc import Iterator, Sequence
from itertools import zip_longest
from typing import NamedTuple

import numpy as np

from wheel_rail.track_parameters import Curve, TrackParameters, curve_ends
from wheel_rail.transitions import TRANSITIONS, TransitionKind


class Change(NamedTuple):
    """A transition or a cant ramp."""

    begin_m: float
    end_m: float
    length_m: float
    kind: TransitionKind


class Bend(NamedTuple):
    """A curve as it lies in the line: its curvature grows over `rise` and is gone after `fall`, its cant likewise.

    Where the next curve joins, one falls as the other rises: share(u) + share(1 - u) = 1, so that their sum leads from
    the one value to the other by the kind of transition that the joining curve has.
    """

    curve: Curve
    rise: Change
    fall: Change
    cant_rise: Change
    cant_fall: Change


def bends(curves: Sequence[Curve]) -> Iterator[Bend]:
    """The curves of a line in order, those that join overlapping by the transition between them."""
    for c, following in zip_longest(curves, curves[1:]):
        if following is not None and following.joins_previous:
            fall, cant_fall = _rises(following)
        else:
            fall = Change(c.circle_end_m, c.last_m, c.exit_m, c.transition_kind)
            cant_fall = Change(c.circle_end_m, c.circle_end_m + c.ramp_out_m, c.ramp_out_m, c.transition_kind)
        rise, cant_rise = _rises(c)
        yield Bend(c, rise, fall, cant_rise, cant_fall)


def _rises(c: Curve) -> tuple[Change, Change]:
    """First transition and first cant ramp."""
    return (
        Change(c.start_m, c.circle_start_m, c.entry_m, c.transition_kind),
        Change(c.circle_start_m - c.ramp_in_m, c.circle_start_m, c.ramp_in_m, c.transition_kind),
    )


def breakpoints_m(parameters: TrackParameters) -> np.ndarray:
    """Every place where one stretch of the line passes into another; between them the line is smooth."""
    roundings = [place for start, end, _, _ in parameters.roundings() for place in (start, end)]
    return np.unique(np.array(curve_ends(parameters.curves) + roundings, dtype=float))


def curvature_radpm(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Horizontal curvature (rad/m) at the places s (n,), which must not fall."""
    curvature = np.zeros_like(s_m)
    for b in bends(parameters.curves):
        part = slice(*np.searchsorted(s_m, [b.rise.begin_m, b.fall.end_m]))
        own = _risen(b.rise, b.fall, s_m[part]) / b.curve.radius_m
        curvature[part] = own + curvature[part] if b.curve.joins_previous else own
    return curvature


def roll_rad(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Roll of the track plane (rad, left rail up) at the places s (n,), which must not fall."""
    roll = np.zeros_like(s_m)
    for b in bends(parameters.curves):
        begin_m, end_m = b.curve.reach_m
        part = slice(*np.searchsorted(s_m, [begin_m, max(end_m, b.fall.end_m)]))
        own = _risen(b.cant_rise, b.cant_fall, s_m[part]) * b.curve.full_roll_rad
        roll[part] = own + roll[part] if b.curve.joins_previous else own
    return roll


def heading_rad(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Integral of the curvature from the begin of the line (rad) at the places s (n,), which must not fall."""
    heading = np.zeros_like(s_m)
    for curve, rise, fall, _, _ in bends(parameters.curves):
        begin, end = np.searchsorted(s_m, [rise.begin_m, fall.end_m])
        heading[begin:end] += _turned_m(rise, fall, s_m[begin:end]) / curve.radius_m
        heading[end:] += (fall.begin_m - rise.end_m + 0.5 * (rise.length_m + fall.length_m)) / curve.radius_m
    return heading


def gradient(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Gradient (tangent of the slope angle) at s of any shape: changes ramp linearly over the vertical curve."""
    places, gradients = [0.0], [parameters.initial_gradient_permille / 1000.0]
    for start, end, before, after in parameters.roundings():
        places += [start, end]
        gradients += [before, after]
    return np.interp(s_m, places, gradients)


def _risen(rise: Change, fall: Change, s_m: np.ndarray) -> np.ndarray:
    """0 before the rise, 1 from its end to the begin of the fall, 0 after that."""
    up = (s_m - rise.end_m) / rise.length_m + 1.0
    down = (fall.begin_m - s_m) / fall.length_m + 1.0
    risen, not_fallen = (
        TRANSITIONS[change.kind].share(np.clip(u, 0.0, 1.0)) for change, u in ((rise, up), (fall, down))
    )
    return np.where(up < down, risen, not_fallen)


def _turned_m(rise: Change, fall: Change, s_m: np.ndarray) -> np.ndarray:
    """Integral of curvature times radius from the begin of the rise."""
    into = TRANSITIONS[rise.kind].turned(np.clip((s_m - rise.begin_m) / rise.length_m, 0.0, 1.0))
    round_m = np.clip(s_m, rise.end_m, fall.begin_m) - rise.end_m
    out = 0.5 - TRANSITIONS[fall.kind].turned(np.clip((fall.end_m - s_m) / fall.length_m, 0.0, 1.0))
    return rise.length_m * into + round_m + fall.length_m * out
