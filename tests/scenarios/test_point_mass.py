"""The reduced model: closed forms, both forms of its accelerometer, and scenarios driven through it."""

import numpy as np
import pytest

from scenarios.compare_models import speed_difference
from scenarios.point_mass import POINT_MASSES, STEP_S, Line, PointMass, simulate_point_mass
from scenarios.point_mass_drive import drive_point_mass
from scenarios.scenario_file import load_scenario
from vehicle import GRAVITY_MPS2

MASS_KG, GRAVITY = 56_000.0, GRAVITY_MPS2
FREE = PointMass((0.0, 0.0, 0.0), 0.0, "sound")
FREE_AS_PRINTED = PointMass((0.0, 0.0, 0.0), 0.0, "printed")
LEVEL = Line(np.zeros(1), np.zeros(0))


def forces(*parts: tuple[float, float]) -> np.ndarray:
    """(seconds, m/s2) after each other, as the force of 56 t."""
    return np.concatenate([np.full(round(seconds / STEP_S), MASS_KG * a) for seconds, a in parts])


def test_constant_force_without_resistance() -> None:
    run = simulate_point_mass(FREE, MASS_KG, forces((30.0, 0.8)), LEVEL)
    assert run.speed_mps[-1] == pytest.approx(24.0, rel=1e-9)
    assert run.position_m[-1] == pytest.approx(360.0, rel=1e-9)
    assert run.acceleration_mps2[:-1] == pytest.approx(0.8)


def test_steady_speed_is_where_the_force_equals_the_resistance() -> None:
    """W = 2 + 0.01 V + 0.0005 V^2 N/kN is 8 N/kN at 100 km/h."""
    model = PointMass((2.0, 0.01, 0.0005), 0.0, "sound")
    force = np.full(round(1000.0 / STEP_S), 8.0 * MASS_KG * GRAVITY / 1000.0)
    run = simulate_point_mass(model, MASS_KG, force, LEVEL, 27.0)
    assert 3.6 * run.speed_mps[-1] == pytest.approx(100.0, abs=0.1)


def test_resistance_as_printed_is_zero_at_rest_and_out_of_reason_at_speed() -> None:
    printed, sound = POINT_MASSES["point-mass-as-printed"], POINT_MASSES["point-mass"]
    assert printed.resistance(0.0) == sound.resistance(0.0) == 0.0
    assert printed.resistance(200.0 / 3.6) == pytest.approx(0.78 + 140.0 + 40.0)
    # a coach's own resistance is 8 N/kN there: 873 N + 18.43 N per m/s + 0.8146 N per (m/s)^2
    v = 200.0 / 3.6
    assert sound.resistance(v) == pytest.approx(
        (873.0 + 18.43 * v + 0.8146 * v * v) / (MASS_KG * GRAVITY) * 1e3, rel=2e-3
    )


def test_gradient_is_interpolated_between_its_hundred_metres() -> None:
    """From 0 to 20 per mille over 100 m, then level: a train that just makes it loses 2 g h by then."""
    line = Line(np.array([0.0, 20.0, 20.0, 0.0, 0.0]), np.zeros(0))
    run = simulate_point_mass(FREE, MASS_KG, forces((20.0, 0.0)), line, 30.0)
    assert np.interp(50.0, run.position_m, run.gradient_permille) == pytest.approx(10.0, abs=0.01)
    height = np.trapezoid(np.sin(np.arctan(run.gradient_permille / 1000.0)), run.position_m)
    assert height == pytest.approx(4.0, rel=1e-3)
    assert run.speed_mps[-1] ** 2 == pytest.approx(30.0**2 - 2.0 * GRAVITY * height, rel=1e-4)


def test_speed_is_clipped_and_acceleration_is_that_of_the_clipped_speed() -> None:
    run = simulate_point_mass(FREE, MASS_KG, forces((80.0, 1.0), (70.0, -1.0)), LEVEL)
    assert 3.6 * run.speed_mps.max() == pytest.approx(220.0)
    at_top = (run.t_s > 62.0) & (run.t_s < 79.9)
    assert (run.acceleration_mps2[at_top] == 0.0).all()
    assert run.speed_mps[-1] == 0.0
    assert (run.acceleration_mps2[run.t_s > 142.0] == 0.0).all()


