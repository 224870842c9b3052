"""Equivalent conicity of a wheelset on a track, after EN 15302 (and UIC 519).

A free wheelset runs in a wave, y'' + dr(y)/(e r0) = 0 along the track. The equivalent conicity is that of the conical
wheelset whose wave of the same amplitude is as long.
"""

import numpy as np
from scipy.optimize import brentq

POINTS = 4000  # of the quadrature over half a wave


def kinematic_wavelength_m(
    lateral_displacement_m: np.ndarray,
    radius_difference_m: np.ndarray,
    amplitude_m: np.ndarray,
    wheel_radius_m: float,
    contact_spacing_m: float = 1.5,
) -> np.ndarray:
    """Length of the kinematic wave (m), one per amplitude; nan where the wheelset would not swing back.

    `radius_difference_m` (n,): left minus right at the displacements (n,), which rise; linear in between.
    `amplitude_m`: half of the way from peak to peak. With V the integral of dr/(e r0), y'^2/2 + V is constant, so the
    half wave is the integral of dy/sqrt(2 (V(peak) - V(y))) between the two peaks, where V is equal. The wheelset may
    swing about another place than the centre. Raises ValueError for amplitudes beyond the table.
    """
    y = np.asarray(lateral_displacement_m, dtype=float)
    force = np.asarray(radius_difference_m, dtype=float) / (contact_spacing_m * wheel_radius_m)
    nodes = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(y))])
    rise = np.diff(force) / np.diff(y)

    def potential(at: np.ndarray | float) -> np.ndarray:
        k = np.clip(np.searchsorted(y, at) - 1, 0, len(y) - 2)
        t = at - y[k]
        return nodes[k] + t * (force[k] + 0.5 * rise[k] * t)

    theta = np.pi * ((np.arange(POINTS) + 0.5) / POINTS - 0.5)
    amplitudes = np.atleast_1d(np.asarray(amplitude_m, dtype=float))
    lengths = np.full(amplitudes.shape, np.nan)
    for i, a in enumerate(amplitudes):
        if not 0.0 < a < 0.5 * (y[-1] - y[0]):
            raise ValueError(f"amplitude_m = {a}: must lie above 0 and below half the table, {0.5 * (y[-1] - y[0]):g}")
        middles = np.linspace(y[0] + a, y[-1] - a, 2 * len(y))
        gain = potential(middles + a) - potential(middles - a)
        turns = np.flatnonzero((gain[:-1] < 0.0) & (gain[1:] >= 0.0))
        if not turns.size:
            continue
        # of several stable places the one nearest the centre
        k = turns[np.argmin(np.abs(middles[turns]))]
        middle = brentq(
            lambda m, a=a: float(potential(m + a) - potential(m - a)), middles[k], middles[k + 1], xtol=1e-15
        )
        # y = middle + a sin(theta) takes the singularities of both peaks away
        left = float(potential(middle + a)) - potential(middle + a * np.sin(theta))
        if np.all(left > 0.0):
            lengths[i] = 2.0 * np.sum(a * np.cos(theta) / np.sqrt(2.0 * left)) * np.pi / POINTS
    return lengths


def equivalent_conicity(
    lateral_displacement_m: np.ndarray,
    radius_difference_m: np.ndarray,
    amplitude_m: np.ndarray,
    wheel_radius_m: float,
    contact_spacing_m: float = 1.5,
) -> np.ndarray:
    """Equivalent conicity tan(gamma), one per amplitude; nan where there is no wave.

    Klingel's wave of a cone is 2 pi sqrt(e r0/(2 tan gamma)) long, hence tan(gamma) = (2 pi/length)^2 e r0/2. Arguments
    as for `kinematic_wavelength_m`. EN 15302 takes the radius difference of a wheelset that is kept level.
    """
    length = kinematic_wavelength_m(
        lateral_displacement_m, radius_difference_m, amplitude_m, wheel_radius_m, contact_spacing_m
    )
    return (2.0 * np.pi / length) ** 2 * contact_spacing_m * wheel_radius_m / 2.0
