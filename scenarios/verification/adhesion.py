"""Adhesion of the rail: degraded adhesion that recovers, and adhesion over speed."""

from functools import cache, partial

import numpy as np

from scenarios.units import KMH_PER_MPS
from scenarios.verification.case import Case
from wheel_rail import Adhesion, AdhesionParameters, Contact, ContactParameters
from wheel_rail.adhesion_condition import rail_condition
from wheel_rail.adhesion_state import RailState, RailTables
from wheel_rail.contact_parameters import ConicalGeometry
from wheel_rail.creep_laws import CREEP_LAWS
from wheel_rail.peak_adhesion import offered_adhesion
from wheel_rail.recovery import CONDITION, adhesive_force

ALLOTTA = "Allotta et al. 2014"
LOAD_N, SHEAR_PA = 68.7e3, 82e9
LENGTH_M = 50.0
ALLOTTA_SPEED_MPS = 120.0 / KMH_PER_MPS
CURTIUS_KNIFFLER_KMH = (5.0, 15.0, 50.0, 100.0, 200.0)


@cache
def conical_contact() -> Contact:
    """Wheels of 920 mm on a rail head of 300 mm, under the load of a wheel of the coach."""
    parameters = ContactParameters(
        geometry="conical",
        conical=ConicalGeometry(conicity=0.05, rail_head_radius_m=0.3, flange_clearance_m=0.007),
        shear_modulus_pa=SHEAR_PA,
        poisson=0.28,
        track_stiffness_npm=1e8,
        damping_nspm=3e4,
        flange_stiffness_npm=1e7,
        creep_speed_mps=0.2,
    )
    return Contact(parameters, 0.46, LOAD_N)


@cache
def _rail(key: str, value: str) -> RailTables:
    """A rail of one stretch, on which no train has been."""
    stretch = {"from_m": 0.0, key: value} | ({"surface": "dry"} if key == "speed_law" else {})
    parameters = AdhesionParameters.model_validate({"stretches": [stretch]})
    return Adhesion(parameters, LENGTH_M, conical_contact(), np.random.default_rng(1)).tables(RailState(LENGTH_M))


def _condition(rail: RailTables, speed_mps: float) -> np.ndarray:
    condition = np.empty(CONDITION)
    rail_condition(0.5 * LENGTH_M, 0, speed_mps, rail, condition)
    return condition


def _offered(rail: RailTables, speed_mps: float) -> float:
    """Peak adhesion on rail as found, by Polach's law."""
    law = CREEP_LAWS["polach"].in_force()
    condition = _condition(rail, speed_mps)
    peak, _ = offered_adhesion(
        law.number, law.address, law.extra, speed_mps, LOAD_N, conical_contact().patch, condition, SHEAR_PA, False
    )
    return float(peak)


def _locked() -> float:
    """Adhesion of a locked wheel that cleans degraded rail for itself."""
    law = CREEP_LAWS["polach"].in_force()
    speed = ALLOTTA_SPEED_MPS
    condition = _condition(_rail("recovery", "allotta-2014"), speed)
    patch = conical_contact().patch
    fx, _, _, _ = adhesive_force(
        law.number, law.address, law.extra, 1.0, 0.0, 0.0, speed, speed, LOAD_N, patch, condition, SHEAR_PA
    )
    return -float(fx) / LOAD_N


def _recovery_cases() -> list[Case]:
    group = "Degraded adhesion that recovers"
    return [
        Case(
            "recovery-degraded", group, "degraded peak at 120 km/h, published parameters", ALLOTTA, 0.116, "-",
            lambda: _offered(_rail("recovery", "allotta-2014"), ALLOTTA_SPEED_MPS), 0.001,
        ),
        Case(
            "recovery-locked", group, "locked wheel at 120 km/h, cleaning for itself, published parameters", ALLOTTA,
            0.27, "-", _locked, 0.005,
        ),
    ]  # fmt: skip


def _curtius_kniffler_cases() -> list[Case]:
    return [
        Case(
            f"curtius-kniffler-{speed_kmh:.0f}", "Adhesion over speed",
            f"peak adhesion of a rail with this speed law at {speed_kmh:.0f} km/h: 0.161 + 7.5/(v + 44)",
            "Curtius and Kniffler 1950", 0.161 + 7.5 / (speed_kmh + 44.0), "-",
            partial(_offered_over_speed, speed_kmh), 0.0005, relative=True,
        )
        for speed_kmh in CURTIUS_KNIFFLER_KMH
    ]  # fmt: skip


def _offered_over_speed(speed_kmh: float) -> float:
    return _offered(_rail("speed_law", "curtius-kniffler"), speed_kmh / KMH_PER_MPS)


CASES = (*_recovery_cases(), *_curtius_kniffler_cases())
