"""Static loads and curving. Closed forms of curves are cases of the verification."""

import numpy as np
import pytest

from vehicle import CoachParameters
from vehicle.curving import balance_speed_mps, deficiency_speed_mps, run_in_curve
from vehicle.static_loads import static_loads


def test_every_wheel_bears_its_eighth(parameters: CoachParameters) -> None:
    loads = static_loads(parameters)
    assert loads.wheel_load_n == pytest.approx(np.full(8, parameters.static_wheel_load_n), rel=1e-6)
    # every body stands where the design has it
    assert np.abs(loads.lift_m).max() < 1e-6


def test_springs_bear_what_is_above_them(parameters: CoachParameters) -> None:
    loads = static_loads(parameters)
    primary, secondary = loads.spring_load_n[:8], loads.spring_load_n[8:]
    body, bogies = parameters.body.mass_kg, 2.0 * parameters.bogie.mass_kg
    assert primary.sum() == pytest.approx(9.81 * (body + bogies), rel=1e-6)
    assert secondary.sum() == pytest.approx(9.81 * body, rel=1e-6)
    assert loads.spring_deflection_m[:8] == pytest.approx(primary / parameters.primary_at_axle[0][2])


def test_speeds_of_a_canted_curve() -> None:
    """150 mm of cant over 1.5 m balance a tenth of gravity's tangent; deficiency counts as missing cant."""
    assert balance_speed_mps(1000.0, 150.0) ** 2 / 1000.0 == pytest.approx(9.81 * np.tan(np.arcsin(0.1)))
    assert deficiency_speed_mps(1000.0, 100.0, 50.0) == balance_speed_mps(1000.0, 150.0)


def test_curve_on_profiles(parameters: CoachParameters) -> None:
    """At 130 mm deficiency in 600 m the outer rail bears more, all loads together carry the coach, and the leading
    wheelsets stand further out than the trailing ones."""
    run = run_in_curve(parameters, 600.0, 100.0, deficiency_speed_mps(600.0, 100.0, 130.0), step_s=0.001)
    weight_n = parameters.mass_kg * run.downwards_mps2
    assert run.wheel_load_n.sum() == pytest.approx(weight_n, rel=2e-3)
    assert 0.2 < run.outer_share < 0.35
    assert run.body_roll_rad > 0.01
    assert run.guiding_force_n.sum() == pytest.approx(parameters.mass_kg * run.unbalanced_mps2, rel=0.015)
    lead, trail = run.displacement_m[0::2], run.displacement_m[1::2]
    assert (lead < trail).all()
    assert (trail < 0.0).all()
