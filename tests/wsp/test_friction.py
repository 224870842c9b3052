"""Friction of pads and blocks over speed, force and temperature, and the heat balance of the discs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from wsp import FILL, Brake, BrakeParameters
from wsp.brake_record import TEMPERATURE_FACTOR, brake_record
from wsp.friction import curve_value, karwatzki_friction

FILLED = np.full(4, FILL, np.int8)
ROTATING_KG = 4 * 110.0 / 0.46**2


def stop(parameters: BrakeParameters, speed_kmh: float, mass_kg: float = 56_000.0) -> np.ndarray:
    """Full service on dry rail to standstill, 5 ms: rows of time, speed, brake force (N), temperature."""
    brake = Brake(parameters, 0.005)
    speed, rows = speed_kmh / 3.6, []
    while speed > 0.0:
        torque = brake.step(1.0, FILLED, np.full(4, speed / 0.46), speed)
        force = torque.sum() / 0.46
        rows.append((0.005 * len(rows), speed, force, brake.record["disc_temperature_degc"][0, 0]))
        speed -= force / (mass_kg + ROTATING_KG) * 0.005
    return np.array(rows)


@pytest.mark.parametrize("speed_kmh", [120.0, 140.0])
def test_mean_friction_of_the_discs_is_the_quoted_one(coach_brake: BrakeParameters, speed_kmh: float) -> None:
    """0.35 as the mean by distance over the stop after the build-up; the coach then brakes at about 0.95 m/s2."""
    time, speed, force, _ = stop(coach_brake, speed_kmh).T
    built_up = time > 5.0
    mean_force = np.average(force[built_up], weights=speed[built_up])
    pads_n = 4 * 2 * 2.17 * 0.0507e5 * (3.45 - 0.1)
    friction = mean_force * 0.46 / (pads_n * 0.247)
    deceleration = mean_force / (56_000 + ROTATING_KG)
    print(f"{speed_kmh} km/h: mean friction {friction:.4f}, deceleration {deceleration:.4f} m/s2")
    assert friction == pytest.approx(0.35, rel=0.01)
    assert deceleration == pytest.approx(0.95, rel=0.01)


def test_karwatzki_at_hand_worked_points() -> None:
    """0.6 (16 F/g + 100)/(80 F/g + 100) (v + 100)/(5 v + 100): at rest without force 0.6; F/g = 1 t at 100 km/h."""
    assert karwatzki_friction(0.0, 0.0) == pytest.approx(0.6)
    assert karwatzki_friction(100.0, 9.81) == pytest.approx(0.6 * 116.0 / 180.0 / 3.0)
    assert karwatzki_friction(1e9, 1e9) == pytest.approx(0.6 * 0.2 * 0.2, rel=1e-3)


@given(st.floats(0.0, 200.0), st.floats(0.0, 60.0), st.floats(0.1, 50.0))
def test_cast_iron_grips_better_slowly_and_lightly_pressed(speed_kmh: float, force_kn: float, more: float) -> None:
    here = karwatzki_friction(speed_kmh, force_kn)
    assert karwatzki_friction(speed_kmh + more, force_kn) < here
    assert karwatzki_friction(speed_kmh, force_kn + more) < here
    # more pressed it still brakes more
    assert karwatzki_friction(speed_kmh, force_kn + more) * (force_kn + more) > here * force_kn


def test_the_tread_brake_pulls_harder_towards_the_stop(presets: dict[str, BrakeParameters]) -> None:
    """The known character of cast iron; and its torque is the formula's at the force of a single block."""
    parameters = presets["tread-cast-iron-56t"]
    _, speed, force, _ = stop(parameters, 120.0).T
    at = {kmh: force[np.argmin(np.abs(speed - kmh / 3.6))] for kmh in (80.0, 40.0, 10.0)}
    assert at[10.0] > 1.5 * at[80.0]
    block_kn = 2 * 2.7 * 0.0507e2 * (3.8 - 0.3) / 8
    for kmh, found in at.items():
        friction = 0.6 * (16 * block_kn / 9.81 + 100) / (80 * block_kn / 9.81 + 100) * (kmh + 100) / (5 * kmh + 100)
        assert found == pytest.approx(4 * 8 * 1e3 * block_kn * friction, rel=0.01)


