"""Creep laws over a grid, FASTSIM and its modification, against CONTACT's curves for the case tractcurv."""

import math
from functools import cache, partial
from itertools import product

import numpy as np

from scenarios.verification.case import Case
from scenarios.verification.contact_mechanics import (
    CONTACT_CURVE_N,
    FRICTION,
    LOAD_N,
    POISSON,
    SHEAR_PA,
    SPEED_MPS,
    TRACTCURV,
    tractcurv_patch,
)
from wheel_rail.creep_laws import CREEP_LAWS, LawInForce, ModifiedFastsimParameters, creep_force
from wheel_rail.fastsim import fastsim_on_rectangle
from wheel_rail.kalker import creep_coefficients
from wheel_rail.slip import friction

FASTSIM_CURVE_N = {
    1e-5: 250.9,
    4e-4: 9_075.0,
    1.2e-3: 22_110.0,
    2e-3: 29_690.0,
    2.8e-3: 33_470.0,
    4e-3: 35_130.0,
    6e-3: 35_210.0,
    2e-2: 35_210.0,
}
"""Creep -> longitudinal force of CONTACT's own FASTSIM, N: 48 x 44 cells, the stress at the end of each cell."""
CONTACT_CELLS = (48, 44)
FALLING_CURVE_N = {1e-3: 10_450.0, 2.2e-2: 32_460.0, 0.25: 18_740.0}
"""Creep -> longitudinal force of CONTACT's modified FASTSIM with falling friction, N; the peak is the second."""

# lateral creepage and spin (1/m) of CONTACT's case fastsim, 82 kN, mu = 0.3
SPIN_SEMI_AXES_M, SPIN_CREEPAGES, SPIN_LIMIT_N = (8e-3, 4e-3), (-6.25e-4, 0.625), 0.3 * 82e3

# Carter's roller, relative radius and half length of the contact: in the plane it transmits 0.64 mu N at q = 0.4
CARTER_RADIUS_M, CARTER_HALF_LENGTH_M, CARTER_FRICTION = 0.5, 1e-3, 0.3
CARTER_TOLERANCES = {0.05: 0.02, 0.4: 0.05, 0.8: 0.05}
"""q = R xi/(mu l) of the middle strip -> relative tolerance: the simplified theory slides otherwise than Carter's."""

CONSTANT_FRICTION = np.array([FRICTION, 1.0, 0.0, 1.0, 1.0])
# mu = 0.1368 + 0.2232 exp(-ln 2 w/(0.99 m/s)), w the slip speed, in the form of Polach's curve
FALLING_FRICTION = np.array([0.1368 + 0.2232, 0.1368 / (0.1368 + 0.2232), math.log(2.0) / 0.99, 1.0, 1.0])


@cache
def law(name: str, nx: int, ny: int) -> LawInForce:
    """FASTSIM or its modification on a grid of nx x ny cells."""
    entry = CREEP_LAWS[name]
    return entry.in_force(entry.Parameters.model_validate({"nx": nx, "ny": ny}))


def _force_n(chosen: LawInForce, creep: float, curve: np.ndarray) -> float:
    slip_speed = SPEED_MPS * creep
    fx, _, _, _ = creep_force(
        chosen.number, chosen.address, chosen.extra, creep, 0.0, 0.0, slip_speed, LOAD_N, tractcurv_patch(), curve,
        SHEAR_PA,
    )  # fmt: skip
    return -float(fx)


def _fastsim_of_contact_n(creep: float) -> float:
    limit_n = FRICTION * LOAD_N
    fx, _ = fastsim_on_rectangle(*CONTACT_CELLS, 1.0, creep, 0.0, 0.0, limit_n, tractcurv_patch(), SHEAR_PA)
    return -float(fx)


@cache
def _fastsim_over_contact() -> np.ndarray:
    """CONTACT's FASTSIM, computed anew, over CONTACT, less one, per cent."""
    return np.array([100.0 * (_fastsim_of_contact_n(creep) / force - 1.0) for creep, force in CONTACT_CURVE_N.items()])


def _worst_of_coarse() -> float:
    """FASTSIM on 10 x 10 cells over 400 x 201, less one, per cent: the largest difference, of either sign."""
    coarse, fine = law("fastsim", 10, 10), law("fastsim", 400, 201)
    differences = np.array(
        [
            100.0 * (_force_n(coarse, creep, CONSTANT_FRICTION) / _force_n(fine, creep, CONSTANT_FRICTION) - 1.0)
            for creep in CONTACT_CURVE_N
        ]
    )
    return float(differences[np.argmax(np.abs(differences))])


