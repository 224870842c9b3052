"""Contact mechanics: Kalker's coefficients, Hertz' ellipse, Polach's creep law."""

from dataclasses import astuple
from functools import cache, partial

import numpy as np
from scipy.optimize import brentq

from scenarios.verification.case import Case
from wheel_rail.creep_laws import CREEP_LAWS
from wheel_rail.hertz import EllipticContact, elliptic_contact
from wheel_rail.kalker import creep_coefficients
from wheel_rail.peak_adhesion import offered_adhesion
from wheel_rail.polach import SURFACES, polach_force
from wheel_rail.recovery import CONDITION, DEGRADED, RECOVERED

KALKER = "Kalker 1990, table E.3"
TRACTCURV = "CONTACT, case tractcurv"
POLACH = "Polach, Wear 258 (2005)"

# the case tractcurv: load, material, wheel radius, ratio of the ellipse, longitudinal creep alone
LOAD_N, SHEAR_PA, POISSON = 106_700.0, 82e9, 0.28
WHEEL_RADIUS_M, A_OVER_B = 0.625, 0.5
SPEED_MPS, FRICTION = 10.0, 0.33
SEMI_AXES_M = (6.304e-3, 12.61e-3)
CONTACT_CURVE_N = {
    1e-5: 247.0,
    4e-4: 9_112.0,
    1.2e-3: 22_820.0,
    2e-3: 31_040.0,
    2.8e-3: 34_620.0,
    4e-3: 35_180.0,
    6e-3: 35_200.0,
    2e-2: 35_210.0,
}
"""Creep -> longitudinal force that CONTACT finds, N."""

# a/b, then C11, C22, C23, each for the three Poisson numbers
POISSON_NUMBERS = (0.0, 0.25, 0.5)
KALKER_TABLE = (
    (0.1, 2.51, 3.31, 4.85, 2.51, 2.52, 2.53, 0.334, 0.473, 0.731),
    (0.2, 2.59, 3.37, 4.81, 2.59, 2.63, 2.66, 0.483, 0.603, 0.809),
    (0.3, 2.68, 3.44, 4.80, 2.68, 2.75, 2.81, 0.607, 0.715, 0.889),
    (0.4, 2.78, 3.53, 4.82, 2.78, 2.88, 2.98, 0.720, 0.823, 0.977),
    (0.5, 2.88, 3.62, 4.83, 2.88, 3.01, 3.14, 0.827, 0.929, 1.07),
    (0.6, 2.98, 3.72, 4.91, 2.98, 3.14, 3.31, 0.930, 1.03, 1.18),
    (0.7, 3.09, 3.81, 4.97, 3.09, 3.28, 3.48, 1.03, 1.14, 1.29),
    (0.8, 3.19, 3.91, 5.05, 3.19, 3.41, 3.65, 1.13, 1.25, 1.40),
    (0.9, 3.29, 4.01, 5.12, 3.29, 3.54, 3.82, 1.23, 1.36, 1.51),
    (1.0, 3.40, 4.12, 5.20, 3.40, 3.67, 3.98, 1.33, 1.47, 1.63),
    (1 / 0.9, 3.51, 4.22, 5.30, 3.51, 3.81, 4.16, 1.44, 1.59, 1.77),
    (1 / 0.8, 3.65, 4.36, 5.42, 3.65, 3.99, 4.39, 1.58, 1.75, 1.94),
    (1 / 0.7, 3.82, 4.54, 5.58, 3.82, 4.21, 4.67, 1.76, 1.95, 2.18),
    (1 / 0.6, 4.06, 4.78, 5.80, 4.06, 4.50, 5.04, 2.01, 2.23, 2.50),
    (1 / 0.5, 4.37, 5.10, 6.11, 4.37, 4.90, 5.56, 2.35, 2.62, 2.96),
    (1 / 0.4, 4.84, 5.57, 6.57, 4.84, 5.48, 6.31, 2.88, 3.24, 3.70),
    (1 / 0.3, 5.57, 6.34, 7.34, 5.57, 6.40, 7.51, 3.79, 4.32, 5.01),
    (1 / 0.2, 6.96, 7.78, 8.82, 6.96, 8.14, 9.79, 5.72, 6.63, 7.89),
    (1 / 0.1, 10.7, 11.7, 12.9, 10.7, 12.8, 16.0, 12.2, 14.6, 18.0),
)


@cache
def tractcurv_patch() -> np.ndarray:
    """Patch of the case as creep laws want it: its published semi-axes, coefficients, Polach's factor of the spin."""
    return np.array([*SEMI_AXES_M, *creep_coefficients(A_OVER_B, POISSON), 1.0 + 6.3 * (1.0 - np.exp(-A_OVER_B))])


def _worst_of_table(coefficient: int, poisson_number: int) -> float:
    """Largest relative difference from the table's column, of either sign."""
    column = 1 + 3 * coefficient + poisson_number
    found = [creep_coefficients(row[0], POISSON_NUMBERS[poisson_number])[coefficient] for row in KALKER_TABLE]
    errors = np.array(found) / np.array([row[column] for row in KALKER_TABLE]) - 1.0
    return float(errors[np.argmax(np.abs(errors))])


@cache
def _tractcurv_ellipse() -> EllipticContact:
    """The ellipse under the case's load; the lateral curvature is the one that gives the published a/b."""
    rolling = 1.0 / WHEEL_RADIUS_M

    def ellipse(lateral_1pm: float) -> EllipticContact:
        return elliptic_contact(LOAD_N, rolling, lateral_1pm, SHEAR_PA, POISSON)

    lateral = brentq(lambda c: ellipse(c).a_m / ellipse(c).b_m - A_OVER_B, 0.1, 1.5)
    return ellipse(lateral)