def test_curves_are_linear_between_points_and_flat_beyond(coach_brake: BrakeParameters) -> None:
    b = brake_record(coach_brake, 0.005)[0]
    curve = coach_brake.friction_curve
    places = np.linspace(-50.0, 600.0, 300)
    expected = np.interp(places, curve.temperature_degc, curve.temperature_factor)
    found = [curve_value(TEMPERATURE_FACTOR, place, b) for place in places]
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_hot_discs_fade(coach_brake: BrakeParameters) -> None:
    brake = Brake(coach_brake, 0.005)
    for _ in range(1000):
        cold = brake.step(1.0, FILLED, np.full(4, 50.0), 23.0).copy()
    brake.record["disc_temperature_degc"] = 400.0
    hot = brake.step(1.0, FILLED, np.full(4, 50.0), 23.0)
    assert hot == pytest.approx(cold * np.interp(400.0, [300.0, 450.0], [0.95, 0.80]), rel=1e-3)


def test_the_discs_take_the_coachs_kinetic_energy(coach_brake: BrakeParameters) -> None:
    """Without cooling the heat capacity times the rise is the kinetic energy of coach and wheelsets."""
    heat = coach_brake.heat
    assert heat is not None
    cold = heat.model_copy(update={"cooling_wpk": 0.0, "cooling_speed_wspkm": 0.0, "radiating_area_m2": 0.0})
    rows = stop(coach_brake.model_copy(update={"heat": cold}), 160.0)
    energy_j = 0.5 * (56_000 + ROTATING_KG) * (160 / 3.6) ** 2
    assert 4 * heat.heat_capacity_jpk * (rows[-1, 3] - 20.0) == pytest.approx(energy_j, rel=2e-3)
    print(f"stop from 160 km/h: discs at {stop(coach_brake, 160.0)[-1, 3]:.0f} degC")


@pytest.mark.parametrize("speed_mps", [0.0, 40.0])
def test_cooling_agrees_with_an_independent_integration(coach_brake: BrakeParameters, speed_mps: float) -> None:
    heat = coach_brake.heat
    assert heat is not None

    def slope(_: float, t: np.ndarray) -> np.ndarray:
        radiated = heat.radiating_area_m2 * 5.670374e-8 * ((t + 273.15) ** 4 - 293.15**4)
        return -((30.0 + 6.0 * speed_mps) * (t - 20.0) + radiated) / heat.heat_capacity_jpk

    brake = Brake(coach_brake, 0.005)
    brake.record["disc_temperature_degc"] = 350.0
    for _ in range(round(120.0 / 0.005)):
        brake.step(0.0, FILLED, np.full(4, speed_mps / 0.46), speed_mps)
    exact = solve_ivp(slope, (0.0, 120.0), [350.0], rtol=1e-9).y[0, -1]
    assert brake.record["disc_temperature_degc"][0] == pytest.approx(exact, abs=1e-3)


def test_a_locked_wheel_heats_nothing_and_without_heat_nothing_warms(coach_brake: BrakeParameters) -> None:
    brake = Brake(coach_brake, 0.005)
    cold = Brake(coach_brake.model_copy(update={"heat": None}), 0.005)
    rates = np.array([60.0, 0.0, 60.0, -60.0])
    for _ in range(2000):
        brake.step(1.0, FILLED, rates, 27.6)
        cold.step(1.0, FILLED, rates, 27.6)
    temperature = brake.record["disc_temperature_degc"][0]
    assert temperature[1] == pytest.approx(20.0)
    assert temperature[0] == temperature[2] == temperature[3] > 30.0  # the sense of rotation does not matter
    assert cold.record["disc_temperature_degc"][0] == pytest.approx(20.0)
