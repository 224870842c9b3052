"""Air flow through a valve by ISO 6358, and what it does to the pressure of a brake cylinder of fixed volume.

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
90 degrees (equal pressures) after a finite exchange, where it stays.
"""

import math

import numpy as np
from numba import njit

REFERENCE_TEMPERATURE_K = 293.15
REFERENCE_DENSITY_KGPM3 = 1.185
ATMOSPHERE_BAR = 1.013  # also the pressure of a normal litre

_QUARTER_TURN = 0.5 * math.pi
_LARGEST_EXCHANGE_STEP = 0.05  # keeps the fourth-order emptying step below 1e-9 of the pressure


@njit(cache=True)
def mass_flow_kgps(
    conductance_dm3psbar: float, critical_ratio: float, upstream_bar: float, downstream_bar: float, upstream_k: float
) -> float:
    """Mass flow in kg/s, never negative, between pressures in bar absolute: ISO 6358, see the head of this file."""
    if downstream_bar >= upstream_bar:
        return 0.0
    warmth = np.sqrt(REFERENCE_TEMPERATURE_K / upstream_k)
    choked = 1e-3 * conductance_dm3psbar * REFERENCE_DENSITY_KGPM3 * upstream_bar * warmth
    ratio = downstream_bar / upstream_bar
    if ratio <= critical_ratio:
        return choked
    return choked * np.sqrt(1.0 - ((ratio - critical_ratio) / (1.0 - critical_ratio)) ** 2)


@njit(cache=True)
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
    angle = np.arcsin((ratio - critical_ratio) / subsonic) + exchange / subsonic
    if angle >= _QUARTER_TURN:
        return source_bar
    # rounding must neither take air out of a cylinder that is being filled nor overfill it
    return min(source_bar, max(cylinder_bar, source_bar * (critical_ratio + subsonic * np.sin(angle))))


@njit(cache=True)
def pressure_emptied_bar(cylinder_bar: float, sink_bar: float, exchange: float, critical_ratio: float) -> float:
    """Absolute pressure of a volume after emptying into a sink of constant pressure sink_bar <= cylinder_bar.

    Exponential while choked (exact), then d(angle)/d(exchange) = (b + (1 - b) sin(angle))/(1 - b) in fourth-order
    steps, up to 90 degrees.
    """
    ratio = sink_bar / cylinder_bar
    if ratio >= 1.0:
        return cylinder_bar
    angle = 0.0
    subsonic = 1.0 - critical_ratio
    if ratio < critical_ratio:
        until_subsonic = np.log(critical_ratio / ratio)
        if exchange <= until_subsonic:
            return cylinder_bar * np.exp(-exchange)
        exchange -= until_subsonic
    else:
        angle = np.arcsin((ratio - critical_ratio) / subsonic)
    steps = int(np.ceil(exchange / _LARGEST_EXCHANGE_STEP))
    if steps == 0:
        return cylinder_bar
    h = exchange / steps
    offset = critical_ratio / subsonic
    for _ in range(steps):
        k1 = offset + np.sin(angle)
        k2 = offset + np.sin(angle + 0.5 * h * k1)
        k3 = offset + np.sin(angle + 0.5 * h * k2)
        k4 = offset + np.sin(angle + h * k3)
        angle += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        if angle >= _QUARTER_TURN:
            return sink_bar
    return max(sink_bar, min(cylinder_bar, sink_bar / (critical_ratio + subsonic * np.sin(angle))))
