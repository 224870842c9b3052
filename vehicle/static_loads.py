"""Static loads of the coach standing on straight level track: wheel by wheel, and what its springs bear."""

from dataclasses import dataclass

import numpy as np

from vehicle.forces import coach_force, forces_by_class
from vehicle.layout import first_coordinate
from vehicle.linear import clean_rail, polach_contact
from vehicle.parameters import GRAVITY_MPS2, CoachParameters
from vehicle.start import start_state
from wheel_rail import Track, TrackParameters
from wheel_rail.contact import NORMAL, UPWARDS

_STRAIGHT_M = 200.0
_STEP = 1e-6
_SOFTEST = 1e-6  # share of the stiffest direction below which one counts as free: rolling along, sliding sideways
_ITERATIONS = 20


@dataclass(frozen=True)
class StaticLoads:
    """`wheel_load_n` (8,): vertical, 1L 1R 2L ...; of every element that carries a body: its number, vertical force on
    the body below (N, downwards), and deflection from the unloaded spring (m)."""

    wheel_load_n: np.ndarray
    elements: np.ndarray
    spring_load_n: np.ndarray
    spring_deflection_m: np.ndarray
    lift_m: np.ndarray
    """How far each body settles above the place from which it starts, (bodies,)."""


def static_loads(parameters: CoachParameters) -> StaticLoads:
    """Where gravity, springs and rails balance: Newton's method on the compiled forces, from the usual start.

    Raises ValueError if no balance is found.
    """
    contact = polach_contact(parameters)
    track = Track(TrackParameters(length_m=_STRAIGHT_M))
    rail = clean_rail(_STRAIGHT_M, contact)
    record, start, v = start_state(parameters, contact, track, rail, 0.5 * _STRAIGHT_M, 0.0)
    coach = record[0]
    q = start.copy()

    def force(at: np.ndarray) -> np.ndarray:
        f = np.empty(len(at))
        coach_force(at, v, f, record, track.table, rail)
        return f

    weight_n = parameters.mass_kg * GRAVITY_MPS2
    for _ in range(_ITERATIONS):
        unbalanced = force(q)
        if np.abs(unbalanced).max() < 1e-9 * weight_n:
            break
        stiffness = np.stack(
            [(force(q - step) - force(q + step)) / (2.0 * _STEP) for step in _STEP * np.eye(len(q))], axis=1
        )
        q += np.linalg.lstsq(stiffness, unbalanced, rcond=_SOFTEST)[0]
    else:
        raise ValueError("the coach finds no balance in its springs: its loads are beyond what they bear")
    forces_by_class(q, v, coach, track.table, rail)
    report = coach["report"]
    carrying = np.flatnonzero(coach["preload"] != 0.0)
    upper, lower = coach["upper"][carrying], coach["lower"][carrying]
    load = np.empty(len(carrying))
    for k, e in enumerate(carrying):
        place = [
            q[first_coordinate(body) : first_coordinate(body) + 3] + coach["rotation"][:, :, body] @ coach[point][e]
            for body, point in ((upper[k], "upper_point"), (lower[k], "lower_point"))
        ]
        load[k] = coach["preload"][e] + coach["stiffness"][e, 2] * (place[1] - place[0])[2]
    bodies = range(coach["bodies"])
    return StaticLoads(
        wheel_load_n=report[NORMAL] * report[UPWARDS + 2],
        elements=carrying,
        spring_load_n=load,
        spring_deflection_m=load / coach["stiffness"][carrying, 2],
        lift_m=np.array([q[first_coordinate(body) + 2] - start[first_coordinate(body) + 2] for body in bodies]),
    )
