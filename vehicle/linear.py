"""The coach linearised about steady running on straight level track: mass, damping and stiffness matrices.

Creep forces enter with Kalker's slopes, those of small swings on a clean rail; dampers and bump stops with their slope
at rest.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vehicle.forces import coach_force
from vehicle.layout import masses
from vehicle.parameters import CoachParameters
from vehicle.start import start_state
from wheel_rail import Adhesion, AdhesionParameters, Contact, RailState, Track, TrackParameters
from wheel_rail.adhesion_state import RailTables
from wheel_rail.contact_parameters import ConicalGeometry
from wheel_rail.creep_laws import CREEP_LAWS, KalkerLinearParameters

FRICTION = 0.4
_STRAIGHT_M = 200.0
# of coordinates (m, rad) and velocities: small against curved characteristics, large against rounding
_STEP, _RATE_STEP = 1e-6, 1e-5


def kalker_contact(parameters: CoachParameters) -> Contact:
    """The coach's wheels under Kalker's linear creep law, cut off at the friction bound."""
    law = CREEP_LAWS["kalker-linear"].in_force(KalkerLinearParameters(saturation="cut"))
    return replace(polach_contact(parameters), law=law)


def polach_contact(parameters: CoachParameters) -> Contact:
    """The coach's wheels under Polach's creep law, in which large spin takes from the slopes of the creepages."""
    radius_m = 0.5 * parameters.wheelset.wheel_diameter_m
    return Contact(parameters.contact, radius_m, parameters.static_wheel_load_n)


def clean_rail(length_m: float, contact: Contact) -> RailTables:
    """Rails that no wheel has touched, on which creep forces begin with Kalker's slopes (Polach's kA = kS = 1).

    Friction is 0.4 at any slip and is not changed by wheels.
    """
    curve = {"mu0": FRICTION, "falling_a": 1.0, "falling_b_spm": 0.0, "k_adhesion": 1.0, "k_slip": 1.0}
    always = {"tau_mpj": 1e-12, "degraded": curve, "recovered": curve}
    found = AdhesionParameters.model_validate({"stretches": [{"from_m": 0.0, "recovery": always}]})
    return Adhesion(found, length_m, contact, np.random.default_rng(0)).tables(RailState(length_m))


@dataclass(frozen=True)
class LinearCoach:
    """M q'' + C q' + K q = 0 for small changes of the coordinates q (n,) of `vehicle.layout`; matrices (n, n).

    Turns are about the bodies' own axes. C and K are not symmetric: creep and gyroscopic terms are in.
    """

    speed_mps: float
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray

    @cached_property
    def state_matrix(self) -> np.ndarray:
        """A (2n, 2n) of d/dt (q, q') = A (q, q')."""
        n = len(self.mass)
        inverse = 1.0 / np.diag(self.mass)[:, None]
        return np.block([[np.zeros((n, n)), np.eye(n)], [-inverse * self.stiffness, -inverse * self.damping]])


class Linearisation:
    """Makes the `LinearCoach` of one coach at any speed; `contact`: None for `kalker_contact`."""

    def __init__(self, parameters: CoachParameters, contact: Contact | None = None) -> None:
        self.parameters = parameters
        self.contact = contact or kalker_contact(parameters)
        self._track = Track(TrackParameters(length_m=_STRAIGHT_M))
        self._rail = clean_rail(_STRAIGHT_M, self.contact)

    def at(self, speed_mps: float) -> LinearCoach:
        """Central differences of the compiled forces, K = -df/dq and C = -df/dq', about steady running."""
        record, q, v = start_state(self.parameters, self.contact, self._track, self._rail, 0.5 * _STRAIGHT_M, speed_mps)
        n = len(q)
        force = np.empty(n)

        def change(array: np.ndarray, j: int, step: float) -> np.ndarray:
            kept = array[j]
            ends = []
            for end in (kept + step, kept - step):
                array[j] = end
                coach_force(q, v, force, record, self._track.table, self._rail)
                ends.append(force.copy())
            array[j] = kept
            return np.asarray((ends[1] - ends[0]) / (2.0 * step))

        stiffness = np.stack([change(q, j, _STEP) for j in range(n)], axis=1)
        damping = np.stack([change(v, j, _RATE_STEP) for j in range(n)], axis=1)
        return LinearCoach(speed_mps, np.diag(masses(record[0])), damping, stiffness)


def conical(parameters: CoachParameters, conicity: float) -> CoachParameters:
    """The same coach on cones: rail heads and play of its own cones, or usual ones where it has none."""
    cone = parameters.contact.conical or ConicalGeometry(
        conicity=conicity, rail_head_radius_m=0.3, flange_clearance_m=0.007
    )
    contact = parameters.contact.model_copy(
        update={"geometry": "conical", "conical": cone.model_copy(update={"conicity": conicity})}
    )
    return parameters.model_copy(update={"contact": contact})


def without_resistance(parameters: CoachParameters) -> CoachParameters:
    """The same coach without running resistance: it keeps its speed."""
    none = parameters.resistance.model_copy(update={"a_n": 0.0, "b_nspm": 0.0, "c_ns2pm2": 0.0})
    return parameters.model_copy(update={"resistance": none})
