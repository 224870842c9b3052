"""Compiled core of the tachometers: pulse edges from the wheel's angle, and the front end that makes speeds of them.

Edge k of a wheel lies at the angle E_k = (k + e_(k mod N)) 2 pi/N; e, in pitches, holds tooth-pitch error and
eccentricity. Between two ticks the angle is the cubic Hermite polynomial of both angles and angular speeds. Turning
forward, E_k gives an edge; turning backward, the same tooth gives it a hysteresis later, as a Schmitt trigger does.

All kernels stand in one file because the compile cache watches only the file of the function that is called.
"""

import math

import numba as nb
import numpy as np

from sensors.streams import BoolArray, FloatArray, Int8Array

# Rows of the carried state (TEETH + N, 4), one column per wheelset.
ANGLE, ANGULAR_SPEED, EDGE, REFERENCE_TIME, LAST_TIME, COUNT, DIRECTION, SPEED, VALID, TICK_TIME = range(10)
# Constants stand in the same array, since every array costs time in a call: pitch on the rim in m of each wheelset; one
# row with hysteresis in rad, clock in s, time-out in s; from TEETH on, position errors of the N teeth in pitches.
# FAULT: what is wrong with a tachometer, one of the three below.
PITCH, CONSTANTS, FAULT, TEETH = 10, 11, 12, 13
SOUND, LOST, FROZEN = 0.0, 1.0, 2.0

# said although it is off: a function that leaves it open takes it from whoever calls it first
_compiled = nb.njit(cache=True, fastmath=False)


@_compiled
def _edge_angle(k: int, i: int, state: FloatArray) -> float:
    n = state.shape[0] - TEETH
    return (k + state[TEETH + k % n, i]) * (2.0 * math.pi / n)


@_compiled
def _note_edge(state: FloatArray, i: int, t_s: float, direction: float) -> None:
    """Front end, one edge: count it, or start to count anew where the wheel turned round."""
    if direction == state[DIRECTION, i]:
        state[COUNT, i] += 1.0
    else:
        state[DIRECTION, i] = direction
        state[COUNT, i] = 0.0
        state[REFERENCE_TIME, i] = t_s
        state[SPEED, i] = 0.0
    state[LAST_TIME, i] = t_s


@_compiled
def _note_tick(state: FloatArray, i: int, t_s: float, timeout_s: float) -> None:
    """Front end, one tick (M/T): pulses over the time between the edges that bound them; without new edges at most a
    pitch in the time since the last one, and zero after the time-out. A lost tachometer is not valid, a frozen one
    repeats itself."""
    if state[FAULT, i] != SOUND:
        if state[FAULT, i] == LOST:
            state[SPEED, i] = 0.0
            state[VALID, i] = 0.0
        return
    pitch_m = state[PITCH, i]
    if state[COUNT, i] > 0.0 and state[LAST_TIME, i] > state[REFERENCE_TIME, i]:
        duration_s = state[LAST_TIME, i] - state[REFERENCE_TIME, i]
        state[SPEED, i] = state[DIRECTION, i] * pitch_m * state[COUNT, i] / duration_s
        state[REFERENCE_TIME, i] = state[LAST_TIME, i]
        state[COUNT, i] = 0.0
        state[VALID, i] = 1.0
        return
    silence_s = t_s - state[LAST_TIME, i]
    if silence_s > timeout_s:
        state[SPEED, i] = 0.0
        state[VALID, i] = 1.0
    elif abs(state[SPEED, i]) * silence_s > pitch_m:
        state[SPEED, i] = state[DIRECTION, i] * pitch_m / silence_s


@_compiled
def _crossing(target: float, low: float, high: float, c1: float, c2: float, c3: float) -> float:
    """Where u (c1 + u (c2 + u c3)), monotone on [low, high], meets the target: Newton, bisection where that leaves."""
    at_low = low * (c1 + low * (c2 + low * c3)) - target
    span = high * (c1 + high * (c2 + high * c3)) - target - at_low
    u = low - at_low * (high - low) / span if span != 0.0 else high
    for _ in range(60):
        error = u * (c1 + u * (c2 + u * c3)) - target
        if (error > 0.0) == (span > 0.0):
            high = min(high, u)
        else:
            low = max(low, u)
        slope = c1 + u * (2.0 * c2 + 3.0 * c3 * u)
        new = u - error / slope if slope != 0.0 else low - 1.0
        if abs(new - u) < 1e-5:  # Newton squares it: the new place is good to 1e-10 of a tick of 10 ms, a picosecond
            return min(max(new, low), high)
        u = new if low <= new <= high else 0.5 * (low + high)
    return u


@_compiled
def _latched(t_s: float, earliest_s: float, tick_s: float, clock_s: float) -> float:
    """Time by the counter's clock: the next clock edge, inside (earliest, tick] so that no edge changes tick."""
    latched = math.ceil(t_s / clock_s) * clock_s
    if latched <= earliest_s:
        latched += clock_s
    return min(latched, tick_s)


