"""`rule-table`: what to do on an axle is read from a table of its slip (rows) and of its acceleration (columns)."""

from typing import Any

import numpy as np

from wsp.compiled import Record
from wsp.controllers.axle_release import still_falls
from wsp.controllers.compiled_controller import CompiledController
from wsp.controllers.interface import AXLES
from wsp.controllers.limits import command_the_rest, guarded, sighted
from wsp.controllers.records import part_of_tick, ticks
from wsp.controllers.requests import request
from wsp.controllers.rule_table_parameters import ACTIONS, COLUMNS, ROWS, RuleTableParameters
from wsp.controllers.supervision import known_reference, observe
from wsp.valves import FILL, HOLD, VENT

_FILL, _FILL_PULSES, _HOLD, _VENT_PULSES, _VENT = range(len(ACTIONS))


@part_of_tick
def _action(s: Record, c: Record, axle: int) -> int:
    """The table's action for an axle; one that is not under control yet is left alone unless it is to be vented."""
    if axle == s.relieved:
        return _VENT if s.relieved_ticks < c.relief_vent or still_falls(s, c) else _HOLD
    reference = s.reference_mps
    slip = reference - s.speed_mps[axle]
    row = 0
    while row < ROWS - 1 and slip > c.slip_offset_mps[row] + c.slip_share[row] * reference:
        row += 1
    acceleration = s.acceleration_mps2[axle] + s.deceleration_mps2
    column = 0
    while column < COLUMNS - 1 and acceleration > c.border_mps2[column]:
        column += 1
    action = c.action[row, column]
    if s.since_vent[axle] >= c.quiet and action < _VENT_PULSES:
        return _FILL
    return action


@part_of_tick
def _pulsed(s: Record, c: Record, axle: int, action: int) -> int:
    """Valve code of an action now: a pulse waits until its cycle since the last one, of either kind, is over."""
    s.since_pulse[axle] += 1
    if action == _FILL:
        return FILL
    if action == _VENT:
        s.since_pulse[axle] = 0
        return VENT
    if action == _FILL_PULSES:
        if s.since_pulse[axle] >= c.fill_cycle:
            s.since_pulse[axle] = 0
        if s.since_pulse[axle] < c.fill_pulse + c.fill_growth * c.period_s * (s.since_vent[axle] + 1):
            return FILL
    elif action == _VENT_PULSES:
        if s.since_pulse[axle] >= c.vent_cycle:
            s.since_pulse[axle] = 0
        if s.since_pulse[axle] < c.vent_pulse:
            return VENT
    return HOLD


def _tick(record: Record, t_s: float) -> int:
    """One tick, see wsp.controllers.compiled_controller."""
    s, c, inputs, output = record.state, record.constants, record.inputs, record.output
    at_work = observe(s, c, inputs)
    for axle in range(AXLES):
        if at_work and sighted(s, axle):
            output.valve[axle] = guarded(s, c, axle, _pulsed(s, c, axle, _action(s, c, axle)))
    command_the_rest(s, c, output.valve, at_work)
    output.reference_speed_mps = known_reference(s)
    request(s, c, output, at_work)
    return 0


class RuleTable(CompiledController):
    """Rule table of slip and axle acceleration, with pulsed filling and venting.

    A blind axle gets a share of what the other one of its bogie gets. The wheels' diameters are compared while
    the brake is released, so that worn wheels do not look like sliding ones. An outside reference speed replaces the
    controller's own.
    """

    Parameters = RuleTableParameters
    _tick = staticmethod(_tick)

    def _own_constants(self, p: RuleTableParameters) -> dict[str, Any]:
        times = ("fill_pulse", "fill_cycle", "vent_pulse", "vent_cycle", "relief_vent")
        return {
            "slip_offset_mps": p.slip_offset_mps,
            "slip_share": p.slip_share,
            "border_mps2": p.acceleration_mps2,
            "action": np.array([[ACTIONS.index(letter) for letter in row] for row in p.table]),
            "fill_growth": p.fill_growth,
            **{name: ticks(getattr(p, f"{name}_s"), self.period_s) for name in times},
        }

    def _own_state(self) -> dict[str, Any]:
        return {"since_pulse": np.zeros(AXLES, np.int64)}
