"""Air flow through a valve by ISO 6358, and what it does to the pressure of a fixed volume.

A valve has a sonic conductance C and a critical pressure ratio b. With the upstream pressure p1, the downstream
pressure p2 and r = p2/p1, the mass flow is

    q = C rho0 p1 sqrt(T0/T1)                                    r <= b  (choked)
    q = C rho0 p1 sqrt(T0/T1) sqrt(1 - ((r - b)/(1 - b))^2)      r > b   (subsonic)

with the standard's reference atmosphere: T0 = 293.15 K, 1 bar absolute, rho0 = 1.185 kg/m3 (65 % humidity). Pressures
in this file are absolute, in bar. A volume V at the constant temperature T of the air then follows dp/dt = +-(C/V)
sqrt(T/T0) (1 bar) p1 psi(r): the time enters only through

    exchange = integral of C dt / V * sqrt(T/T0)        (C in dm3/(s bar), V in dm3: a pure number)

so a valve that opens or shuts gradually is exact with its mean conductance. The subsonic root has an infinite slope at
r = 1, where an explicit scheme chatters: writing r = b + (1 - b) sin(angle) removes the root, and the angle reaches
90 degrees (equal pressures) after a finite exchange, where it stays. Only sine and cosine of the angle are carried, and
turned by the small angles of a step.
"""

import math

import numpy as np

from wsp.compiled import compiled

REFERENCE_TEMPERATURE_K = 293.15
REFERENCE_DENSITY_KGPM3 = 1.185
ATMOSPHERE_BAR = 1.013  # also the pressure of a normal litre

_QUARTER_TURN = 0.5 * math.pi
_LARGEST_TURN = 0.1  # of one step: keeps the fourth-order emptying step below 1e-9 of the pressure


@compiled
def _sine(angle: float) -> float:
    """Sine of an angle of at most _LARGEST_TURN, to the last digit."""
    square = angle * angle
    return angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)))


@compiled
def _cosine(angle: float) -> float:
    """Cosine of an angle of at most _LARGEST_TURN, to the last digit."""
    square = angle * angle
    return 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)))


@compiled
def flow_factor(ratio: float, critical_ratio: float) -> float:
    """psi: flow over the choked one at a pressure ratio downstream/upstream of 0..1."""
    if ratio <= critical_ratio:
        return 1.0
    return np.sqrt(1.0 - ((ratio - critical_ratio) / (1.0 - critical_ratio)) ** 2)


@compiled
def mass_flow_kgps(
    conductance_dm3psbar: float, critical_ratio: float, upstream_bar: float, downstream_bar: float, upstream_k: float
) -> float:
    """Mass flow in kg/s, never negative, between pressures in bar absolute: ISO 6358, see the head of this file."""
    if downstream_bar >= upstream_bar:
        return 0.0
    warmth = np.sqrt(REFERENCE_TEMPERATURE_K / upstream_k)
    choked = 1e-3 * conductance_dm3psbar * REFERENCE_DENSITY_KGPM3 * upstream_bar * warmth
    return choked * flow_factor(downstream_bar / upstream_bar, critical_ratio)


@compiled
def pressure_filled_bar(cylinder_bar: float, source_bar: float, exchange: float, critical_ratio: float) -> float:
    """Absolute pressure of a volume after filling from a source of constant pressure source_bar >= cylinder_bar: exact.

    r grows linearly while choked, then r = b + (1 - b) sin(angle) with the angle growing by exchange/(1 - b) up to 90
    degrees.
    """
    ratio = cylinder_bar / source_bar
    if ratio >= 1.0:
        return cylinder_bar
    if ratio < critical_ratio:
        if exchange <= critical_ratio - ratio:
            return cylinder_bar + source_bar * exchange
        exchange -= critical_ratio - ratio
        ratio = critical_ratio
    subsonic = 1.0 - critical_ratio
    turn = exchange / subsonic
    if turn >= _QUARTER_TURN:
        return source_bar
    sine = (ratio - critical_ratio) / subsonic
    cosine = np.sqrt(max(0.0, 1.0 - sine * sine))
    if turn <= _LARGEST_TURN:
        turned_sine, turned_cosine = _sine(turn), _cosine(turn)
    else:
        turned_sine, turned_cosine = np.sin(turn), np.cos(turn)
    if cosine * turned_cosine <= sine * turned_sine:
        return source_bar
    sine = sine * turned_cosine + cosine * turned_sine
    # rounding must neither take air out of a cylinder that is being filled nor overfill it
    return min(source_bar, max(cylinder_bar, source_bar * (critical_ratio + subsonic * sine)))


@compiled
def pressure_emptied_bar(cylinder_bar: float, sink_bar: float, exchange: float, critical_ratio: float) -> float:
    """Absolute pressure of a volume after emptying into a sink of constant pressure sink_bar <= cylinder_bar.

    Exponential while choked (exact), then d(angle)/d(exchange) = b/(1 - b) + sin(angle) in fourth-order steps, up to
    90 degrees.
    """
    ratio = sink_bar / cylinder_bar
    if ratio >= 1.0:
        return cylinder_bar
    sine, cosine = 0.0, 1.0
    subsonic = 1.0 - critical_ratio
    if ratio < critical_ratio:
        until_subsonic = np.log(critical_ratio / ratio)
        if exchange <= until_subsonic:
            return cylinder_bar * np.exp(-exchange)
        exchange -= until_subsonic
    else:
        sine = (ratio - critical_ratio) / subsonic
        cosine = np.sqrt(max(0.0, 1.0 - sine * sine))
    offset = critical_ratio / subsonic
    steps = int(np.ceil(exchange * (offset + 1.0) / _LARGEST_TURN))
    if steps == 0:
        return cylinder_bar
    h = exchange / steps
    for _ in range(steps):
        k1 = offset + sine
        turn = 0.5 * h * k1
        k2 = offset + sine * _cosine(turn) + cosine * _sine(turn)
        turn = 0.5 * h * k2
        k3 = offset + sine * _cosine(turn) + cosine * _sine(turn)
        turn = h * k3
        k4 = offset + sine * _cosine(turn) + cosine * _sine(turn)
        turn = h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        turned_sine, turned_cosine = _sine(turn), _cosine(turn)
        if cosine * turned_cosine <= sine * turned_sine:
            return sink_bar
        sine, cosine = sine * turned_cosine + cosine * turned_sine, cosine * turned_cosine - sine * turned_sine
    return max(sink_bar, min(cylinder_bar, sink_bar / (critical_ratio + subsonic * sine)))
