"""A coach's contact and rails on it, shared by the tests of adhesion, recovery and sanding."""

from typing import Any

import numpy as np

from wheel_rail import Adhesion, AdhesionParameters, Contact, ContactParameters
from wheel_rail.adhesion_condition import rail_condition
from wheel_rail.adhesion_state import RailState, RailTables
from wheel_rail.contact_parameters import ConicalGeometry
from wheel_rail.creep_laws import CREEP_LAWS
from wheel_rail.peak_adhesion import offered_adhesion
from wheel_rail.recovery import CONDITION, adhesive_force
from wheel_rail.sanding import SandEffect

LOAD_N = 68.7e3
SHEAR_PA = 82e9
CONTACT = Contact(
    ContactParameters(
        geometry="conical",
        conical=ConicalGeometry(conicity=0.05, rail_head_radius_m=0.3, flange_clearance_m=0.007),
        shear_modulus_pa=SHEAR_PA,
        poisson=0.28,
        track_stiffness_npm=1e8,
        damping_nspm=3e4,
        flange_stiffness_npm=1e7,
        creep_speed_mps=0.2,
    ),
    0.46,
    LOAD_N,
)
PATCH = CONTACT.patch
LAW = CREEP_LAWS["polach"].in_force()


def parameters(*stretches: dict[str, Any], **others: Any) -> AdhesionParameters:
    """Adhesion of these stretches, the first of which begins at 0 unless it says so."""
    return AdhesionParameters.model_validate({"stretches": [{"from_m": 0.0, **s} for s in stretches], **others})


def adhesion(
    of: AdhesionParameters, length_m: float = 1000.0, seed: int = 1, sand: SandEffect | None = None
) -> Adhesion:
    return Adhesion(of, length_m, CONTACT, np.random.default_rng(seed), sand=sand)


def fresh(of: AdhesionParameters, length_m: float = 1000.0, sand: SandEffect | None = None) -> RailTables:
    """Tables of a rail on which no train has been."""
    return adhesion(of, length_m, sand=sand).tables(RailState(length_m))


def condition_at(rail: RailTables, s_m: float, speed_mps: float = 100.0 / 3.6, side: int = 0) -> np.ndarray:
    condition = np.empty(CONDITION)
    rail_condition(s_m, side, speed_mps, rail, condition)
    return condition


def peak(condition: np.ndarray, speed_mps: float = 100.0 / 3.6, own_cleaning: bool = False) -> float:
    """Peak adhesion at 68.7 kN."""
    return offered_adhesion(
        LAW.number, LAW.address, LAW.extra, speed_mps, LOAD_N, PATCH, condition, SHEAR_PA, own_cleaning
    )[0]


def force(
    condition: np.ndarray, creep_x: float, speed_mps: float, creep_y: float = 0.0, spin_1pm: float = 0.0
) -> tuple[float, float, float, float]:
    slip_mps = float(np.hypot(creep_x, creep_y)) * speed_mps
    return adhesive_force(
        LAW.number, LAW.address, LAW.extra, creep_x, creep_y, spin_1pm, slip_mps, speed_mps, LOAD_N, PATCH, condition,
        SHEAR_PA,
    )  # fmt: skip
