"""A user's law: compiled, called through its address, or refused with the reason."""

from collections.abc import Callable

import numba
import numpy as np
import pytest

from tests.wheel_rail import user_laws
from tests.wheel_rail.conftest import LOAD_N, SHEAR_PA, law
from wheel_rail.creep_laws import USER, creep_force, user_creep_law
from wheel_rail.user_law import UnusableLaw, compile_law


def test_gives_what_the_plain_function_gives(patch: np.ndarray) -> None:
    rail = law("wet")
    chosen = user_creep_law(user_laws.circular, "circular").in_force()
    assert chosen.number == USER
    for x, y, spin, slip in (
        (0.0, 0.0, 0.0, 0.0),
        (1e-4, 0.0, 0.0, 1e-3),
        (-3e-3, 1e-3, 0.4, 0.05),
        (0.2, -0.1, 2.0, 4.0),
    ):
        found = creep_force(
            chosen.number, chosen.address, chosen.extra, x, y, spin, slip, LOAD_N, patch, rail, SHEAR_PA
        )
        expected = user_laws.circular(x, y, spin, slip, LOAD_N, *patch[:5], SHEAR_PA, *rail)
        assert found[:2] == pytest.approx(expected, rel=1e-13, abs=1e-12)


def test_two_laws_are_served_by_the_same_compiled_code(patch: np.ndarray) -> None:
    source = (
        "def half(creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23,\n"
        "         shear_modulus_pa, mu0, falling_a, falling_b_spm, k_adhesion, k_slip):\n"
        "    mu = mu0 * falling_a\n"
        "    return -0.5 * mu * normal_force_n * creep_x / (abs(creep_x) + 1e-3), 0.0\n"
    )
    scope: dict[str, Callable[..., tuple[float, float]]] = {}
    exec(source, scope)
    first = user_creep_law(user_laws.circular, "circular").in_force()
    second = user_creep_law(numba.njit(scope["half"]), "half").in_force()
    results = []
    kinds = set()
    for chosen in (first, second):
        results.append(
            creep_force(
                chosen.number, chosen.address, chosen.extra, 1e-3, 0.0, 0.0, 0.0, LOAD_N, patch, law("wet"), SHEAR_PA
            )[0]
        )
        kinds.add(len(creep_force.signatures))
    assert results[1] == pytest.approx(-0.25 * 0.3 * 0.4 * LOAD_N)
    assert results[0] != results[1]
    assert len(kinds) == 1


@pytest.mark.parametrize(
    ("function", "reason"),
    [
        (user_laws.short, "takes 2 arguments .* must take 16"),
        (user_laws.scalar, "must return the two floats"),
        (user_laws.uncompilable, "does not compile"),
        (user_laws.raises, "raises ValueError .out of my table. at creep_x = 1"),
        (user_laws.drives, "drives the slip"),
        (user_laws.unbounded, "beyond mu N"),
        (user_laws.divides, "not finite"),
        (user_laws.lopsided, "not odd"),
        ("circular", "not a Python function"),
        (max, "not a Python function"),
    ],
)
def test_what_is_no_law_is_refused_with_the_reason(function: Callable[..., tuple[float, float]], reason: str) -> None:
    with pytest.raises(UnusableLaw, match=f"creep law mine.* {reason}"):
        compile_law(function, "mine")