@_compiled
def _start(t_s: float, i: int, state: FloatArray, edges: FloatArray, count: int) -> int:
    """First tick: the wheel is taken to have turned evenly before; its last two edges are put in."""
    n = state.shape[0] - TEETH
    angle, speed = state[ANGLE, i], state[ANGULAR_SPEED, i]
    k = math.floor(angle * n / (2.0 * math.pi))
    while _edge_angle(k, i, state) > angle:
        k -= 1
    while _edge_angle(k + 1, i, state) <= angle:
        k += 1
    state[EDGE, i] = k
    if speed == 0.0:
        return count
    direction = 1.0 if speed > 0.0 else -1.0
    for back in (1, 0):
        edge = k - back if speed > 0.0 else k + 1 + back
        edge_t_s = t_s - (angle - _edge_angle(edge, i, state)) / speed
        if t_s - edge_t_s <= state[CONSTANTS, 2] and state[FAULT, i] == SOUND:
            edges[count, 0] = edge_t_s
            edges[count, 1] = direction * (i + 1)
            count += 1
            _note_edge(state, i, edge_t_s, direction)
    return count


@_compiled
def advance(
    t_s: float,
    angle_rad: FloatArray,
    angular_speed_radps: FloatArray,
    state: FloatArray,
    edges: FloatArray,
    count: int,
) -> int:
    """Edges and speeds of one tick; the new number of edges, or -1 if they would overflow their array.

    `edges` (m, 2): time, and wheelset 1..4 with the sign of the direction.
    """
    hysteresis, clock_s, timeout_s = state[CONSTANTS, 0], state[CONSTANTS, 1], state[CONSTANTS, 2]
    room = edges.shape[0]
    for i in range(4):
        angle0, speed0, before_s = state[ANGLE, i], state[ANGULAR_SPEED, i], state[TICK_TIME, i]
        speed1 = angular_speed_radps[i]
        state[ANGLE, i], state[ANGULAR_SPEED, i], state[TICK_TIME, i] = angle_rad[i], speed1, t_s
        if math.isnan(before_s):
            count = _start(t_s, i, state, edges, count)
            _note_tick(state, i, t_s, timeout_s)
            continue
        turned = angle_rad[i] - angle0
        period_s = t_s - before_s
        c1 = speed0 * period_s
        c2 = 3.0 * turned - (2.0 * speed0 + speed1) * period_s
        c3 = -2.0 * turned + (speed0 + speed1) * period_s
        # The derivative c1 + 2 c2 u + 3 c3 u^2 may change sign twice: cut there into monotone pieces. It cannot where
        # |c1| is larger than the rest together, which is every rolling wheel.
        bend = 2.0 * abs(c2) + 3.0 * abs(c3)
        turn_a, turn_b = 1.0, 1.0
        discriminant = c2 * c2 - 3.0 * c3 * c1
        if abs(c1) <= bend and discriminant > 0.0:
            q = -(c2 + math.copysign(math.sqrt(discriminant), c2))
            root_a = q / (3.0 * c3) if c3 != 0.0 else 1.0
            root_b = c1 / q if q != 0.0 else 1.0
            turn_a = root_a if 0.0 < root_a < 1.0 else 1.0
            turn_b = root_b if 0.0 < root_b < 1.0 else 1.0
            if turn_a > turn_b:
                turn_a, turn_b = turn_b, turn_a
        k = int(state[EDGE, i])
        start = 0.0
        start_turned = 0.0
        earliest_s = before_s
        for piece in range(3):
            end = turn_a if piece == 0 else (turn_b if piece == 1 else 1.0)
            if end <= start:
                continue
            end_turned = end * (c1 + end * (c2 + end * c3)) if end < 1.0 else turned
            forward = end_turned > start_turned
            u = start
            even = bend < 0.02 * abs(c1)
            while True:
                # Angles are counted from the tick's start: after 100 km they are large, and their rounding with them.
                target = _edge_angle(k + 1 if forward else k, i, state) - angle0
                if not forward:
                    target -= hysteresis
                if (forward and target > end_turned) or (not forward and target <= end_turned):
                    break
                if count >= room:
                    return -1
                if even:
                    # A chord and two steps with one slope leave 1e-9 of the tick; the general search costs thrice that.
                    u = target / turned
                    slope = 1.0 / (c1 + u * (2.0 * c2 + 3.0 * c3 * u))
                    u -= (u * (c1 + u * (c2 + u * c3)) - target) * slope
                    u -= (u * (c1 + u * (c2 + u * c3)) - target) * slope
                else:
                    u = _crossing(target, u, end, c1, c2, c3)
                earliest_s = _latched(before_s + u * period_s, earliest_s, t_s, clock_s)
                if state[FAULT, i] == SOUND:
                    edges[count, 0] = earliest_s
                    edges[count, 1] = i + 1 if forward else -(i + 1)
                    count += 1
                    _note_edge(state, i, earliest_s, 1.0 if forward else -1.0)
                k += 1 if forward else -1
            start, start_turned = end, end_turned
        state[EDGE, i] = k
        _note_tick(state, i, t_s, timeout_s)
    return count


@_compiled
def speeds_of_edges(
    tick_s: FloatArray, edge_t: FloatArray, wheelset: Int8Array, direction: Int8Array, state: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """The same front end over recorded edges: speeds (n, 4) and validity (n, 4) at the ticks."""
    speed = np.empty((tick_s.shape[0], 4))
    valid = np.zeros((tick_s.shape[0], 4), np.bool_)
    e = 0
    for k in range(tick_s.shape[0]):
        while e < edge_t.shape[0] and edge_t[e] <= tick_s[k]:
            _note_edge(state, wheelset[e] - 1, edge_t[e], float(direction[e]))
            e += 1
        for i in range(4):
            _note_tick(state, i, tick_s[k], state[CONSTANTS, 2])
            speed[k, i] = state[SPEED, i]
            valid[k, i] = state[VALID, i] > 0.0
    return speed, valid
