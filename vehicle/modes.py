"""Linearised coach and its undamped modes, on straight level track."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from vehicle.forces import coach_force
from vehicle.layout import SPIN, masses
from vehicle.parameters import CoachParameters
from vehicle.start import start_state
from wheel_rail import Adhesion, AdhesionParameters, Contact, RailState, Track, TrackParameters

_STEP_M = 1e-6
_STRAIGHT_M = 200.0


@dataclass(frozen=True)
class Mode:
    """An undamped mode: frequency, and the shape over all coordinates, without spin, of unit modal mass."""

    frequency_hz: float
    shape: np.ndarray


def stiffness_matrix(parameters: CoachParameters, speed_mps: float) -> tuple[np.ndarray, np.ndarray]:
    """Mass and stiffness matrices (coordinates, coordinates) about steady running: K = -df/dq by central differences.

    Rotations are about the bodies' axes; gravity, preloads and contact stiffness are in, forces by speed are not.
    """
    contact = Contact(parameters.contact, 0.5 * parameters.wheelset.wheel_diameter_m, parameters.static_wheel_load_n)
    track = Track(TrackParameters(length_m=_STRAIGHT_M))
    dry = AdhesionParameters.model_validate({"stretches": [{"from_m": 0.0, "surface": "dry", "peak_adhesion": 0.3}]})
    rail = Adhesion(dry, _STRAIGHT_M, contact, np.random.default_rng(0)).tables(RailState(_STRAIGHT_M))
    record, q, v = start_state(parameters, contact, track, rail, 0.5 * _STRAIGHT_M, speed_mps)
    coach = record[0]

    def force(at: np.ndarray) -> np.ndarray:
        f = np.empty(len(q))
        coach_force(at, v, f, record, track.table, rail)
        return f

    stiffness = np.empty((len(q), len(q)))
    for j in range(len(q)):
        step = np.zeros(len(q))
        step[j] = _STEP_M
        stiffness[:, j] = -(force(q + step) - force(q - step)) / (2.0 * _STEP_M)
    return np.diag(masses(coach)), stiffness


def undamped_modes(parameters: CoachParameters, speed_mps: float = 20.0) -> list[Mode]:
    """Modes of the bodies by rising frequency, rigid motions left out (below 0.05 Hz).

    The part of the stiffness that is not symmetric (creep forces) does not belong to modes and is left out.
    """
    mass, stiffness = stiffness_matrix(parameters, speed_mps)
    bodies = np.delete(np.arange(len(mass)), np.arange(SPIN, SPIN + 4))
    these = np.ix_(bodies, bodies)
    squared, shapes = eigh(0.5 * (stiffness + stiffness.T)[these], mass[these])
    whole = np.zeros_like(mass[: len(bodies)].T)
    whole[bodies] = shapes
    return [
        Mode(float(np.sqrt(w2) / (2.0 * np.pi)), shape)
        for w2, shape in zip(squared, whole.T, strict=True)
        if w2 > (2.0 * np.pi * 0.05) ** 2
    ]


def bounce_frequencies_hz(parameters: CoachParameters) -> tuple[float, float]:
    """Frequencies of carbody bounce and of bogie bounce (both bogies in phase).

    The mode in which the carbody's, or the sum of the bogies', vertical motion carries most of the modal mass.
    """
    modes = undamped_modes(parameters)
    body = max(modes, key=lambda mode: abs(mode.shape[2]))
    bogies = max(modes, key=lambda mode: abs(mode.shape[8] + mode.shape[14]))
    return body.frequency_hz, bogies.frequency_hz
