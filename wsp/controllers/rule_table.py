"""`rule-table`: what to do on an axle is read from a table of its slip (rows) and of its acceleration (columns)."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from wsp.axle_speed import compare_wheels, fading_memory_after
from wsp.controllers.interface import AXLES, ControllerOutput
from wsp.controllers.rule_table_parameters import ACTIONS, COLUMNS, ROWS, RuleTableParameters
from wsp.reference_speed import reference_after
from wsp.valves import FILL, HOLD, VENT

_FILL, _FILL_PULSES, _HOLD, _VENT_PULSES, _VENT = range(len(ACTIONS))

# State: per axle speed, acceleration, ticks since the last pulse began, ticks since the last vent, ticks unfilled,
# ticks of forced filling left, wheel ratio; then the train's.
_SPEED, _ACCELERATION, _SINCE_PULSE, _SINCE_VENT, _UNFILLED, _FORCED, _RATIO = range(0, 7 * AXLES, AXLES)
_REFERENCE, _DECELERATION, _STARTED, _COMPARED = range(7 * AXLES, 7 * AXLES + 4)
_STATE_SIZE = 7 * AXLES + 4

_OFFSET, _SHARE, _BORDER, _ACTION = 0, 3, 6, 10
(
    _PERIOD, _MEMORY, _FILL_ON, _FILL_CYCLE, _FILL_GROWTH, _VENT_ON, _VENT_CYCLE, _QUIET, _CUT_OFF, _WATCHDOG, _REFILL,
    _ABOVE, _BELOW, _COMPARE, _DIFFERENCE, _MARGIN, _MARGIN_WORK, _JERK, _JERK_WORK, _FALL, _DECLINE, _GAIN, _RISE,
) = range(_ACTION + ROWS * COLUMNS, _ACTION + ROWS * COLUMNS + 23)  # fmt: skip


@njit(cache=True)
def _follow_axles(
    s: NDArray[np.float64],
    c: NDArray[np.float64],
    axle_speed_mps: NDArray[np.float64],
    valid: NDArray[np.bool_],
    direction: int,
) -> float:
    """Filter the axle speeds (nan where not valid) and return the fastest."""
    fastest = np.nan
    for axle in range(AXLES):
        measured = max(0.0, direction * axle_speed_mps[axle] / s[_RATIO + axle])
        if not valid[axle] or np.isnan(axle_speed_mps[axle]):
            s[_SPEED + axle] = np.nan
            continue
        if np.isnan(s[_SPEED + axle]):
            s[_SPEED + axle] = measured
            s[_ACCELERATION + axle] = -s[_DECELERATION]
        else:
            s[_SPEED + axle], s[_ACCELERATION + axle] = fading_memory_after(
                s[_SPEED + axle], s[_ACCELERATION + axle], measured, c[_MEMORY], c[_PERIOD]
            )
        if not s[_SPEED + axle] <= fastest:
            fastest = s[_SPEED + axle]
    return fastest


@njit(cache=True)
def _follow_train(s: NDArray[np.float64], c: NDArray[np.float64], fastest_mps: float, outside_mps: float) -> None:
    """Reference speed and deceleration one tick on; an outside speed replaces the fastest axle's and is taken as is."""
    if not np.isnan(outside_mps):
        fastest_mps = abs(outside_mps)
    if s[_STARTED] == 0.0:
        if np.isnan(fastest_mps):
            return
        s[_STARTED] = 1.0
        s[_REFERENCE] = fastest_mps
    margin, jerk = c[_MARGIN], c[_JERK]
    for axle in range(AXLES):
        if s[_SINCE_VENT + axle] < c[_QUIET]:
            margin, jerk = c[_MARGIN_WORK], c[_JERK_WORK]
    s[_REFERENCE], s[_DECELERATION] = reference_after(
        s[_REFERENCE],
        s[_DECELERATION],
        fastest_mps,
        c[_PERIOD],
        margin,
        jerk,
        (c[_FALL], c[_DECLINE], c[_GAIN], c[_RISE]),
    )
    if not np.isnan(outside_mps):
        s[_REFERENCE] = fastest_mps


