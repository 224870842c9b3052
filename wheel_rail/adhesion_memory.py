"""Friction memory: friction follows the slip speed with a delay in sliding distance.

dmu/dt = -(max(s, s0)/d_c) (mu - mu_s), s the slip speed, mu_s the steady friction at s, d_c a distance of micrometres.
Source: the friction memory of CONTACT (its user guide), after dynamic friction laws of rate and state.
"""

import math

from pydantic import BaseModel, ConfigDict, Field

from wheel_rail.compiled import Array, compiled
from wheel_rail.recovery import DEGRADED, FALLING_A, FALLING_B, MU0, RECOVERED

MEMORY = 2
"""A wheel's memory: friction over mu0 of the degraded and of the recovered curve; ones for a wheel that rolls."""


class FrictionMemoryParameters(BaseModel):
    """How far a wheel slides before friction has followed a change of slip speed."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    distance_m: float = Field(gt=0.0, le=0.1, description="d_c, micrometres as a rule")
    lowest_slip_mps: float = Field(default=1e-3, gt=0.0, description="s0, slip speed that counts at least")


@compiled
def remember_friction(
    condition: Array, memory: Array, slip_speed_mps: float, step_s: float, distance_m: float, lowest_slip_mps: float
) -> None:
    """Advance `memory` (MEMORY,) by a step at constant slip speed, exactly; `condition` before `recall_friction`."""
    share = math.exp(-max(slip_speed_mps, lowest_slip_mps) * step_s / distance_m)
    for k in range(MEMORY):
        at = (DEGRADED, RECOVERED)[k]
        a = condition[at + FALLING_A]
        steady = (1.0 - a) * math.exp(-condition[at + FALLING_B] * slip_speed_mps) + a
        memory[k] = steady + (memory[k] - steady) * share


@compiled
def recall_friction(condition: Array, memory: Array) -> None:
    """Put the remembered friction into `condition`, whose curves no longer depend on the slip speed then."""
    for k in range(MEMORY):
        at = (DEGRADED, RECOVERED)[k]
        condition[at + MU0] *= memory[k]
        condition[at + FALLING_A] = 1.0
        condition[at + FALLING_B] = 0.0
