"""The brake plant: published times, air balance, dead time, convergence, bounds."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from wsp import FILL, HOLD, VENT, Brake, BrakeParameters

STEP_S = 0.0005


def codes(code: int) -> np.ndarray:
    return np.full(4, code, np.int8)


def at_rest(parameters: BrakeParameters, step_s: float = STEP_S, **changes: Any) -> Brake:
    """A brake whose distributor and cylinders have come to the full service pressure."""
    changed = parameters.model_copy(update=changes)
    brake = Brake(changed, step_s)
    for _ in range(round((changed.application_time_s + 1.0) / step_s)):
        brake.step(1.0, codes(FILL))
    return brake


def time_until(brake: Brake, code: int, pressure_bar: float) -> float:
    """Seconds of a command until the cylinders pass a pressure, without the dead time."""
    start = brake.cylinder_pressure_bar[0]
    for step in range(round(5.0 / brake.step_s)):
        brake.step(1.0, codes(code))
        if (brake.cylinder_pressure_bar[0] - pressure_bar) * (start - pressure_bar) <= 0:
            return (step + 1) * brake.step_s - brake.parameters.valve_dead_time_s
    raise AssertionError("the pressure is never reached")


@pytest.mark.parametrize(("down_to_bar", "published_s"), [(0.4, 0.40), (1.9, 0.16)])
def test_venting_takes_the_published_time(coach_brake: BrakeParameters, down_to_bar: float, published_s: float) -> None:
    brake = at_rest(coach_brake, full_service_pressure_bar=3.8)
    found = time_until(brake, VENT, down_to_bar)
    print(f"vent 3.8 to {down_to_bar} bar: {found:.3f} s, published {published_s} s")
    assert found == pytest.approx(published_s, rel=0.10)


@pytest.mark.parametrize(("from_bar", "to_bar", "published_s"), [(0.4, 1.9, 0.16), (0.0, 3.6, 0.47)])
def test_filling_takes_the_published_time(
    coach_brake: BrakeParameters, from_bar: float, to_bar: float, published_s: float
) -> None:
    brake = at_rest(coach_brake, full_service_pressure_bar=3.8, valve_dead_time_s=0.0)
    if from_bar > 0.0:
        time_until(brake, VENT, from_bar)
    else:
        for _ in range(round(3.0 / STEP_S)):
            brake.step(1.0, codes(VENT))
    for _ in range(round(0.1 / STEP_S)):  # shut, so that the filling starts from still valves
        brake.step(1.0, codes(HOLD))
    found = time_until(brake, FILL, to_bar)
    print(f"fill {from_bar} to {to_bar} bar: {found:.3f} s, published {published_s} s")
    assert found == pytest.approx(published_s, rel=0.10)


def test_distributor_builds_up_and_releases_in_the_published_times(coach_brake: BrakeParameters) -> None:
    assert 3.0 <= coach_brake.application_time_s <= 5.0
    brake = Brake(coach_brake, 0.005)
    full = coach_brake.full_service_pressure_bar
    seen = []
    for _ in range(round(5.0 / 0.005)):
        brake.step(1.0, codes(FILL))
        seen.append(brake.distributor_pressure_bar)
    assert 0.005 * (1 + np.argmax(np.array(seen) >= full - 1e-9)) == pytest.approx(
        coach_brake.application_time_s, abs=0.01
    )
    steps = 0
    while brake.cylinder_pressure_bar.max() > 0.4:
        brake.step(0.0, codes(FILL))
        steps += 1
    assert 15.0 <= steps * 0.005 <= 20.0


def test_deceleration_of_the_class_and_of_the_preset(coach_brake: BrakeParameters) -> None:
    rotating_kg = 4 * 110.0 / 0.46**2
    published = at_rest(coach_brake, full_service_pressure_bar=3.0).step(1.0, codes(FILL)).sum() / 0.46
    print(f"52 t, 3.0 bar: {published / (52_000 + rotating_kg):.3f} m/s2, published 0.90")
    assert published / (52_000 + rotating_kg) == pytest.approx(0.90, rel=0.02)
    own = at_rest(coach_brake).step(1.0, codes(FILL)).sum() / 0.46
    assert own / (56_000 + rotating_kg) == pytest.approx(0.95, rel=0.01)


def test_a_full_vent_and_refill_costs_the_published_air(coach_brake: BrakeParameters) -> None:
    brake = at_rest(coach_brake, full_service_pressure_bar=3.8)
    before = brake.air_nl
    for code, seconds in ((VENT, 3.0), (FILL, 3.0)):
        for _ in range(round(seconds / STEP_S)):
            brake.step(1.0, codes(code))
    assert (brake.air_nl - before) / 4 == pytest.approx(9.4, rel=0.01)


def test_torque_is_two_discs_with_both_pads(coach_brake: BrakeParameters) -> None:
    brake = at_rest(coach_brake)
    pads_n = 2.17 * 0.0507 * (brake.cylinder_pressure_bar - 0.1) * 1e5
    np.testing.assert_allclose(brake.step(1.0, codes(FILL)), 2 * 0.35 * pads_n * 0.247, rtol=1e-9)


def test_pads_lie_off_below_the_return_springs_pressure(coach_brake: BrakeParameters) -> None:
    brake = Brake(coach_brake, 0.005)
    demand = 0.9 * coach_brake.return_spring_pressure_bar / coach_brake.full_service_pressure_bar
    for _ in range(400):
        torque = brake.step(demand, codes(FILL))
    assert brake.cylinder_pressure_bar.min() > 0.0
    assert torque.max() == 0.0


@pytest.mark.parametrize("step_s", [0.005, 0.0025, 0.002, 0.001, 0.0005])
def test_a_command_acts_after_the_dead_time_to_the_sample(coach_brake: BrakeParameters, step_s: float) -> None:
    brake = at_rest(coach_brake, step_s)
    dead = round(0.030 / step_s)
    command = np.array([FILL, VENT, HOLD, FILL], np.int8)
    full = brake.cylinder_pressure_bar.copy()
    for _ in range(dead):
        brake.step(1.0, command)
        np.testing.assert_array_equal(brake.valve_state, codes(FILL))
        np.testing.assert_array_equal(brake.cylinder_pressure_bar, full)
    brake.step(1.0, command)
    np.testing.assert_array_equal(brake.valve_state, command)
    assert brake.cylinder_pressure_bar[1] < full[1]
    np.testing.assert_array_equal(brake.cylinder_pressure_bar[[0, 2, 3]], full[[0, 2, 3]])


def worked(brake: Brake, until_s: float = 8.0) -> tuple[np.ndarray, float]:
    """Pressures every 10 ms and air of a brake whose valves go through pulses while it is applied and released."""
    per_tick = round(0.01 / brake.step_s)
    rows = []
    for tick in range(round(until_s / 0.01)):
        cycle = tick % 40
        valve = np.array([VENT if cycle < 12 else HOLD if cycle < 20 else FILL] * 4, np.int8)
        valve[1] = FILL
        valve[2] = HOLD if cycle < 30 else FILL
        for _ in range(per_tick):
            brake.step(1.0 if tick < 500 else 0.3, valve)
        rows.append(brake.cylinder_pressure_bar.copy())
    return np.array(rows), brake.air_nl


def test_results_converge_with_the_step(coach_brake: BrakeParameters) -> None:
    finest, air = worked(Brake(coach_brake, 0.00025))
    errors = []
    for step_s in (0.005, 0.0025, 0.001, 0.0005):
        pressures, drawn = worked(Brake(coach_brake, step_s))
        errors.append(np.abs(pressures - finest).max())
        assert drawn == pytest.approx(air, rel=0.2 * step_s)
    print("largest pressure errors, bar:", errors)
    assert errors[0] < 0.02
    assert errors[3] < 0.25 * errors[0]
    assert np.all(np.diff(errors) < 0)


def test_cylinders_in_balance_do_not_chatter(coach_brake: BrakeParameters) -> None:
    brake = Brake(coach_brake, 0.005)
    last = 0.0
    for _ in range(1000):
        brake.step(1.0, codes(FILL))
        assert last <= brake.cylinder_pressure_bar[0] <= brake.distributor_pressure_bar
        last = brake.cylinder_pressure_bar[0]
    assert last == coach_brake.full_service_pressure_bar


def test_same_commands_give_the_same_bytes(coach_brake: BrakeParameters) -> None:
    first, second = worked(Brake(coach_brake, 0.001)), worked(Brake(coach_brake, 0.001))
    assert first[0].tobytes() == second[0].tobytes()
    assert first[1] == second[1]


COMMANDS = st.lists(
    st.tuples(st.floats(0.0, 1.0), st.lists(st.integers(FILL, VENT), min_size=4, max_size=4), st.integers(1, 60)),
    min_size=1,
    max_size=12,
)


@settings(deadline=None, max_examples=60)
@given(COMMANDS, st.sampled_from([0.005, 0.002, 0.0005]), st.floats(-40.0, 60.0))
def test_pressures_stay_bounded_and_air_balances(
    coach_brake: BrakeParameters, commands: list[tuple[float, list[int], int]], step_s: float, temperature_degc: float
) -> None:
    parameters = coach_brake.model_copy(update={"air_temperature_degc": temperature_degc, "application_time_s": 0.3})
    brake = Brake(parameters, step_s)
    highest = 0.0
    drawn = vented = 0.0
    for demand, valve, steps in commands:
        for _ in range(steps):
            torque = brake.step(demand, np.array(valve, np.int8))
            highest = max(highest, brake.distributor_pressure_bar)
            assert torque.min() >= 0.0
            assert brake.cylinder_pressure_bar.min() >= 0.0
            assert brake.cylinder_pressure_bar.max() <= highest + 1e-12  # rounding of gauge to absolute
            assert brake.air_nl >= drawn
            assert brake.vented_nl >= vented
            drawn, vented = brake.air_nl, brake.vented_nl
    held = brake.cylinder_pressure_bar.sum() * 2.5 / 1.013 * 293.15 / (temperature_degc + 273.15)
    assert drawn == pytest.approx(held + vented, rel=1e-6, abs=1e-9)
    assert highest <= parameters.full_service_pressure_bar


@pytest.mark.parametrize(
    ("demand", "valve"),
    [
        (1.2, [0, 0, 0, 0]),
        (-0.1, [0, 0, 0, 0]),
        (math.nan, [0, 0, 0, 0]),
        (1.0, [0, 0, 3, 0]),
        (1.0, [-1, 0, 0, 0]),
        (1.0, [0, 0]),
    ],
)
def test_refused_commands_change_nothing(coach_brake: BrakeParameters, demand: float, valve: list[int]) -> None:
    brake = at_rest(coach_brake, 0.005)
    before = brake.plant_state.copy()
    with pytest.raises(ValueError, match=r"demand of 0\.\.1 and 4 valve codes"):
        brake.step(demand, np.array(valve, np.int8))
    np.testing.assert_array_equal(brake.plant_state, before)


def test_plant_state_names_its_places(coach_brake: BrakeParameters) -> None:
    brake = at_rest(coach_brake, 0.005)
    torque = brake.step(1.0, np.array([FILL, VENT, HOLD, FILL], np.int8))
    state = brake.plant_state
    assert state[Brake.DISTRIBUTOR] == brake.distributor_pressure_bar
    assert state[Brake.DRAWN] == brake.air_nl
    assert state[Brake.VENTED] == brake.vented_nl
    np.testing.assert_array_equal(state[Brake.CYLINDER], brake.cylinder_pressure_bar)
    np.testing.assert_array_equal(state[Brake.TORQUE], torque)


@pytest.mark.parametrize("step_s", [0.0, -0.001, math.inf, math.nan])
def test_a_step_must_be_positive(coach_brake: BrakeParameters, step_s: float) -> None:
    with pytest.raises(ValueError, match="step_s"):
        Brake(coach_brake, step_s)


@pytest.mark.parametrize(
    "change",
    [{"pad_friction": 1.5}, {"cylinder_volume_dm3": 0.0}, {"critical_ratio": math.nan}, {"pressure": 3.0}],
)
def test_parameters_out_of_range_are_refused_by_name(coach_brake: BrakeParameters, change: dict[str, float]) -> None:
    with pytest.raises(ValidationError, match=next(iter(change))):
        BrakeParameters.model_validate({**coach_brake.model_dump(), **change})


@pytest.mark.parametrize(("adhesion", "published_mps2"), [(0.03, 16.5), (0.08, 4.4)])
def test_locking_deceleration_of_one_wheelset(
    coach_brake: BrakeParameters, adhesion: float, published_mps2: float
) -> None:
    """52 t at 3.0 bar, constant load and adhesion; the published figures know no return spring."""
    brake = at_rest(coach_brake, 0.001, full_service_pressure_bar=3.0, return_spring_pressure_bar=0.0)
    torque = brake.step(1.0, codes(FILL))[0]
    found = (torque - adhesion * 13_000 * 9.81 * 0.46) / 110.0 * 0.46
    print(f"rim deceleration at {adhesion}: {found:.2f} m/s2, published {published_mps2}")
    assert found == pytest.approx(published_mps2, rel=0.05)
