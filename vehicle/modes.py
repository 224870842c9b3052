"""Modes of the coach on straight level track: undamped ones, and those with dampers and creep at a speed."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig, eigh

from vehicle.layout import SPIN
from vehicle.linear import LinearCoach, Linearisation
from vehicle.mode_names import mode_name, unique_names
from vehicle.parameters import CoachParameters

RIGID_HZ = 0.05
"""Modes below are rigid motions: rolling along, and drifting between the rails."""


@dataclass(frozen=True)
class Mode:
    """An undamped mode: frequency, and the shape over the coordinates without the spins, of unit modal mass."""

    frequency_hz: float
    shape: np.ndarray
    name: str


@dataclass(frozen=True)
class DampedMode:
    """A swing exp(rate t) of the coach: `rate` = -decay + i circular frequency, 1/s; complex shape (n,), unit mass."""

    rate: complex
    shape: np.ndarray
    name: str

    @property
    def frequency_hz(self) -> float:
        """Of the swing itself, not of the undamped one."""
        return self.rate.imag / (2.0 * np.pi)

    @property
    def damping_ratio(self) -> float:
        """Share of the critical damping; negative where the swing grows."""
        return -self.rate.real / abs(self.rate)


def undamped_modes(parameters: CoachParameters, speed_mps: float = 20.0) -> list[Mode]:
    """Modes of the bodies by rising frequency, rigid motions left out.

    The part of the stiffness that is not symmetric (creep forces) does not belong to modes and is left out.
    """
    linear = Linearisation(parameters).at(speed_mps)
    kept = np.r_[0:SPIN, SPIN + 4 : len(linear.mass)]
    mass, stiffness = linear.mass[np.ix_(kept, kept)], linear.stiffness[np.ix_(kept, kept)]
    squared, shapes = eigh(0.5 * (stiffness + stiffness.T), mass)
    frequencies, found, names = [], [], []
    for w2, shape in zip(squared, shapes.T, strict=True):
        if w2 > (2.0 * np.pi * RIGID_HZ) ** 2:
            whole = np.zeros(len(linear.mass))
            whole[kept] = shape
            names.append(mode_name(whole, np.diag(linear.mass), 1j * np.sqrt(w2), 0.0))
            frequencies.append(float(np.sqrt(w2) / (2.0 * np.pi)))
            found.append(shape)
    return [Mode(*of) for of in zip(frequencies, found, unique_names(names), strict=True)]


def damped_modes(linear: LinearCoach) -> list[DampedMode]:
    """The swings of the linearised coach by rising frequency; what creeps back without swinging is left out."""
    n = len(linear.mass)
    mass = np.diag(linear.mass)
    rates, shapes = eig(linear.state_matrix)
    kept = np.flatnonzero(rates.imag > 2.0 * np.pi * RIGID_HZ)
    kept = kept[np.argsort(rates[kept].imag)]
    found = []
    for k in kept:
        shape = shapes[:n, k]
        weighted = np.sqrt(mass) * shape
        # unit modal mass, and the coordinate with most energy real
        scale = np.linalg.norm(weighted) * np.exp(1j * np.angle(weighted[np.argmax(np.abs(weighted))]))
        found.append(shape / scale)
    names = [mode_name(shape, mass, rates[k], linear.speed_mps) for k, shape in zip(kept, found, strict=True)]
    return [
        DampedMode(complex(rates[k]), shape, name)
        for k, shape, name in zip(kept, found, unique_names(names), strict=True)
    ]


def bounce_frequencies_hz(parameters: CoachParameters) -> tuple[float, float]:
    """Frequencies of carbody bounce and of bogie bounce (both bogies in phase).

    The mode in which the carbody's, or the sum of the bogies', vertical motion carries most of the modal mass.
    """
    modes = undamped_modes(parameters)
    body = max(modes, key=lambda mode: abs(mode.shape[2]))
    bogies = max(modes, key=lambda mode: abs(mode.shape[8] + mode.shape[14]))
    return body.frequency_hz, bogies.frequency_hz