def _sphere_radius_mm() -> float:
    return 1000.0 * elliptic_contact(LOAD_N, 2.0, 2.0, SHEAR_PA, POISSON).a_m


@cache
def _polach_over_contact() -> np.ndarray:
    """Polach's force with kA = kS = 1 and constant friction over CONTACT's, less one, per cent."""
    rail = np.array([FRICTION, 1.0, 0.0, 1.0, 1.0])
    found = [
        -polach_force(creep, 0.0, 0.0, SPEED_MPS * creep, LOAD_N, tractcurv_patch(), rail, SHEAR_PA)[0]
        for creep in CONTACT_CURVE_N
    ]
    return 100.0 * (np.array(found) / np.array(list(CONTACT_CURVE_N.values())) - 1.0)


def _peak(surface: str, speed_mps: float, which: int) -> float:
    """Peak adhesion of one of Polach's surfaces, or the creep where it lies."""
    law = CREEP_LAWS["polach"].in_force()
    condition = np.zeros(CONDITION)
    condition[DEGRADED:RECOVERED] = astuple(SURFACES[surface])
    found = offered_adhesion(
        law.number, law.address, law.extra, speed_mps, LOAD_N, tractcurv_patch(), condition, SHEAR_PA, False
    )
    return float(found[which])


def _kalker_cases() -> list[Case]:
    group = "Kalker's creep coefficients, a/b = 0.1 to 10"
    cases = [
        Case(
            id=f"kalker-{name}-{100 * nu:.0f}",
            group=group,
            quantity=f"{name} at nu = {nu}: largest relative deviation from the 19 values",
            source=KALKER,
            expected=0.0,
            unit="-",
            obtain=partial(_worst_of_table, j, k),
            tolerance=1e-12,
        )
        for j, name in enumerate(("C11", "C22", "C23"))
        for k, nu in enumerate(POISSON_NUMBERS)
    ]
    between = Case(
        id="kalker-between",
        group=group,
        quantity="C11 at a/b = 0.5, nu = 0.28, between the table's points",
        source=TRACTCURV,
        expected=3.7335,
        unit="-",
        obtain=lambda: creep_coefficients(A_OVER_B, POISSON)[0],
        tolerance=5e-5,
    )
    return [*cases, between]


def _hertz_cases() -> list[Case]:
    group = "Hertz' contact"
    # a^3 = 3 N/(4 E* c), 1/E* = (1 - nu)/G for two bodies of one material, c the sum of both curvatures
    sphere_mm = 1000.0 * (3.0 * LOAD_N * (1.0 - POISSON) / (8.0 * SHEAR_PA)) ** (1.0 / 3.0)
    figures = [
        ("hertz-a", "semi-axis a", SEMI_AXES_M[0] * 1e3, "mm", lambda: 1e3 * _tractcurv_ellipse().a_m),
        ("hertz-b", "semi-axis b", SEMI_AXES_M[1] * 1e3, "mm", lambda: 1e3 * _tractcurv_ellipse().b_m),
        ("hertz-pressure", "peak pressure", 640.7, "MPa", lambda: _tractcurv_ellipse().peak_pressure_pa / 1e6),
        ("hertz-approach", "approach", 0.07651, "mm", lambda: 1e3 * _tractcurv_ellipse().approach_m),
    ]
    cases = [
        Case(id_, group, f"{name}, 106.7 kN, a/b = 0.5", TRACTCURV, expected, unit, obtain, 0.002, relative=True)
        for id_, name, expected, unit, obtain in figures
    ]
    sphere = Case(
        "hertz-sphere", group, "radius of contact of two spheres, relative curvature 2/m, 106.7 kN", "closed form",
        sphere_mm, "mm", _sphere_radius_mm, 1e-9, relative=True,
    )  # fmt: skip
    return [*cases, sphere]


def _polach_cases() -> list[Case]:
    group = "Polach's creep law"
    peaks = [  # surface, speed m/s, peak adhesion, creep of the peak
        ("dry", 10.0, 0.453, 0.030),
        ("dry", 30.0, 0.400, 0.017),
        ("wet", 10.0, 0.252, 0.081),
        ("wet", 30.0, 0.224, 0.047),
    ]
    cases = []
    for surface, speed, peak, creep in peaks:
        where = f"{surface}, {speed:.0f} m/s"
        id_ = f"polach-{surface}-{speed:.0f}"
        cases += [
            Case(
                f"{id_}-peak", group, f"peak adhesion, {where}", POLACH, peak, "-",
                partial(_peak, surface, speed, 0), 0.005,
            ),
            Case(
                f"{id_}-creep", group, f"creep of the peak, {where}", POLACH, creep, "-",
                partial(_peak, surface, speed, 1), 0.03, relative=True,
            ),
        ]  # fmt: skip
    over = "over CONTACT's along the creep curve, mu = 0.33, kA = kS = 1"
    band = (-6.3, 4.1)
    return [
        *cases,
        Case(
            "polach-contact-least", group, f"least force {over}", TRACTCURV, band, "%",
            lambda: float(_polach_over_contact().min()),
        ),
        Case(
            "polach-contact-most", group, f"largest force {over}", TRACTCURV, band, "%",
            lambda: float(_polach_over_contact().max()),
        ),
    ]  # fmt: skip


CASES = (*_kalker_cases(), *_hertz_cases(), *_polach_cases())