def test_accelerometer_on_a_gradient_sound_and_as_printed() -> None:
    """Held on 30 per mille, then let climb with 0.5 m/s2: only the sound channel has gravity in it throughout."""
    line = Line(np.full(100, 30.0), np.zeros(0))
    pull = GRAVITY * np.sin(np.arctan(0.03))
    force = forces((5.0, pull), (20.0, pull + 0.5))
    sound = simulate_point_mass(FREE, MASS_KG, force, line).specific_force_mps2[:, 0]
    printed = simulate_point_mass(FREE_AS_PRINTED, MASS_KG, force, line).specific_force_mps2[:, 0]
    rests, climbs = slice(10, 490), slice(510, 2400)
    assert sound[rests] == pytest.approx(pull, abs=1e-6)
    assert sound[climbs] == pytest.approx(pull + 0.5, abs=1e-6)
    assert printed[rests] == pytest.approx(pull, abs=1e-6)
    assert printed[climbs] == pytest.approx(0.5, abs=1e-6)
    up = simulate_point_mass(FREE, MASS_KG, force, line).specific_force_mps2[:, 2]
    assert up == pytest.approx(GRAVITY * np.cos(np.arctan(0.03)))


def test_lateral_acceleration_in_curves() -> None:
    radius = np.full(40, np.inf)
    radius[10:20], radius[20:30], radius[30:] = 1000.0, -500.0, 20_000.0  # 500 to 1000 m, to 1500 m, beyond
    run = simulate_point_mass(FREE, MASS_KG, forces((60.0, 0.0)), Line(np.zeros(1), radius), 30.0)
    lateral = run.specific_force_mps2[:, 1]
    for place, expected in ((250.0, 0.0), (750.0, 0.9), (1250.0, -1.8), (1700.0, 0.0)):
        assert np.interp(place, run.position_m, lateral) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("radius", [300.0, -349.0, 0.0, float("nan")])
def test_curves_tighter_than_350_m_are_refused(radius: float) -> None:
    with pytest.raises(ValueError, match=r"radius_m\[1\]"):
        Line(np.zeros(2), np.array([np.inf, radius]))


def test_gradients_must_be_numbers() -> None:
    with pytest.raises(ValueError, match="gradient_permille"):
        Line(np.array([0.0, np.nan]), np.zeros(0))


def test_adhesion_limits_the_brake_of_a_driven_scenario() -> None:
    """Friction of 0.05 at every slip: it stops with 0.05 g and the resistance, whatever the brake could do."""
    curve = "{mu0=0.05, falling_a=1.0, falling_b_spm=0.0, k_adhesion=1.0, k_slip=1.0}"
    scenario = load_scenario(
        "low-adhesion-stop",
        [
            "track.curves=[]",
            "track.gradients=[]",
            f"adhesion.stretches=[{{from_m=0.0, recovery={{tau_mpj=1e-12, degraded={curve}, recovered={curve}}}}}]",
            'driver.phases=[{from_m=0.0, action="brake", demand=1.0}]',
            "simulation.initial_speed_kmh=90",
        ],
    )
    run = drive_point_mass(scenario, POINT_MASSES["point-mass"])
    at = (run.t_s > 10.0) & (run.t_s < 12.0)
    resistance = POINT_MASSES["point-mass"].resistance(float(run.speed_mps[at].mean())) * GRAVITY / 1000.0
    assert -run.acceleration_mps2[at].mean() == pytest.approx(0.05 * GRAVITY + resistance, rel=0.01)
    assert run.t_s[-1] - run.t_s[np.argmax(run.speed_mps == 0.0)] == pytest.approx(2.0, abs=0.2)


def test_speeds_are_compared_at_the_same_places() -> None:
    """v^2 = 2 a s at 0.5 and at 0.32 m/s2: at every place the slower has 0.8 of the speed."""
    t = np.arange(0.0, 60.0, 0.01)
    found = speed_difference(0.5 * 0.5 * t**2, 0.5 * t, 0.5 * 0.32 * t**2, 0.32 * t)
    expected = 3.6 * 0.2 * np.sqrt(2.0 * 0.5 * found.position_m)
    assert found.position_m[-1] == pytest.approx(0.5 * 0.32 * 60.0**2, abs=11.0)
    assert found.speed_kmh == pytest.approx(expected, abs=0.02)
    assert found.largest_kmh == pytest.approx(expected[-1], abs=0.02)
    assert found.rms_kmh == pytest.approx(np.sqrt(np.mean(expected**2)), rel=1e-3)
