"""A free wheelset on straight track: the wave in which it runs, from the compiled contact's own forces."""

from functools import cache

import numpy as np

from scenarios.verification.adhesion import conical_contact
from scenarios.verification.case import Case
from wheel_rail import Track, TrackParameters
from wheel_rail.one_wheelset import wheelset_contact
from wheel_rail.recovery import CONDITION, DEGRADED, RECOVERED
from wheel_rail.track_frame import track_frame
from wheel_rail.track_parameters import RAIL_SPACING_M

SPEED_MPS = 10.0
# displacement (m), yaw (rad) and their rates; small against the creepage at which friction begins to saturate
_STEPS = (1e-5, 1e-5, 1e-4, 1e-4)


@cache
def _guidance() -> np.ndarray:
    """Derivatives of lateral force (N) and yaw moment (Nm) over displacement, yaw and their rates, (2, 4).

    The wheelset is kept level, as Klingel's is: one that rolls up its cones shifts more at the rails than at its axle,
    which lengthens the wave by half of conicity r/(e/2), 1.5 %.
    """
    contact = conical_contact()
    track = Track(TrackParameters(length_m=100.0))
    frame = np.empty(14)
    track_frame(50.0, track.origin_m, track.table, frame)
    along, across, upwards = frame[3:6], frame[6:9], frame[9:12]
    condition = np.zeros(CONDITION)
    condition[DEGRADED:RECOVERED] = 0.3, 1.0, 0.0, 1.0, 1.0

    def forces(state: np.ndarray) -> np.ndarray:
        y, yaw, shifting, yawing = state
        axle = across - yaw * along
        axle /= np.linalg.norm(axle)
        position = frame[:3] + y * across + contact.rest_height_m * upwards
        velocity = SPEED_MPS * along + shifting * across
        rate = yawing * upwards
        spin = SPEED_MPS / contact.rolling_radius_m
        normal, creep, _ = wheelset_contact(position, axle, velocity, rate, spin, frame, contact.constants, condition)
        total = (normal + creep).sum(axis=0)
        return np.array([total[:3] @ across, total[3:6] @ upwards])

    found = np.empty((2, 4))
    for j, step in enumerate(_STEPS):
        state = np.zeros(4)
        state[j] = step
        found[:, j] = (forces(state) - forces(-state)) / (2.0 * step)
    return found


def kinematic_wavelength_m() -> float:
    """Length of the wave of a wheelset without mass: lateral force and yaw moment vanish all along."""
    guidance = _guidance()
    swing = np.linalg.eigvals(-np.linalg.solve(guidance[:, 2:], guidance[:, :2]))
    return float(2.0 * np.pi * SPEED_MPS / np.abs(swing.imag).max())


def _klingel_m() -> float:
    contact = conical_contact()
    cone = contact.parameters.conical
    conicity = cone.conicity if cone is not None else np.nan
    return float(2.0 * np.pi * np.sqrt(contact.radius_m * 0.5 * RAIL_SPACING_M / conicity))


CASES = (
    Case(
        "wheelset-klingel", "Free wheelset", "wave of conical wheels, conicity 0.05: 2 pi sqrt(e r/(2 conicity))",
        "Klingel 1883, closed form", _klingel_m(), "m", kinematic_wavelength_m, 0.005, relative=True,
    ),
)  # fmt: skip
