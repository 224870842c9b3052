"""Transition curves by name: how curvature and cant grow from nothing to their full value, or pass from one to another.

`share(u)` is the part of the change at the part u = 0..1 of the length, `turned(u)` its integral from 0, which is
what the heading needs, `steepest` the largest slope of `share`. All rise as they fall: share(u) + share(1 - u) = 1,
so that turned(1) = 1/2 whatever the kind, and one curve may fall as the next rises.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

Shape = Callable[[np.ndarray], np.ndarray]
TransitionKind = Literal["clothoid", "bloss", "cosine"]


@dataclass(frozen=True)
class Transition:
    """A shape on 0..1; see the module's description."""

    share: Shape
    turned: Shape
    steepest: float


TRANSITIONS: dict[TransitionKind, Transition] = {
    # curvature and cant grow linearly: kinks at both ends
    "clothoid": Transition(lambda u: 1.0 * u, lambda u: 0.5 * u**2, 1.0),
    # a cubic parabola of the curvature (A. E. Bloss, 1936): no kinks
    "bloss": Transition(lambda u: u**2 * (3.0 - 2.0 * u), lambda u: u**3 * (1.0 - 0.5 * u), 1.5),
    # half a wave
    "cosine": Transition(
        lambda u: 0.5 - 0.5 * np.cos(np.pi * u),
        lambda u: 0.5 * u - np.sin(np.pi * u) / (2.0 * np.pi),
        0.5 * math.pi,
    ),
}