def _worst_of_coarse_with_spin(largest_spin: float) -> float:
    """FASTSIM on 10 x 10 cells less 120 x 80, size of the difference of the forces, % of mu N: the worst of a battery.

    Ellipses of a/b from 0.3 to 3; longitudinal, lateral and mixed creepage up to 3 times, spin up to `largest_spin`
    times what would transmit mu N by the linear theory. Flange contacts reach 3, on low adhesion 8.
    """
    coarse, fine = law("fastsim", 10, 10), law("fastsim", 120, 80)
    limit_n, mean_m = SPIN_LIMIT_N, 5e-3
    worst = 0.0
    for ratio, spin, size, angle in product(
        (0.3, 1.0, 3.0), (0.1, 0.3, 1.0, 3.0, 8.0), (0.1, 0.5, 1.5, 3.0), (0.0, 0.25, 0.5, -0.25, -0.5)
    ):
        if spin > largest_spin:
            continue
        coefficients = creep_coefficients(ratio, POISSON)
        c11, c22, c23 = coefficients
        patch = np.array([mean_m * ratio**0.5, mean_m / ratio**0.5, *coefficients, 1.0])
        per_force = size * limit_n / (SHEAR_PA * mean_m**2)
        creep_x, creep_y = per_force * math.cos(math.pi * angle) / c11, per_force * math.sin(math.pi * angle) / c22
        spin_1pm = spin * limit_n / (SHEAR_PA * mean_m**3 * c23)
        arguments = (creep_x, creep_y, spin_1pm, 0.0, limit_n / FRICTION, patch, CONSTANT_FRICTION, SHEAR_PA)
        forces = [creep_force(of.number, of.address, of.extra, *arguments)[:2] for of in (coarse, fine)]
        worst = max(worst, 100.0 * math.dist(*forces) / limit_n)
    return worst


@cache
def _spin_patch() -> np.ndarray:
    """Patch of CONTACT's case fastsim: lateral creepage against spin on an ellipse longer than wide."""
    a_m, b_m = SPIN_SEMI_AXES_M
    ratio = a_m / b_m
    return np.array([a_m, b_m, *creep_coefficients(ratio, POISSON), 1.0 + 6.3 * (1.0 - np.exp(-ratio))])


def _spin_force_of_contact_n() -> float:
    _, fy = fastsim_on_rectangle(44, 44, 1.0, 0.0, *SPIN_CREEPAGES, SPIN_LIMIT_N, _spin_patch(), SHEAR_PA)
    return float(fy)


def _spin_force_n() -> float:
    chosen, curve = law("fastsim", 400, 201), np.array([0.3, 1.0, 0.0, 1.0, 1.0])
    _, fy, _, _ = creep_force(
        chosen.number, chosen.address, chosen.extra, 0.0, *SPIN_CREEPAGES, 0.0, SPIN_LIMIT_N / 0.3, _spin_patch(),
        curve, SHEAR_PA,
    )  # fmt: skip
    return float(fy)


def _carter_strips(q_middle: float) -> float:
    """Share of mu N by Carter's solution for a plane, strip by strip of the wide ellipse.

    A strip of half length l transmits 1 - (1 - q)^2 of its limit, q = R xi/(mu l) up to 1, and its limit goes with l^2.
    """
    theta = np.linspace(0.0, 0.5 * np.pi, 20_001)
    cosine = np.cos(theta)
    q = q_middle / np.maximum(cosine, 1e-9)
    share = cosine**3 * (1.0 - np.maximum(1.0 - q, 0.0) ** 2)
    return float(np.trapezoid(share, theta) / np.trapezoid(cosine**3, theta))


def _carter_fastsim(q_middle: float) -> float:
    """Share of mu N by FASTSIM on an ellipse ten times as wide as long, nu = 0, under the load of that length."""
    a_m = CARTER_HALF_LENGTH_M
    b_m = 10.0 * a_m
    # plane Hertz contact of relative radius R: p0 = a G/(2 R) for nu = 0
    load_n = 2.0 / 3.0 * np.pi * a_m * b_m * SHEAR_PA * a_m / (2.0 * CARTER_RADIUS_M)
    patch = np.array([a_m, b_m, *creep_coefficients(0.1, 0.0), 1.0 + 6.3 * (1.0 - np.exp(-0.1))])
    chosen, curve = law("fastsim", 60, 60), np.array([CARTER_FRICTION, 1.0, 0.0, 1.0, 1.0])
    creep = q_middle * CARTER_FRICTION * a_m / CARTER_RADIUS_M
    fx, _, _, _ = creep_force(
        chosen.number, chosen.address, chosen.extra, creep, 0.0, 0.0, 0.0, load_n, patch, curve, SHEAR_PA
    )
    return -float(fx) / (CARTER_FRICTION * load_n)


def _falling_of_contact_n(creep: float) -> float:
    """Modified FASTSIM in CONTACT's scheme, the stiffness reduced by hand."""
    law_of_k = ModifiedFastsimParameters()
    limit_n = friction(FALLING_FRICTION, SPEED_MPS * creep) * LOAD_N
    a_m, b_m, c11 = tractcurv_patch()[:3]
    eps = 0.25 * np.pi * SHEAR_PA * a_m * b_m * law_of_k.k0 * c11 * creep / limit_n
    k = law_of_k.k0 * ((1.0 - law_of_k.alpha_inf) / (1.0 + law_of_k.beta * eps) + law_of_k.alpha_inf)
    fx, _ = fastsim_on_rectangle(*CONTACT_CELLS, k, creep, 0.0, 0.0, limit_n, tractcurv_patch(), SHEAR_PA)
    return -float(fx)


