"""The dynamic brake, blended in per bogie, what the WSP does to it, and the magnetic track brake."""

import numpy as np
import pytest

from wsp import FILL, HOLD, VENT, Brake, BrakeParameters

STEP_S = 0.005
FILLED = np.full(4, FILL, np.int8)
PER_BAR_NM = 2 * 2.17 * 0.0507e5 * 0.247 * 0.35  # of an axle, at mean friction


@pytest.fixture(scope="module")
def parameters(presets: dict[str, BrakeParameters]) -> BrakeParameters:
    return presets["dynamic-magnetic-56t"].model_copy(update={"heat": None})


def run(
    brake: Brake, seconds: float, speed_kmh: float = 100.0, demand: float = 1.0, valve: np.ndarray = FILLED
) -> np.void:
    """The record after so many seconds at one speed, wheels rolling."""
    speed = speed_kmh / 3.6
    for _ in range(round(seconds / STEP_S)):
        brake.step(demand, valve, np.full(4, speed / 0.46), speed)
    return brake.record[0]


def test_the_pneumatics_supply_the_rest(parameters: BrakeParameters) -> None:
    """Full service at 100 km/h: 4000 Nm dynamic, pressure for the rest; the sum is what the discs alone would give."""
    b = run(Brake(parameters, STEP_S), 8.0)
    assert b["dynamic_torque_nm"] == pytest.approx(4000.0)
    assert b["cylinder_bar"] == pytest.approx(3.45 - 4000.0 / PER_BAR_NM, abs=0.01)
    # by mean friction; the pads' own differs a little with the speed
    assert b["pad_bar"] * PER_BAR_NM + b["dynamic_torque_nm"] == pytest.approx((3.45 - 0.1) * PER_BAR_NM, rel=1e-3)


def test_light_braking_is_all_dynamic_and_keeps_the_pads_laid_on(parameters: BrakeParameters) -> None:
    b = run(Brake(parameters, STEP_S), 8.0, demand=0.4)
    assert b["dynamic_torque_nm"] == pytest.approx((0.4 * 3.45 - 0.1) * PER_BAR_NM)
    assert b["cylinder_bar"] == pytest.approx(0.1, abs=1e-3)
    assert b["torque_nm"].max() < 10.0


@pytest.mark.parametrize("speed_kmh", [20.0, 100.0, 130.0, 160.0, 200.0])
def test_torque_and_power_are_limited(parameters: BrakeParameters, speed_kmh: float) -> None:
    b = run(Brake(parameters, STEP_S), 8.0, speed_kmh)
    assert b["dynamic_torque_nm"] == pytest.approx(min(4000.0, 315e3 / (speed_kmh / 3.6 / 0.46)))


@pytest.mark.parametrize(("speed_kmh", "share"), [(12.0, 1.0), (8.0, 0.5), (4.0, 0.0), (0.0, 0.0)])
def test_it_fades_out_towards_the_stop_and_the_discs_take_over(
    parameters: BrakeParameters, speed_kmh: float, share: float
) -> None:
    b = run(Brake(parameters, STEP_S), 8.0, speed_kmh)
    assert b["dynamic_torque_nm"] == pytest.approx(4000.0 * share, abs=1e-6)
    assert b["cylinder_bar"] == pytest.approx(3.45 - 4000.0 * share / PER_BAR_NM, abs=0.01)


def test_a_wheel_that_stands_gets_none(parameters: BrakeParameters) -> None:
    """The motor sees its own wheels: it never turns a locked axle backwards."""
    brake = Brake(parameters, STEP_S)
    run(brake, 8.0)
    for _ in range(200):
        brake.step(1.0, FILLED, np.array([60.0, 0.0, 60.0, 60.0]), 27.6)
    assert brake.record["dynamic_torque_nm"][0] == pytest.approx([4000.0, 0.0, 4000.0, 4000.0])


@pytest.mark.parametrize("code", [HOLD, VENT])
def test_valves_of_a_bogie_cut_its_dynamic_brake_at_the_stated_rates(parameters: BrakeParameters, code: int) -> None:
    dynamic = parameters.dynamic_brake
    assert dynamic is not None
    brake = Brake(parameters, STEP_S)
    run(brake, 8.0)
    valve = np.array([FILL, code, FILL, FILL], np.int8)
    run(brake, 0.03 + 0.1, valve=valve)  # dead time, then half of the cut
    cut = brake.record["dynamic_torque_nm"][0].copy()
    assert cut == pytest.approx([4000.0 - 0.1 * dynamic.cut_nmps] * 2 + [4000.0] * 2)
    run(brake, 0.5, valve=valve)
    assert brake.record["dynamic_torque_nm"][0] == pytest.approx([0.0, 0.0, 4000.0, 4000.0])
    # the other axle of the bogie is braked by its discs alone now
    assert brake.cylinder_pressure_bar[0] == pytest.approx(3.45, abs=0.05)
    run(brake, 0.03 + 0.25)
    assert brake.record["dynamic_torque_nm"][0, :2] == pytest.approx(0.25 * dynamic.return_nmps)


def test_only_the_bogies_that_have_it(parameters: BrakeParameters) -> None:
    dynamic = parameters.dynamic_brake
    assert dynamic is not None
    one = parameters.model_copy(update={"dynamic_brake": dynamic.model_copy(update={"bogies": (False, True)})})
    b = run(Brake(one, STEP_S), 8.0)
    assert b["dynamic_torque_nm"] == pytest.approx([0.0, 0.0, 4000.0, 4000.0])
    assert b["cylinder_bar"][:2] == pytest.approx(3.45, abs=1e-3)


@pytest.mark.parametrize(("speed_kmh", "friction"), [(160.0, 0.06), (130.0, 0.0675), (50.0, 0.10), (-50.0, 0.10)])
def test_magnets_pull_by_their_curve(parameters: BrakeParameters, speed_kmh: float, friction: float) -> None:
    brake = Brake(parameters, STEP_S)
    assert run(brake, 2.0, speed_kmh)["track_brake_force_n"].max() == 0.0
    brake.track_brake_on = True
    assert brake.track_brake_on
    assert run(brake, 0.25, speed_kmh)["track_brake_force_n"] == pytest.approx(0.25 * 168e3 * friction)
    assert run(brake, 2.0, speed_kmh)["track_brake_force_n"] == pytest.approx(168e3 * friction)
    brake.track_brake_on = False
    assert run(brake, 2.0, speed_kmh)["track_brake_force_n"].max() == 0.0


def test_magnets_let_go_below_the_cut_out_speed(parameters: BrakeParameters) -> None:
    brake = Brake(parameters, STEP_S)
    brake.track_brake_on = True
    assert run(brake, 2.0, 20.5)["track_brake_force_n"].min() > 20e3
    assert run(brake, 2.0, 19.5)["track_brake_force_n"].max() == 0.0


def test_a_coach_without_magnets_answers_nothing(coach_brake: BrakeParameters) -> None:
    brake = Brake(coach_brake, STEP_S)
    brake.track_brake_on = True
    assert run(brake, 2.0)["track_brake_force_n"].max() == 0.0