@njit(cache=True)
def _action(s: NDArray[np.float64], c: NDArray[np.float64], axle: int) -> int:
    """The table's action for an axle; one that is not under control yet is left alone unless it is to be vented."""
    reference = s[_REFERENCE]
    slip = reference - s[_SPEED + axle]
    row = 0
    while row < ROWS - 1 and slip > c[_OFFSET + row] + c[_SHARE + row] * reference:
        row += 1
    acceleration = s[_ACCELERATION + axle] + s[_DECELERATION]
    column = 0
    while column < COLUMNS - 1 and acceleration > c[_BORDER + column]:
        column += 1
    action = int(c[_ACTION + row * COLUMNS + column])
    if s[_SINCE_VENT + axle] >= c[_QUIET] and action < _VENT_PULSES:
        return _FILL
    return action


@njit(cache=True)
def _pulsed(s: NDArray[np.float64], c: NDArray[np.float64], axle: int, action: int) -> int:
    """Valve code of an action now: a pulse waits until its cycle since the last one, of either kind, is over."""
    s[_SINCE_PULSE + axle] += 1.0
    s[_SINCE_VENT + axle] += 1.0
    code = HOLD
    if action == _FILL:
        code = FILL
    elif action == _VENT:
        code = VENT
        s[_SINCE_PULSE + axle] = 0.0
    elif action == _FILL_PULSES:
        if s[_SINCE_PULSE + axle] >= c[_FILL_CYCLE]:
            s[_SINCE_PULSE + axle] = 0.0
        if s[_SINCE_PULSE + axle] < c[_FILL_ON] + c[_FILL_GROWTH] * c[_PERIOD] * s[_SINCE_VENT + axle]:
            code = FILL
    elif action == _VENT_PULSES:
        if s[_SINCE_PULSE + axle] >= c[_VENT_CYCLE]:
            s[_SINCE_PULSE + axle] = 0.0
        if s[_SINCE_PULSE + axle] < c[_VENT_ON]:
            code = VENT
    if code == VENT:
        s[_SINCE_VENT + axle] = 0.0
    return code


@njit(cache=True)
def _guarded(s: NDArray[np.float64], c: NDArray[np.float64], axle: int, code: int) -> int:
    """Watchdog: a brake that was vented and not filled since is given back when the limit is reached."""
    if s[_FORCED + axle] > 0.0:
        s[_FORCED + axle] -= 1.0
        return FILL
    if code == FILL:
        s[_UNFILLED + axle] = 0.0
    elif code == VENT or s[_UNFILLED + axle] > 0.0:
        s[_UNFILLED + axle] += 1.0
        if s[_UNFILLED + axle] > c[_WATCHDOG]:
            s[_UNFILLED + axle] = 0.0
            s[_FORCED + axle] = c[_REFILL] - 1.0
            return FILL
    return code


@njit(cache=True)
def _compare(
    s: NDArray[np.float64], c: NDArray[np.float64], axle_speed_mps: NDArray[np.float64], valid: NDArray[np.bool_]
) -> None:
    """Compare the wheels while they roll freely: a running mean at first, then one that fades."""
    if not valid.all() or s[_REFERENCE] < c[_ABOVE] or abs(s[_DECELERATION]) > c[_BELOW]:
        return
    s[_COMPARED] = min(s[_COMPARED] + 1.0, c[_COMPARE])
    compare_wheels(s[_RATIO : _RATIO + AXLES], axle_speed_mps, 1.0 / s[_COMPARED], c[_DIFFERENCE])


