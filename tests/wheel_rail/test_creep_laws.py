"""One battery of invariants over every creep law, a user's among them."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from tests.wheel_rail import user_laws
from tests.wheel_rail.conftest import LOAD_N, SHEAR_PA, law
from wheel_rail.creep_laws import CREEP_LAWS, EXTRA, CreepLaw, LawInForce, creep_force, user_creep_law
from wheel_rail.kalker import creep_coefficients
from wheel_rail.polach import SURFACES, polach_force
from wheel_rail.slip import friction, total_creep

LAWS: dict[str, CreepLaw] = {**CREEP_LAWS, "user": user_creep_law(user_laws.circular, "circular")}
IN_FORCE: dict[str, LawInForce] = {name: entry.in_force() for name, entry in LAWS.items()}
IN_FORCE["kalker-linear, cut"] = CREEP_LAWS["kalker-linear"].in_force(
    CREEP_LAWS["kalker-linear"].Parameters.model_validate({"saturation": "cut"})
)
IN_FORCE["fastsim 7 x 5"] = CREEP_LAWS["fastsim"].in_force(
    CREEP_LAWS["fastsim"].Parameters.model_validate({"nx": 7, "ny": 5})
)
EVERY = pytest.mark.parametrize("name", sorted(IN_FORCE))
CONSTANT = np.array([0.33, 1.0, 0.0, 1.0, 1.0])


def ellipse(a_m: float, ratio: float) -> tuple[float, ...]:
    return (a_m, a_m / ratio, *creep_coefficients(ratio, 0.28), 1.0 + 6.3 * (1.0 - math.exp(-ratio)))


def force(
    name: str, x: float, y: float, spin: float, slip: float, load: float, patch: object, rail: np.ndarray
) -> tuple[float, float, float, float]:
    chosen = IN_FORCE[name]
    return creep_force(chosen.number, chosen.address, chosen.extra, x, y, spin, slip, load, patch, rail, SHEAR_PA)


creeps = st.one_of(st.floats(-1.0, 1.0), st.floats(-1e-2, 1e-2), st.sampled_from([0.0, 1e-15, 1e-9, -1e-6]))
spins = st.one_of(st.just(0.0), st.floats(-1.0, 1.0), st.floats(-200.0, 200.0))
loads = st.one_of(st.floats(100.0, 3e5), st.floats(1e-3, 100.0))
ratios = st.floats(0.1, 10.0)
surfaces = st.sampled_from(sorted(SURFACES))


@EVERY
@settings(max_examples=120, deadline=None)
@given(creeps, creeps, spins, st.floats(0.0, 60.0), loads, st.floats(1e-4, 2e-2), ratios, surfaces)
def test_bounded_odd_dissipative_and_finite(
    name: str, x: float, y: float, spin: float, speed: float, load: float, a_m: float, ratio: float, surface: str
) -> None:
    patch, rail = ellipse(a_m, ratio), law(surface)
    slip = math.hypot(x, y) * speed
    found = force(name, x, y, spin, slip, load, patch, rail)
    fx, fy, _, secant = found
    assert all(math.isfinite(value) for value in found)
    assert math.hypot(fx, fy) <= friction(rail, slip) * load * (1.0 + 1e-12)
    assert secant >= 0.0
    mirrored = force(name, -x, -y, -spin, slip, load, patch, rail)
    assert mirrored[:2] == pytest.approx((-fx, -fy), rel=1e-9, abs=1e-12 * load)
    # left and right are alike: lateral creepage and spin change sign together
    swapped = force(name, x, -y, -spin, slip, load, patch, rail)
    assert swapped[:2] == pytest.approx((fx, -fy), rel=1e-9, abs=1e-9 * load)
    if spin == 0.0:
        assert fx * x + fy * y <= 0.0


@EVERY
@settings(max_examples=40, deadline=None)
@given(creeps, creeps, spins, st.floats(0.0, 60.0), surfaces)
def test_continuous_in_creepage_and_speed(
    name: str, x: float, y: float, spin: float, speed: float, surface: str
) -> None:
    """Steps of 1e-9 in every argument move the force by no more than a few times Kalker's stiffness times the step."""
    patch, rail = ellipse(6e-3, 6.0 / 7.0), law(surface)
    stiffness = SHEAR_PA * patch[0] * patch[1] * max(patch[2:5])
    slip = math.hypot(x, y) * speed
    here = force(name, x, y, spin, slip, 7e4, patch, rail)
    step = 1e-9
    for other in ((x + step, y, spin, slip), (x, y + step, spin, slip), (x, y, spin, slip + step)):
        there = force(name, *other, 7e4, patch, rail)
        assert math.dist(here[:2], there[:2]) <= 10.0 * stiffness * step
    there = force(name, x, y, spin + step, slip, 7e4, patch, rail)
    assert math.dist(here[:2], there[:2]) <= 10.0 * stiffness * step


