"""Curvature, heading, cant and gradient of a line as closed forms of the place along it."""

import numpy as np

from wheel_rail.track_parameters import Curve, TrackParameters, curve_ends
from wheel_rail.transitions import TRANSITIONS


def breakpoints_m(parameters: TrackParameters) -> np.ndarray:
    """Every place where one stretch of the line passes into another; between them the line is smooth."""
    roundings = [place for start, end, _, _ in parameters.roundings() for place in (start, end)]
    return np.unique(np.array(curve_ends(parameters.curves) + roundings, dtype=float))


def curvature_radpm(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Horizontal curvature (rad/m) at the places s (n,), which must not fall."""
    curvature = np.zeros_like(s_m)
    for c in parameters.curves:
        part = slice(*np.searchsorted(s_m, [c.start_m, c.last_m]))
        curvature[part] = _risen(c, s_m[part], c.entry_m, c.exit_m) / c.radius_m
    return curvature


def roll_rad(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Roll of the track plane (rad, left rail up) at the places s (n,), which must not fall."""
    roll = np.zeros_like(s_m)
    for c in parameters.curves:
        part = slice(*np.searchsorted(s_m, c.reach_m))
        roll[part] = _risen(c, s_m[part], c.ramp_in_m, c.ramp_out_m) * c.full_roll_rad
    return roll


def heading_rad(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Integral of the curvature from the begin of the line (rad) at the places s (n,), which must not fall."""
    heading = np.zeros_like(s_m)
    turned_before = 0.0
    for c in parameters.curves:
        begin, end = np.searchsorted(s_m, [c.start_m, c.last_m])
        heading[begin:end] = turned_before + _turned_m(c, s_m[begin:end]) / c.radius_m
        turned_before += (c.circle_end_m - c.circle_start_m + 0.5 * (c.entry_m + c.exit_m)) / c.radius_m
        heading[end:] = turned_before
    return heading


def gradient(parameters: TrackParameters, s_m: np.ndarray) -> np.ndarray:
    """Gradient (tangent of the slope angle) at s of any shape: changes ramp linearly over the vertical curve."""
    places, gradients = [0.0], [parameters.initial_gradient_permille / 1000.0]
    for start, end, before, after in parameters.roundings():
        places += [start, end]
        gradients += [before, after]
    return np.interp(s_m, places, gradients)


def _risen(c: Curve, s_m: np.ndarray, rise_m: float, fall_m: float) -> np.ndarray:
    """0 before a rise that ends where the circular part begins, 1 in it, 0 after the fall that begins at its end."""
    u = np.minimum((s_m - c.circle_start_m) / rise_m + 1.0, (c.circle_end_m - s_m) / fall_m + 1.0)
    return TRANSITIONS[c.transition_kind].share(np.clip(u, 0.0, 1.0))


def _turned_m(c: Curve, s_m: np.ndarray) -> np.ndarray:
    """Integral of curvature times radius from the begin of the curve."""
    turned = TRANSITIONS[c.transition_kind].turned
    into = turned(np.clip((s_m - c.start_m) / c.entry_m, 0.0, 1.0))
    round_m = np.clip(s_m, c.circle_start_m, c.circle_end_m) - c.circle_start_m
    out = 0.5 - turned(np.clip((c.last_m - s_m) / c.exit_m, 0.0, 1.0))
    return c.entry_m * into + round_m + c.exit_m * out
