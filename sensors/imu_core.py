"""Compiled stepper of the IMU mask, with carried state: row after row of the truth, a reading every `ratio` rows."""

import math

import numba as nb
import numpy as np

from sensors.streams import FloatArray

# Carried state: whether it has begun (nan before), drift of the six axes, two delays of the low-pass per axis.
_DRIFT = 1
_DELAYS = _DRIFT + 6
STATE_SIZE = _DELAYS + 12


@nb.njit(cache=True)
def _interpolated(at: float, x: FloatArray, y: FloatArray) -> float:
    """Straight between points, level beyond them."""
    if at <= x[0]:
        return y[0]
    for i in range(1, x.shape[0]):
        if at < x[i]:
            return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1])
    return y[-1]


@nb.njit(cache=True)
def _sensed(
    force: FloatArray, rate: FloatArray, alpha: FloatArray, arm: FloatArray, rotation: FloatArray, out: FloatArray
) -> None:
    """Specific force f + alpha x r + w x (w x r) and rate at the sensing point, in sensor axes, into out (6,)."""
    spin = rate[0] * arm[0] + rate[1] * arm[1] + rate[2] * arm[2]
    square = rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2]
    x = force[0] + alpha[1] * arm[2] - alpha[2] * arm[1] + rate[0] * spin - square * arm[0]
    y = force[1] + alpha[2] * arm[0] - alpha[0] * arm[2] + rate[1] * spin - square * arm[1]
    z = force[2] + alpha[0] * arm[1] - alpha[1] * arm[0] + rate[2] * spin - square * arm[2]
    for i in range(3):
        out[i] = rotation[i, 0] * x + rotation[i, 1] * y + rotation[i, 2] * z
        out[3 + i] = rotation[i, 0] * rate[0] + rotation[i, 1] * rate[1] + rotation[i, 2] * rate[2]


@nb.njit(cache=True)
def process(
    t_s: FloatArray, force: FloatArray, rate: FloatArray, alpha: FloatArray, arm: FloatArray, rotation: FloatArray,
    low_pass: FloatArray, first: int, ratio: int, gain: FloatArray, offset: FloatArray, terms: FloatArray,
    profile: FloatArray, curves: tuple[FloatArray, FloatArray], white: FloatArray, drift: FloatArray, state: FloatArray,
) -> FloatArray:  # fmt: skip
    """Readings (m, 7) of the rows `first`, `first + ratio`, ... of the chunk: specific force, rate, temperature."""
    readings = np.empty((white.shape[0], 7))
    b0, b1, b2, a1, a2, kelvin = low_pass
    sensed = np.empty(6)
    smooth = np.empty(6)
    m = 0
    for k in range(t_s.shape[0]):
        _sensed(force[k], rate[k], alpha[k], arm, rotation, sensed)
        begin = math.isnan(state[0])
        for i in range(6):
            d = _DELAYS + 2 * i
            if begin:  # as if the first row had lasted for ever: no transient of the filter
                state[d] = (1.0 - b0) * sensed[i]
                state[d + 1] = (b2 - a2) * sensed[i]
            smooth[i] = b0 * sensed[i] + state[d]
            state[d] = b1 * sensed[i] - a1 * smooth[i] + state[d + 1]
            state[d + 1] = b2 * sensed[i] - a2 * smooth[i]
        state[0] = 1.0
        if k < first or (k - first) % ratio != 0:
            continue
        temperature = _interpolated(t_s[k], profile[0], profile[1])
        for triad in range(2):
            curve = curves[0] if triad == 0 else curves[1]
            sigma, decay, drive, drift_sd, count, limit = terms[triad]
            for i in range(3):
                axis = 3 * triad + i
                if m == 0 and begin:
                    state[_DRIFT + axis] = drift_sd * drift[m, axis]
                else:
                    state[_DRIFT + axis] = decay * state[_DRIFT + axis] + drive * drift[m, axis]
                value = offset[triad, i] + state[_DRIFT + axis] + _interpolated(temperature, curve[0], curve[1 + i])
                for j in range(3):
                    value += gain[triad, i, j] * smooth[3 * triad + j]
                value += sigma * white[m, axis]
                if count > 0.0:
                    value = count * np.rint(value / count)
                readings[m, axis] = min(max(value, -limit), limit)
        readings[m, 6] = kelvin * np.rint(temperature / kelvin) if kelvin > 0.0 else temperature
        m += 1
    return readings