@EVERY
def test_goes_through_zero_without_a_step(name: str) -> None:
    patch = ellipse(6e-3, 0.8)
    for rail in (law("dry"), law("low")):
        for direction in ((1.0, 0.0), (0.0, 1.0), (0.6, 0.8)):
            sizes = np.linspace(-1e-9, 1e-9, 41)
            forces = np.array(
                [force(name, s * direction[0], s * direction[1], 0.0, 0.0, 7e4, patch, rail) for s in sizes]
            )
            along = forces[:, 0] * direction[0] + forces[:, 1] * direction[1]
            assert np.all(np.diff(along) < 0.0)
            assert np.max(np.abs(np.diff(along))) < 0.005
            assert along[20] == pytest.approx(0.0, abs=1e-12)
        tangents = [force(name, s, 0.0, 0.0, 0.0, 7e4, patch, rail)[2:] for s in (0.0, 1e-13, 1e-9)]
        assert tangents[0] == pytest.approx(tangents[2], rel=1e-3)
        assert tangents[1] == pytest.approx(tangents[2], rel=1e-2)


@EVERY
@settings(max_examples=60, deadline=None)
@given(st.floats(-2e-2, 2e-2), st.floats(-2e-2, 2e-2), st.floats(1e3, 2e5), ratios)
def test_a_heavier_wheel_transmits_more(name: str, x: float, y: float, load: float, ratio: float) -> None:
    """At constant friction; the ellipse grows with the cube root of the load."""
    forces = []
    for share in (1.0, 1.3):
        patch = ellipse(6e-3 * (share * load / 7e4) ** (1.0 / 3.0), ratio)
        fx, fy, _, _ = force(name, x, y, 0.0, 0.0, share * load, patch, CONSTANT)
        forces.append(math.hypot(fx, fy))
    # cell borders of a coarse grid shift against each other
    assert forces[1] >= forces[0] * (1.0 - 1e-9)


FACTORS = {  # of Kalker's linear slope at small creepage: Polach (kA + kS)/2, modified FASTSIM k0
    "polach": 0.5 * (0.3 + 0.1),
    "modified-fastsim": 0.54,
}


@EVERY
@pytest.mark.parametrize("ratio", [0.1, 0.5, 1.0, 2.0, 10.0])
def test_small_creep_gives_kalkers_linear_forces(name: str, ratio: float) -> None:
    patch = ellipse(5e-3, ratio)
    a, b, c11, c22, c23 = patch[:5]
    rail = np.array([0.3, 0.4, 0.2, 0.3, 0.1])
    factor = FACTORS.get(name, 1.0)
    fx, fy, tangent, secant = force(name, 1e-9, 0.0, 0.0, 0.0, 8e4, patch, rail)
    assert (-fx / 1e-9, tangent, secant) == pytest.approx((factor * SHEAR_PA * a * b * c11,) * 3, rel=1e-4)
    assert fy == 0.0
    fx, fy, tangent, secant = force(name, 0.0, 1e-9, 0.0, 0.0, 8e4, patch, rail)
    assert (-fy / 1e-9, tangent, secant) == pytest.approx((factor * SHEAR_PA * a * b * c22,) * 3, rel=1e-4)
    assert fx == 0.0
    if name != "polach":  # whose force of spin is an approximation of its own
        _, fy, _, _ = force(name, 0.0, 0.0, 1e-7, 0.0, 8e4, patch, rail)
        assert -fy / 1e-7 == pytest.approx(factor * SHEAR_PA * (a * b) ** 1.5 * c23, rel=1e-4)