@njit(cache=True)
def _tick(
    s: NDArray[np.float64],
    c: NDArray[np.float64],
    valve: NDArray[np.int8],
    axle_speed_mps: NDArray[np.float64],
    valid: NDArray[np.bool_],
    demand: float,
    direction: int,
    outside_mps: float,
) -> float:
    """One tick: fills in the valve codes and returns the reference speed (nan before the first speed came)."""
    if demand <= 0.0:
        _compare(s, c, axle_speed_mps, valid)
    _follow_train(s, c, _follow_axles(s, c, axle_speed_mps, valid, direction), outside_mps)
    off = demand <= 0.0 or s[_STARTED] == 0.0 or s[_REFERENCE] < c[_CUT_OFF]
    for axle in range(AXLES):
        if off or np.isnan(s[_SPEED + axle]):
            s[_SINCE_VENT + axle] = c[_QUIET]
            s[_UNFILLED + axle] = 0.0
            s[_FORCED + axle] = 0.0
            valve[axle] = FILL
        else:
            valve[axle] = _guarded(s, c, axle, _pulsed(s, c, axle, _action(s, c, axle)))
    return s[_REFERENCE] if s[_STARTED] != 0.0 else np.nan


class RuleTable:
    """Rule table over the four axles, with its own reference speed, pulsed refilling, cut-off and watchdog.

    An axle whose speed is not valid is left to the driver's brake. The wheels' diameters are compared while the brake
    is released, so that worn wheels do not look like sliding ones. An outside reference speed replaces the
    controller's own.
    """

    Parameters = RuleTableParameters
    period_s = 0.01

    def __init__(self, parameters: RuleTableParameters) -> None:
        self.parameters = parameters
        self._output = ControllerOutput()
        self._state = np.zeros(_STATE_SIZE)
        self._constants = self._packed(parameters)
        self.reset(0.0, 1)

    def _packed(self, p: RuleTableParameters) -> NDArray[np.float64]:
        def ticks(time_s: float) -> float:
            return float(max(1, round(time_s / self.period_s)))

        r = p.reference
        actions = [float(ACTIONS.index(letter)) for row in p.table for letter in row]
        return np.array([
            *p.slip_offset_mps, *p.slip_share, *p.acceleration_mps2, *actions,
            self.period_s, math.exp(-self.period_s / p.filter_time_s), ticks(p.fill_pulse_s), ticks(p.fill_cycle_s),
            p.fill_growth, ticks(p.vent_pulse_s), ticks(p.vent_cycle_s), ticks(p.quiet_s), p.cut_off_mps,
            ticks(p.watchdog_s), ticks(p.watchdog_refill_s), p.compare_above_mps, p.compare_below_mps2,
            ticks(p.compare_memory_s), p.largest_wheel_difference, r.fall_margin_mps2, r.fall_margin_at_work_mps2,
            r.jerk_limit_mps3, r.jerk_limit_at_work_mps3, r.fall_limit_mps2, r.jerk_decline_mps3, r.jerk_gain_ps2,
            r.rise_limit_mps2,
        ])  # fmt: skip

    def reset(self, t_s: float, direction: int) -> None:
        """Forget speeds, wheel ratios and what was done to the brakes."""
        self._state[:] = 0.0
        self._state[_SPEED : _SPEED + AXLES] = np.nan
        self._state[_RATIO : _RATIO + AXLES] = 1.0
        self._state[_SINCE_VENT : _SINCE_VENT + AXLES] = self._constants[_QUIET]
        self._output.valve[:] = FILL
        self._output.reference_speed_mps = np.nan

    def step(
        self,
        t_s: float,
        axle_speed_mps: NDArray[np.float64],
        valid: NDArray[np.bool_],
        demand: float,
        direction: int,
        outside_reference_mps: float,
    ) -> ControllerOutput:
        """One tick of 10 ms, see wsp.controllers.Controller; the same output object is returned each time."""
        output = self._output
        output.reference_speed_mps = _tick(
            self._state, self._constants, output.valve, axle_speed_mps, valid, demand, direction, outside_reference_mps
        )
        return output
