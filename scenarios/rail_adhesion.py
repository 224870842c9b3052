"""Adhesion along the rail before and after a train: what the rails themselves offer, whoever comes."""

from dataclasses import dataclass

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.metrics import stop_span
from scenarios.schema import Scenario
from scenarios.truth import RailStream, Truth
from wheel_rail import REFERENCE_LOAD_N, REFERENCE_SPEED_MPS
from wheel_rail.adhesion_condition import rail_condition
from wheel_rail.adhesion_state import ENERGY_KEPT, SAND_KEPT, RailTables
from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.peak_adhesion import offered_adhesion
from wheel_rail.recovery import CONDITION, TAU

LEAD_M = 50.0
_STEP_M = 2.0
_MOST_PLACES = 600  # a law that takes its time is asked no more often


@dataclass(frozen=True)
class RailAdhesion:
    """Peak adhesion as found by a wheel of 68.7 kN at 100 km/h, (2, n) for left and right rail at `position_m` (n,).

    `recovers`: whether any of these places is of a kind that cleaning changes.
    """

    position_m: Array
    before: Array
    after: Array
    recovers: bool


def adhesion_along_rail(scenario: Scenario, truth: Truth) -> RailAdhesion:
    """Of the rails that the coach braked over, 50 m before and beyond included; of all it ran over without a stop.

    Measured as a scenario gives its peak adhesion: at the reference load and speed, before the wheel cleans anything.
    """
    line = Line(scenario)
    motion = truth.motion
    span = stop_span(truth)
    rows = slice(span[0], span[1] + 1) if span else slice(None)
    begin = max(float(motion.position_m[rows].min()) - line.reach_m - LEAD_M, 0.0)
    end = min(float(motion.position_m[rows].max()) + line.reach_m + LEAD_M, line.track.length_m)
    position_m = np.linspace(begin, end, min(int((end - begin) / _STEP_M) + 2, _MOST_PLACES))
    contact = line.contact.at_load(REFERENCE_LOAD_N)
    offered = []
    condition = np.empty((2, len(position_m), CONDITION))
    for kept in (truth.rail_before, truth.rail):
        _keep(line.state.table, kept)
        offered.append(
            _offered(
                position_m, line.rail, (contact.law.number, contact.law.address), contact.law.extra,
                tuple(contact.patch), contact.parameters.shear_modulus_pa, condition,
            )
        )  # fmt: skip
    return RailAdhesion(position_m, offered[0], offered[1], bool(np.any(condition[:, :, TAU] > 0.0)))


def _keep(table: Array, kept: RailStream) -> None:
    """Put the recorded state into the `table` of a RailState."""
    table[:, :, ENERGY_KEPT] = kept.energy_jpm.T
    table[:, :, SAND_KEPT] = kept.sand_gpm.T


@compiled
def _offered(
    position_m: Array, rail: RailTables, law: tuple[int, int], extra: Array, patch: Vector, shear_modulus_pa: float,
    condition: Array,
) -> Array:  # fmt: skip
    """Peak adhesion (2, n), and the rails' condition (2, n, CONDITION) that it follows from."""
    found = np.empty((2, position_m.shape[0]))
    for side in range(2):
        for k in range(position_m.shape[0]):
            here = condition[side, k]
            rail_condition(position_m[k], side, REFERENCE_SPEED_MPS, rail, here)
            found[side, k], _ = offered_adhesion(
                law[0], law[1], extra, REFERENCE_SPEED_MPS, REFERENCE_LOAD_N, patch, here, shear_modulus_pa, False
            )
    return found
