"""ISO 6358 flow and the pressures that follow from it, against the formulae and an independent integration."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from wsp.pneumatics import ATMOSPHERE_BAR, mass_flow_kgps, pressure_emptied_bar, pressure_filled_bar

PRESSURES = st.floats(1.0, 11.0)
RATIOS = st.floats(0.05, 0.9)


def flow_factor(ratio: float, critical: float) -> float:
    """The flow over the choked one, written independently of the package."""
    return 1.0 if ratio <= critical else math.sqrt(max(0.0, 1 - ((ratio - critical) / (1 - critical)) ** 2))


def test_choked_flow_is_c_rho0_p1_sqrt_t0_over_t() -> None:
    assert mass_flow_kgps(8.0, 0.3, 5.0, 1.4, 293.15) == pytest.approx(8e-3 * 1.185 * 5.0)
    assert mass_flow_kgps(8.0, 0.3, 5.0, 0.2, 260.0) == pytest.approx(8e-3 * 1.185 * 5.0 * math.sqrt(293.15 / 260.0))


@given(RATIOS, PRESSURES)
def test_flow_is_continuous_at_the_critical_ratio_and_ends_at_equal_pressures(critical: float, upstream: float) -> None:
    below = mass_flow_kgps(5.0, critical, upstream, upstream * (critical - 1e-9), 293.15)
    above = mass_flow_kgps(5.0, critical, upstream, upstream * (critical + 1e-9), 293.15)
    assert above == pytest.approx(below, rel=1e-12)
    assert mass_flow_kgps(5.0, critical, upstream, upstream, 293.15) == 0.0
    assert mass_flow_kgps(5.0, critical, upstream, 1.1 * upstream, 293.15) == 0.0


@given(RATIOS, PRESSURES, st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_flow_falls_as_the_downstream_pressure_rises(critical: float, upstream: float, one: float, two: float) -> None:
    low, high = sorted((one, two))
    less = mass_flow_kgps(5.0, critical, upstream, high * upstream, 293.15)
    assert less <= mass_flow_kgps(5.0, critical, upstream, low * upstream, 293.15)


@pytest.mark.parametrize("exchange", [0.05, 0.3, 0.8, 1.2])
def test_filling_agrees_with_an_independent_integration(exchange: float) -> None:
    source = 4.813
    solution = solve_ivp(
        lambda _, p: [source * flow_factor(p[0] / source, 0.3)], (0, exchange), [1.013], rtol=1e-10, atol=1e-12
    )
    assert pressure_filled_bar(1.013, source, exchange, 0.3) == pytest.approx(solution.y[0, -1], rel=1e-7)


@pytest.mark.parametrize("exchange", [0.05, 0.3, 0.8, 1.6])
@pytest.mark.parametrize("critical", [0.3, 0.5, 0.7])
def test_emptying_agrees_with_an_independent_integration(exchange: float, critical: float) -> None:
    solution = solve_ivp(
        lambda _, p: [-p[0] * flow_factor(ATMOSPHERE_BAR / p[0], critical)],
        (0, exchange),
        [4.813],
        rtol=1e-10,
        atol=1e-12,
    )
    assert pressure_emptied_bar(4.813, ATMOSPHERE_BAR, exchange, critical) == pytest.approx(solution.y[0, -1], rel=1e-6)


def test_equal_pressures_are_reached_in_finite_time_and_kept() -> None:
    # choked 0.3, then a quarter turn of (1 - b)
    needed = 0.3 + 0.7 * math.pi / 2
    assert pressure_filled_bar(1e-9, 4.0, needed * 0.9999, 0.3) < 4.0
    assert pressure_filled_bar(1e-9, 4.0, needed * 1.0001, 0.3) == 4.0
    assert pressure_emptied_bar(4.0, 1.013, 50.0, 0.3) == 1.013
    assert pressure_filled_bar(4.0, 4.0, 1.0, 0.3) == 4.0
    assert pressure_emptied_bar(1.013, 1.013, 1.0, 0.3) == 1.013


@given(PRESSURES, PRESSURES, RATIOS, st.floats(0.0, 3.0), st.floats(0.0, 1.0))
def test_one_long_step_is_two_short_ones(one: float, two: float, critical: float, exchange: float, cut: float) -> None:
    low, high = sorted((one, two))
    halfway = pressure_filled_bar(low, high, cut * exchange, critical)
    assert low <= halfway <= high
    assert pressure_filled_bar(halfway, high, (1 - cut) * exchange, critical) == pytest.approx(
        pressure_filled_bar(low, high, exchange, critical), rel=1e-6
    )
    halfway = pressure_emptied_bar(high, low, cut * exchange, critical)
    assert low <= halfway <= high
    assert pressure_emptied_bar(halfway, low, (1 - cut) * exchange, critical) == pytest.approx(
        pressure_emptied_bar(high, low, exchange, critical), rel=1e-6
    )
