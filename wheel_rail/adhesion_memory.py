"""Friction memory: friction follows the slip speed with a delay in sliding distance.

dmu/dt = -(max(s, s0)/d_c) (mu - mu_s), s the slip speed, mu_s the steady friction at s, d_c a distance of micrometres.
Source: the friction memory of CONTACT (its user guide), after dynamic friction laws of rate and state.
"""

import math

from pydantic import BaseModel, ConfigDict, Field

from wheel_rail.compiled import Array, compiled
from wheel_rail.lane_arrays import lanes_at, put_lanes
from wheel_rail.lanes import LANES, greater
from wheel_rail.recovery import DEGRADED, FALLING_A, FALLING_B, MU0, RECOVERED

MEMORY = 2
"""Rows of the wheels' memory: friction over mu0 of degraded and recovered curve; ones for a wheel that rolls."""


class FrictionMemoryParameters(BaseModel):
    """How far a wheel slides before friction has followed a change of slip speed."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    distance_m: float = Field(gt=0.0, le=0.1, description="d_c, micrometres as a rule")
    lowest_slip_mps: float = Field(default=1e-3, gt=0.0, description="s0, slip speed that counts at least")


@compiled
def remember_friction(
    conditions: Array, memory: Array, slip_speed_mps: Array, step_s: float, distance_m: float, lowest_slip_mps: float
) -> None:
    """Advance `memory` (MEMORY, LANES) by a step at constant slip speeds (LANES,), exactly; `conditions` (CONDITION,
    LANES) before `recall_friction`."""
    slip = lanes_at(slip_speed_mps, 0)
    share = math.exp(-greater(slip, lowest_slip_mps) * (step_s / distance_m))
    for k in range(MEMORY):
        at = (DEGRADED, RECOVERED)[k]
        a = lanes_at(conditions, (at + FALLING_A) * LANES)
        steady = (1.0 - a) * math.exp(-lanes_at(conditions, (at + FALLING_B) * LANES) * slip) + a
        put_lanes(memory, k * LANES, steady + (lanes_at(memory, k * LANES) - steady) * share)


@compiled
def recall_friction(conditions: Array, memory: Array) -> None:
    """Put the remembered friction into `conditions`, whose curves no longer depend on the slip speed then."""
    for k in range(MEMORY):
        at = (DEGRADED, RECOVERED)[k]
        for w in range(LANES):
            conditions[at + MU0, w] *= memory[k, w]
            conditions[at + FALLING_A, w] = 1.0
            conditions[at + FALLING_B, w] = 0.0