@EVERY
@settings(max_examples=60, deadline=None)
@given(st.floats(1e-6, 0.1), st.floats(0.0, 2.0 * math.pi), st.sampled_from([0.0, 0.05, -1.0]), surfaces)
# on a coarse grid: stress turns over amid a cell; sliding begins where a cell does; strips follow the pole of the slip
@example(1e-6, 5.0, -1.0, "very-low")
@example(3.4e-5, 4.518, -1.0, "dry")
@example(5.5e-6, 6.271, -1.0, "wet")
def test_tangent_and_secant_are_those_of_the_force(
    name: str, size: float, angle: float, spin: float, surface: str
) -> None:
    if name == "polach":
        spin = 0.0  # his tangent leaves the force of spin aside
    patch, rail = ellipse(6e-3, 6.0 / 7.0), law(surface)
    direction = (math.cos(angle), math.sin(angle))

    def at(creep: float) -> tuple[float, float, float, float]:
        return force(name, creep * direction[0], creep * direction[1], spin, 20.0 * creep, 7e4, patch, rail)

    fx, fy, tangent, secant = at(size)
    total = total_creep(size * direction[0], size * direction[1], spin, patch[0])
    assert secant * total == pytest.approx(math.hypot(fx, fy), rel=1e-9)
    # one-sided differences: the tangent lies between them where a law has a kink
    step = 1e-6 * size
    sides = []
    for sign in (1.0, -1.0):
        there = at(size + sign * step)
        sides.append(-sign * ((there[0] - fx) * direction[0] + (there[1] - fy) * direction[1]) / step)
    slope = SHEAR_PA * patch[0] * patch[1] * patch[2]
    # with spin the fall of friction is followed approximately; a user's tangent is itself a difference
    tolerance = (2e-3 if name == "user" else 1e-5) * slope if spin == 0.0 else 0.02 * slope
    assert min(sides) - tolerance <= tangent <= max(sides) + tolerance


def test_polach_through_the_dispatcher_is_polach() -> None:
    patch = ellipse(6e-3, 0.7)
    for x in (0.0, 1e-4, -0.02):
        arguments = (x, 0.003, 0.2, 0.4, 6e4, patch, law("wet"), SHEAR_PA)
        assert creep_force(1, 0, np.zeros(EXTRA), *arguments) == polach_force(*arguments)


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("fastsim", {"nx": 1}),
        ("fastsim", {"ny": 2}),
        ("fastsim", {"nz": 10}),
        ("modified-fastsim", {"k0": 0.0}),
        ("modified-fastsim", {"alpha_inf": 1.5}),
        ("modified-fastsim", {"beta": -1.0}),
        ("kalker-linear", {"saturation": "none"}),
        ("polach", {"k_adhesion": 1.0}),
    ],
)
def test_bad_parameters_are_refused(name: str, given: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        CREEP_LAWS[name].Parameters.model_validate(given)


def test_no_friction_or_no_load_gives_no_force(patch: np.ndarray) -> None:
    for name in IN_FORCE:
        assert force(name, 0.01, 0.02, 0.1, 0.0, 0.0, patch, law("dry"))[:2] == (0.0, 0.0)
        assert force(name, 0.01, 0.02, 0.1, 0.0, LOAD_N, patch, np.array([0.0, 0.4, 0.2, 1.0, 0.4]))[:2] == (0.0, 0.0)
