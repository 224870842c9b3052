"""FASTSIM against its closed form and its own converged grids. Published figures are cases of the verification."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from tests.wheel_rail.conftest import LOAD_N, SHEAR_PA
from wheel_rail.fastsim import fastsim_force, fastsim_on_rectangle, modified_fastsim_force
from wheel_rail.kalker import creep_coefficients

CREEPS = (1e-5, 1e-4, 1.5e-4, 4e-4, 1.2e-3, 2e-3, 2.8e-3, 3.4e-3, 4e-3, 6e-3, 2e-2)


def rail(mu: float) -> np.ndarray:
    return np.array([mu, 1.0, 0.0, 1.0, 1.0])


def closed_form(creep: float, patch: np.ndarray, limit_n: float) -> float:
    """Longitudinal force of the simplified theory without spin, from its solution on one strip.

    A strip of which the share d (of its length) slides transmits 1 - (1 - d)^3 of its limit; on the strip at angle t
    d is that of the middle strip over cos t, and the limit goes with cos^4 t. The linear force is 32 d/(3 pi) mu N.
    """
    middle = 3.0 * math.pi / 32.0 * SHEAR_PA * patch[0] * patch[1] * patch[2] * creep / limit_n
    sliding = math.acos(min(1.0, middle))  # strips beyond this angle slide altogether
    share, _ = quad(
        lambda t: math.cos(t) ** 4 * (1.0 - max(0.0, 1.0 - middle / math.cos(t)) ** 3),
        -0.5 * math.pi,
        0.5 * math.pi,
        points=[-sliding, sliding],
    )
    return limit_n * share * 8.0 / (3.0 * math.pi)


def test_with_spin_both_schemes_converge_to_one_force() -> None:
    """Lateral creepage against spin, where the schemes on coarse grids differ by 6 %."""
    patch = np.array([8e-3, 4e-3, *creep_coefficients(2.0, 0.28), 0.0])
    arguments = (0.0, -6.25e-4, 0.625)
    # first order: twice the finer minus the coarser grid is near the limit
    forces = [fastsim_on_rectangle(n, n, 1.0, *arguments, 0.3 * 82e3, patch, SHEAR_PA) for n in (300, 600)]
    coarse, fine = (fy for _, fy in forces)
    ours = fastsim_force(300, 300, *arguments, 0.0, 82e3, patch, rail(0.3), SHEAR_PA)[1]
    print(f"converged: {ours:.0f} N, rectangle {2 * fine - coarse:.0f} N")
    assert ours == pytest.approx(2.0 * fine - coarse, rel=2e-3)


def test_converges_to_the_closed_form_and_to_kalkers_linear_value(patch: np.ndarray) -> None:
    for creep in CREEPS:
        exact = closed_form(creep, patch, 0.33 * LOAD_N)
        errors = []
        for n in (10, 40, 160):
            fx, _, _, _ = fastsim_force(n, n, creep, 0.0, 0.0, 0.0, LOAD_N, patch, rail(0.33), SHEAR_PA)
            errors.append(-fx / exact - 1.0)
        print(f"creep {creep:g}: {exact:.1f} N, errors of 10, 40, 160 cells {[f'{e:+.1e}' for e in errors]}")
        assert abs(errors[0]) < 1e-3
        assert abs(errors[1]) < 5e-5
        assert abs(errors[2]) < 5e-6
    linear = SHEAR_PA * patch[0] * patch[1] * patch[2] * 1e-5
    assert closed_form(1e-5, patch, 0.33 * LOAD_N) == pytest.approx(linear, rel=5e-3)


@pytest.mark.parametrize(
    ("angle", "spin", "allowed"),
    [(0.0, 0.0, 1e-3), (1.57, 0.0, 1e-3), (0.0, 0.1, 2e-3), (1.57, 0.1, 2e-3), (1.57, 0.3, 4e-3), (0.8, -0.3, 4e-3),
     (1.57, 2.0, 0.015), (0.8, -2.0, 0.015), (0.0, 5.0, 0.015)],
)  # fmt: skip
def test_ten_by_ten_is_near_the_converged_grid(patch: np.ndarray, angle: float, spin: float, allowed: float) -> None:
    """Errors in mu N over the traction curve: a cone of 1 in 20 spins by 0.1 1/m, a flange by 2 1/m."""
    worst = 0.0
    for creep in np.geomspace(1e-5, 0.02, 25):
        x, y = creep * math.cos(angle), creep * math.sin(angle)
        coarse, fine = (
            np.array(fastsim_force(n, n, x, y, spin, 0.0, LOAD_N, patch, rail(0.33), SHEAR_PA)[:2]) for n in (10, 200)
        )
        worst = max(worst, math.dist(coarse, fine) / (0.33 * LOAD_N))
    print(f"angle {angle}, spin {spin} 1/m: {100 * worst:.2f} % of mu N")
    assert worst < allowed


def test_with_spin_the_error_falls_faster_than_the_size_of_the_cells(patch: np.ndarray) -> None:
    """Mean over creepages and spins from small to saturating, in mu N; a scheme of first order would halve it."""
    cases = [
        (creep * math.cos(angle), creep * math.sin(angle), spin)
        for creep in (2e-4, 1e-3, 3e-3)
        for angle in (0.0, 0.8, 1.57, -0.8, -1.57)
        for spin in (0.1, 0.5, 2.0)
    ]

    def forces(n: int) -> np.ndarray:
        return np.array([fastsim_force(n, n, *case, 0.0, LOAD_N, patch, rail(0.33), SHEAR_PA)[:2] for case in cases])

    fine = forces(240)
    errors = [float(np.mean(np.hypot(*(forces(n) - fine).T))) / (0.33 * LOAD_N) for n in (10, 20, 40)]
    print("mean errors with 10, 20, 40 cells", errors)
    assert errors[0] < 5e-3
    assert errors[1] < errors[0] / 2.5
    assert errors[2] < errors[1] / 2.5


def test_modified_fastsim_without_reduction_is_fastsim(patch: np.ndarray) -> None:
    falling = np.array([0.36, 0.4, 0.7, 1.0, 1.0])
    arguments = (2e-3, -1e-3, 0.2, 0.02, LOAD_N, patch, falling, SHEAR_PA)
    assert modified_fastsim_force(10, 10, 1.0, 1.0, 0.62, *arguments) == pytest.approx(
        fastsim_force(10, 10, *arguments), rel=1e-12
    )
