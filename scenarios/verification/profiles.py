"""Profiles on the track: equivalent conicity, and contacts of the Manchester benchmark A-2.2."""

from functools import cache, partial

import numpy as np

from scenarios.verification.case import Case
from wheel_rail.contact_geometry import (
    ContactGeometry,
    ContactGeometryParameters,
    ContactTable,
    relative_curvatures_1pm,
)
from wheel_rail.contact_search import ANGLE
from wheel_rail.equivalent_conicity import equivalent_conicity
from wheel_rail.hertz import EllipticContact, elliptic_contact

WHEEL_RADIUS_M = 0.46
GRID_M = np.arange(-600, 601) * 2e-5
LEADING, TRAILING = 0, 1  # the wheelset is displaced and yawed to the left: its left wheel leads

# inclination 1:n of the rail, gauge mm, conicity at 3 mm. The figures follow, to their last digit, from the procedure
# of EN 15302 on the head of its rail A, whose crown of R300 reaches to 10.5 mm from the middle. On the crown of `uic60`
# (10.25 mm) the same level wheelset gives 0.174, 0.114, 0.0094, 0.122 and 0.417
CONICITIES = (
    (40, 1435.0, 0.180),
    (30, 1435.0, 0.122),
    (20, 1435.0, 0.0093),
    (40, 1438.0, 0.127),
    (40, 1430.0, 0.463),
)

A22 = "CONTACT, Manchester A-2.2"
A22_LOAD_N, A22_FRICTION, A22_SHEAR_PA, A22_POISSON = 10e3, 0.3, 82e9, 0.28
A22_PENETRATION_M = 1.2e-5  # 0.55 of the approach under that load
A22_YAW_PER_MM = 2.4e-3
_HOLLOW = (
    "the hollow of the wheel nearly fits the head of the rail, closer towards the flange: their relative curvature "
    "falls from 1.6 to below 0 per metre within the patch, which CONTACT finds 16 mm wide and of two lobes; the rigid "
    "contact leaps by 10 mm at y = 0.25 mm"
)
_JOINT = "the patch lies across the joint of the rail's radii of 300 and 80 mm and is no ellipse"
# displacement mm, wheel, place on the wheel mm, peak pressure MPa, area mm2, why the area deviates
A22_CONTACTS = (
    (0.0, TRAILING, 1.87, 338.0, 51.6, _HOLLOW),
    (1.0, TRAILING, 6.27, 424.0, 36.6, None),
    (1.0, LEADING, -9.03, 741.0, 24.2, _JOINT),
    (3.0, TRAILING, 10.34, 499.0, 30.6, None),
    (3.0, LEADING, -13.10, 713.0, 21.2, None),
    (8.0, TRAILING, 20.35, 701.0, 22.0, None),
    (8.0, LEADING, -42.39, 2634.0, 8.0, None),
)
A22_ROLLS_MRAD = {1.0: 0.0505, 3.0: 0.1803, 6.0: 0.6272, 7.0: 6.393, 8.0: 8.606, 10.0: 11.264}
"""Displacement in mm -> roll of the wheelset that the benchmark prescribes."""


@cache
def geometry(wheel: str, rail: str, inclination: float, gauge_m: float) -> ContactGeometry:
    """Wheels of 920 mm, 1360 mm back to back, on a track with both rails alike."""
    parameters = ContactGeometryParameters(
        wheel_profiles=(wheel, wheel),
        rail_profiles=(rail, rail),
        rail_inclination=inclination,
        gauge_m=gauge_m,
        back_to_back_m=1.36,
    )
    return ContactGeometry(parameters, (WHEEL_RADIUS_M, WHEEL_RADIUS_M))


@cache
def _difference_m(wheel: str, rail: str, inclination: float, gauge_m: float) -> np.ndarray:
    """Rolling radius difference over `GRID_M` of a wheelset kept level, as EN 15302 keeps it."""
    return geometry(wheel, rail, inclination, gauge_m).table(GRID_M, level=True).rolling_radius_difference_m[0]


def _conicity(wheel: str, rail: str, inclination: float, gauge_m: float, amplitude_mm: float) -> float:
    difference = _difference_m(wheel, rail, inclination, gauge_m)
    return float(equivalent_conicity(GRID_M, difference, np.array([amplitude_mm / 1e3]), WHEEL_RADIUS_M)[0])


@cache
def _a22_table(y_mm: float, penetration_m: float) -> ContactTable:
    pair = geometry("s1002", "uic60", 1 / 40, 1.435)
    return pair.table(np.array([y_mm / 1e3]), np.array([A22_YAW_PER_MM * y_mm]), penetration_m=penetration_m)