@cache
def _falling_peak() -> tuple[float, float]:
    """Creep and force (N) of the peak with falling friction."""
    creeps = np.geomspace(5e-3, 0.1, 400)
    forces = [_force_n(law("modified-fastsim", *CONTACT_CELLS), creep, FALLING_FRICTION) for creep in creeps]
    k = int(np.argmax(forces))
    return float(creeps[k]), forces[k]


def _fastsim_cases() -> list[Case]:
    group = "FASTSIM"
    scheme = "48 x 44 cells, stress at their ends"
    column = [
        Case(
            f"fastsim-{creep:g}", group, f"force at creep {creep:g}, mu = 0.33, {scheme}", TRACTCURV, force, "N",
            partial(_fastsim_of_contact_n, creep), 0.01, relative=True,
        )
        for creep, force in FASTSIM_CURVE_N.items()
    ]  # fmt: skip
    band = (-4.5, 1.7)
    return [
        *column,
        Case(
            "fastsim-contact-least", group, "least of these forces over those of the exact theory", TRACTCURV,
            band, "%", lambda: float(_fastsim_over_contact().min()),
        ),
        Case(
            "fastsim-contact-most", group, "largest of these forces over those of the exact theory", TRACTCURV,
            band, "%", lambda: float(_fastsim_over_contact().max()),
        ),
        Case(
            "fastsim-linear", group, "force at creep 1e-5, 400 x 201 cells: G a b C11 creep", "Kalker's linear theory",
            243.4, "N", lambda: _force_n(law("fastsim", 400, 201), 1e-5, CONSTANT_FRICTION), 0.005, relative=True,
        ),
        Case(
            "fastsim-coarse", group, "10 x 10 cells over 400 x 201, largest difference along the curve",
            "requirement", (-3.0, 3.0), "%", _worst_of_coarse,
        ),
        *(
            Case(
                f"fastsim-coarse-spin-{spin:g}", group,
                f"10 x 10 cells less 120 x 80 over mu N, the worst of a battery with up to {spin:g} times the spin "
                "that saturates", "requirement", (0.0, most), "%", partial(_worst_of_coarse_with_spin, spin),
            )
            for spin, most in ((0.3, 1.0), (8.0, 3.0))
        ),
        *(
            Case(
                f"fastsim-carter-{q:g}", group,
                f"share of mu N on an ellipse with b = 10 a, over Carter's plane strips, q = {q:g}",
                "Carter 1926, closed form", _carter_strips(q), "-", partial(_carter_fastsim, q), tolerance,
                relative=True,
            )
            for q, tolerance in CARTER_TOLERANCES.items()
        ),
    ]  # fmt: skip


def _spin_cases() -> list[Case]:
    group = "FASTSIM with lateral creepage -0.000625 and spin 0.625/m"
    source = "CONTACT, case fastsim"
    cancel = (
        "the simplified theory itself, where lateral creepage and spin act together; on 44 x 44 cells its error and "
        "that of the scheme cancel"
    )
    return [
        Case(
            "fastsim-spin", group, "lateral force, 44 x 44 cells, stress at their ends", source, -15_000.0, "N",
            _spin_force_of_contact_n, 0.025, relative=True,
        ),
        Case(
            "fastsim-spin-exact", group, "lateral force, 400 x 201 cells, and the exact theory", source, -14_940.0, "N",
            _spin_force_n, 0.05, relative=True, known_deviation=cancel,
        ),
    ]  # fmt: skip


def _falling_cases() -> list[Case]:
    group = "Modified FASTSIM with falling friction"
    (low, low_n), (peak, peak_n), (high, high_n) = FALLING_CURVE_N.items()
    chosen = partial(law, "modified-fastsim", *CONTACT_CELLS)
    scheme = [
        Case(
            f"falling-scheme-{creep:g}", group, f"force at creep {creep:g}, 48 x 44 cells, stress at their ends",
            TRACTCURV, force_n, "N", partial(_falling_of_contact_n, creep), 0.005, relative=True,
        )
        for creep, force_n in FALLING_CURVE_N.items()
    ]  # fmt: skip
    return [
        *scheme,
        Case(
            "falling-low", group, f"force at creep {low:g}; CONTACT's grid is 2 to 3 % too stiff here", TRACTCURV,
            low_n, "N", lambda: _force_n(chosen(), low, FALLING_FRICTION), 0.03, relative=True,
        ),
        Case(
            "falling-peak", group, "force at the peak", TRACTCURV, peak_n, "N", lambda: _falling_peak()[1], 0.02,
            relative=True,
        ),
        Case(
            "falling-peak-creep", group, "creep of the peak", TRACTCURV, peak, "-", lambda: _falling_peak()[0], 0.07,
            relative=True,
        ),
        Case(
            "falling-high", group, f"force at creep {high:g}", TRACTCURV, high_n, "N",
            lambda: _force_n(chosen(), high, FALLING_FRICTION), 0.02, relative=True,
        ),
    ]  # fmt: skip


CASES = (*_fastsim_cases(), *_spin_cases(), *_falling_cases())
