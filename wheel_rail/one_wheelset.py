"""The contact of one wheelset alone, for looking at it outside of a coach."""

import numpy as np
from numpy.typing import ArrayLike

from wheel_rail.compiled import Array
from wheel_rail.contact import (
    AXLE,
    CARRIER_RATE,
    FRAME,
    GROWTH,
    PLACE,
    REPORT,
    SPIN,
    VELOCITY,
    WHEEL,
    wheel_contacts,
)
from wheel_rail.lanes import LANES


def wheelset_contact(
    position_m: ArrayLike, axle: ArrayLike, velocity_mps: ArrayLike, carrier_rate_radps: ArrayLike, spin_radps: float,
    frame: ArrayLike, constants: np.ndarray, condition: ArrayLike, growth: tuple[float, float] = (0.0, 0.0),
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Normal force (2, 7), creep force (2, 7) and report (2, REPORT) of the left and the right wheel.

    `position_m`, `velocity_mps` (3,): the wheelset's centre in the world; `axle` (3,): unit vector to the left;
    `carrier_rate_radps` (3,): without its part along the axle; `frame` (14,) the track there; `condition` (CONDITION,)
    of both rails; `growth`: radius over the nominal one (m), its change as the wheel turns (m/rad). Results as in
    `wheel_contacts`.
    """
    wheels = np.zeros((WHEEL, LANES))
    rows = ((PLACE, position_m), (AXLE, axle), (VELOCITY, velocity_mps), (CARRIER_RATE, carrier_rate_radps),
            (SPIN, spin_radps), (GROWTH, growth), (FRAME, frame))  # fmt: skip
    for first, values in rows:
        column = np.atleast_1d(np.asarray(values, dtype=float))
        wheels[first : first + len(column)] = column[:, None]
    normal, creep, report = np.zeros((7, LANES)), np.zeros((7, LANES)), np.zeros((REPORT, LANES))
    conditions = np.repeat(np.asarray(condition, dtype=float)[:, None], LANES, axis=1)
    wheel_contacts(wheels, constants[()], conditions, normal, creep, report)
    return normal.T[:2], creep.T[:2], report.T[:2]