def _a22_ellipse(y_mm: float, wheel: int) -> EllipticContact:
    """Ellipse under the normal force that carries the vertical load together with friction.

    The wheelset runs towards the leading rail, so that friction lifts the leading wheel as in Nadal's formula. All
    friction slides where the contact is steep enough to count; its direction is that of the creepages.
    """
    table = _a22_table(y_mm, A22_PENETRATION_M)
    contact = table.contacts[0, 0, wheel]
    angle = contact[ANGLE]
    creep_x = 0.5 * table.rolling_radius_difference_m[0, 0] / WHEEL_RADIUS_M
    creep_y = A22_YAW_PER_MM * y_mm / np.cos(angle)
    across = A22_FRICTION * creep_y / max(np.hypot(creep_x, creep_y), 1e-12)
    lifted = across if wheel == LEADING else -across
    normal_force_n = A22_LOAD_N / (np.cos(angle) + lifted * np.sin(angle))
    rolling, lateral = relative_curvatures_1pm(contact)
    return elliptic_contact(normal_force_n, rolling, lateral, A22_SHEAR_PA, A22_POISSON)


def _a22_place_mm(y_mm: float, wheel: int) -> float:
    return float(1e3 * _a22_table(y_mm, A22_PENETRATION_M).wheel_position_m[0, 0, wheel])


def _a22_pressure_mpa(y_mm: float, wheel: int) -> float:
    return _a22_ellipse(y_mm, wheel).peak_pressure_pa / 1e6


def _a22_area_mm2(y_mm: float, wheel: int) -> float:
    ellipse = _a22_ellipse(y_mm, wheel)
    return float(1e6 * np.pi * ellipse.a_m * ellipse.b_m)


def _a22_roll_mrad(y_mm: float) -> float:
    return float(1e3 * _a22_table(y_mm, 0.0).roll_rad[0, 0])


def _conicity_cases() -> list[Case]:
    group = "Equivalent conicity"
    e1 = [
        Case(
            f"en15302-e1-{y}", group, f"wheel A on rail A, gauge 1435.16 mm, amplitude {y} mm", "EN 15302, case E1",
            published, "-", partial(_conicity, "en15302-a", "en15302-a", 0.0, 1.43516, float(y)), 0.005,
        )
        for y, published in enumerate((0.125, 0.155, 0.188, 0.216, 0.254, 0.303), start=1)
    ]  # fmt: skip
    s1002 = [
        Case(
            f"s1002-uic60-{gauge_mm:.0f}-{slope}", group,
            f"S1002 on UIC60 (head of EN 15302's rail A) at 1:{slope}, gauge {gauge_mm:.0f} mm, amplitude 3 mm",
            "reference figures, S1002/UIC60", published, "-",
            partial(_conicity, "s1002", "uic60-en15302", 1 / slope, gauge_mm / 1e3, 3.0), 0.005,
        )
        for slope, gauge_mm, published in CONICITIES
    ]  # fmt: skip
    return [*e1, *s1002]


def _a22_cases() -> list[Case]:
    group = "Contact of S1002 on UIC60 (Manchester A-2.2, 10 kN)"
    cases = []
    for y_mm, wheel, place_mm, pressure_mpa, area_mm2, bent in A22_CONTACTS:
        side = "either" if y_mm == 0.0 else "leading" if wheel == LEADING else "trailing"
        where = f"y = {y_mm:.0f} mm, yaw = {1e3 * A22_YAW_PER_MM * y_mm:.1f} mrad, {side} wheel"
        id_ = f"a22-{y_mm:.0f}-{side}"
        cases += [
            Case(
                f"{id_}-place", group, f"place on the wheel, {where}", A22, place_mm, "mm",
                partial(_a22_place_mm, y_mm, wheel), 0.6,
            ),
            Case(
                f"{id_}-pressure", group, f"peak pressure, {where}", A22, pressure_mpa, "MPa",
                partial(_a22_pressure_mpa, y_mm, wheel), 0.1, relative=True,
            ),
            Case(
                f"{id_}-area", group, f"area, {where}", A22, area_mm2, "mm²",
                partial(_a22_area_mm2, y_mm, wheel), 0.1, relative=True, known_deviation=bent,
            ),
        ]  # fmt: skip
    rolls = [
        Case(
            f"a22-{y_mm:.0f}-roll", group, f"roll of the wheelset, y = {y_mm:.0f} mm", A22, roll_mrad, "mrad",
            partial(_a22_roll_mrad, y_mm), 0.03,
        )
        for y_mm, roll_mrad in A22_ROLLS_MRAD.items()
    ]  # fmt: skip
    return [*cases, *rolls]


CASES = (*_conicity_cases(), *_a22_cases())
