"""Spectra of track irregularities by name: how rough a railway's rails are at each wavelength.

Four quantities, in this order everywhere: longitudinal level (mean height of the two rails, up), alignment (their mean
lateral place, to the left), cross level (height of the right rail over the left one), gauge (its widening), all in m.
Spectra are one-sided: the variance is the integral over positive wave numbers W (rad/m).

ERRI B176 (ORE 1989, low and high disturbance): S = A Wc^2/((W^2 + Wr^2)(W^2 + Wc^2)) of level and alignment; of the
cross level's angle A_v b^-2 Wc^2 W^2/((W^2 + Wr^2)(W^2 + Wc^2)(W^2 + Ws^2)), here as a height; of the gauge the
same form with A_g and without b^-2.
AAR (track classes 5 and 6): S = k A Wc^2/(W^2 (W^2 + Wc^2)) of level and alignment; of cross level and gauge
4 k A_v Wc^2/((W^2 + Wc^2)(W^2 + Ws^2)) (V. K. Garg, R. V. Dukkipati, Dynamics of Railway Vehicle Systems, 1984; form
and Ws of these two are known at second hand).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

QUANTITIES = ("longitudinal_level", "alignment", "cross_level", "gauge")

Density = Callable[[np.ndarray], np.ndarray]
SpectrumName = Literal["erri-b176-low", "erri-b176-high", "aar-5", "aar-6"]

_ERRI_C, _ERRI_R, _ERRI_S = 0.8246, 0.0206, 0.4380  # rad/m
_AAR_K, _AAR_C = 0.25, 0.8245
_CM2 = 1e-4


@dataclass(frozen=True)
class Spectrum:
    """One-sided densities of the four quantities over the wave number, m^2/(rad/m)."""

    longitudinal_level: Density
    alignment: Density
    cross_level: Density
    gauge: Density

    def per_cycle(self, quantity: str, frequency_cpm: np.ndarray) -> np.ndarray:
        """Density over the spatial frequency in cycles/m, m^2/(cycle/m): 2 pi S(2 pi f)."""
        density: Density = getattr(self, quantity)
        return 2.0 * math.pi * density(2.0 * math.pi * np.asarray(frequency_cpm))


def _erri(size: float, w: np.ndarray) -> np.ndarray:
    return size * _ERRI_C**2 / ((w**2 + _ERRI_R**2) * (w**2 + _ERRI_C**2))


def _erri_difference(size: float, w: np.ndarray) -> np.ndarray:
    return _erri(size, w) * w**2 / (w**2 + _ERRI_S**2)


def _aar(size: float, w: np.ndarray) -> np.ndarray:
    return _AAR_K * size * _AAR_C**2 / (w**2 * (w**2 + _AAR_C**2))


def _aar_difference(size: float, corner: float, w: np.ndarray) -> np.ndarray:
    return 4.0 * _AAR_K * size * _AAR_C**2 / ((w**2 + _AAR_C**2) * (w**2 + corner**2))


def _erri_spectrum(vertical: float, lateral: float, gauge: float) -> Spectrum:
    return Spectrum(
        partial(_erri, vertical),
        partial(_erri, lateral),
        # height is 2 b times the angle, so that b drops out
        partial(_erri_difference, 4.0 * vertical),
        partial(_erri_difference, gauge),
    )


def _aar_spectrum(vertical_cm2: float, lateral_cm2: float, corner: float) -> Spectrum:
    difference = partial(_aar_difference, vertical_cm2 * _CM2, corner)
    return Spectrum(partial(_aar, vertical_cm2 * _CM2), partial(_aar, lateral_cm2 * _CM2), difference, difference)


SPECTRA: dict[SpectrumName, Spectrum] = {
    "erri-b176-low": _erri_spectrum(4.032e-7, 2.119e-7, 5.32e-8),
    "erri-b176-high": _erri_spectrum(1.080e-6, 6.125e-7, 1.032e-7),
    "aar-5": _aar_spectrum(0.2095, 0.0762, 0.8209),
    "aar-6": _aar_spectrum(0.0339, 0.0339, 0.4380),
}
