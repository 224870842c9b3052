"""Faults of the plant: stuck valves, leaks, an axle cut out, a lost supply; and the safety timer of the valves."""

import numpy as np
import pytest

from wsp import FILL, HOLD, VENT, Brake, BrakeParameters

STEP_S = 0.005
FULL_BAR = 3.45


def codes(code: int) -> np.ndarray:
    return np.full(4, code, np.int8)


def run(brake: Brake, seconds: float, code: int = FILL) -> np.ndarray:
    for _ in range(round(seconds / STEP_S)):
        brake.step(1.0, codes(code), np.full(4, 40.0), 18.0)
    return brake.cylinder_pressure_bar


@pytest.fixture
def applied(coach_brake: BrakeParameters) -> Brake:
    brake = Brake(coach_brake.model_copy(update={"leakage_dm3psbar": 0.0}), STEP_S)
    run(brake, 5.0)
    return brake


def test_a_hold_valve_stuck_open_always_fills(applied: Brake) -> None:
    applied.stick_valve(1, "hold", "open")
    pressures = run(applied, 5.0, VENT)
    # its vent valve does open: what comes in through 5 and goes out through 8 dm3/(s bar) settles in between
    assert pressures[[0, 2, 3]] == pytest.approx(0.0)
    assert 0.5 < pressures[1] < FULL_BAR - 0.5
    assert applied.valve_state[1] == VENT


def test_a_hold_valve_stuck_shut_never_fills(applied: Brake) -> None:
    run(applied, 5.0, VENT)
    applied.stick_valve(2, "hold", "shut")
    assert run(applied, 5.0) == pytest.approx([FULL_BAR, FULL_BAR, 0.0, FULL_BAR])
    applied.stick_valve(2, "hold", None)
    assert run(applied, 5.0) == pytest.approx(FULL_BAR)


def test_a_vent_valve_stuck_open_blows_and_stuck_shut_keeps(applied: Brake) -> None:
    applied.stick_valve(0, "vent", "open")
    applied.stick_valve(3, "vent", "shut")
    pressures = run(applied, 2.0).copy()
    assert pressures[1:] == pytest.approx(FULL_BAR)
    assert 0.5 < pressures[0] < FULL_BAR - 0.5
    drawn = applied.air_nl
    run(applied, 2.0)
    assert applied.air_nl > drawn + 10.0  # it goes on drawing
    assert run(applied, 5.0, VENT) == pytest.approx([0.0, 0.0, 0.0, FULL_BAR])


def test_balance_of_a_blowing_valve_is_where_both_flows_agree(applied: Brake) -> None:
    """5 dm3/(s bar) in from 3.45 bar, 8 out, by ISO 6358; the splitting of the step must not show."""

    def factor(ratio: float) -> float:
        return 1.0 if ratio <= 0.3 else float(np.sqrt(1.0 - ((ratio - 0.3) / 0.7) ** 2))

    low, high = 1.013, FULL_BAR + 1.013
    for _ in range(60):
        middle = 0.5 * (low + high)
        inflow = 5.0 * (FULL_BAR + 1.013) * factor(middle / (FULL_BAR + 1.013))
        low, high = (middle, high) if inflow > 8.0 * middle * factor(1.013 / middle) else (low, middle)
    applied.stick_valve(0, "vent", "open")
    assert run(applied, 3.0)[0] == pytest.approx(low - 1.013, abs=0.03)


def test_a_leak_empties_a_held_axle_by_the_flow_of_its_hole(applied: Brake) -> None:
    """While choked p falls as exp(-C t/V): V the secant volume of the stroke."""
    applied.leak(1, 0.5)
    pressures = run(applied, 0.5, HOLD).copy()
    assert pressures[[0, 2, 3]] == pytest.approx(FULL_BAR)
    seconds = 0.5 - 0.03  # before the hold valve shuts the axle is refilled
    expected = (FULL_BAR + 1.013) * np.exp(-0.5 * seconds / 2.5) - 1.013
    assert pressures[1] == pytest.approx(expected, rel=0.02)
    assert applied.record["leaked_nl"][0] > 0.9
    applied.leak(1, 0.0)
    pressure = run(applied, 0.1, HOLD)[1]
    assert run(applied, 1.0, HOLD)[1] == pressure


def test_an_axle_cut_out_is_empty_and_draws_nothing(applied: Brake) -> None:
    applied.cut_out(3, True)
    assert run(applied, 3.0) == pytest.approx([FULL_BAR] * 3 + [0.0])
    drawn = applied.air_nl
    run(applied, 3.0)
    assert applied.air_nl == drawn
    assert applied.record["torque_nm"][0, 3] == 0.0
    applied.cut_out(3, False)
    assert run(applied, 3.0) == pytest.approx(FULL_BAR)


def test_a_lost_supply_runs_out_and_comes_back(applied: Brake) -> None:
    run(applied, 100.0)
    applied.fail_supply(5.0)
    b = applied.record[0]
    assert b["reservoir_bar"] == 5.0
    assert b["let_off_nl"] == pytest.approx(125.0 / 1.013, rel=1e-3)
    for _ in range(3):
        run(applied, 2.0, VENT)
        run(applied, 2.0)
    assert b["reservoir_bar"] < 4.5
    applied.fail_supply(None)
    run(applied, 120.0)
    assert b["reservoir_bar"] == pytest.approx(6.0, abs=1e-3)


def test_the_safety_timer_gives_the_brake_back_until_fill_is_commanded(applied: Brake) -> None:
    """A controller that dies with its valves venting costs 10 s of brake, not more; to the step."""
    limit = round(10.0 / STEP_S)
    for step in range(limit + 6):
        applied.step(1.0, codes(VENT), np.full(4, 40.0), 18.0)
        energised = step >= 6  # dead time
        assert applied.valve_state[0] == (VENT if energised else FILL)
        assert not applied.record["timer_fired"].any()
    pressures = run(applied, 3.0, VENT)
    assert applied.record["timer_fired"].all()
    assert np.all(applied.valve_state == FILL)
    assert pressures == pytest.approx(FULL_BAR)
    # hold does not reset it, fill does
    run(applied, 1.0, HOLD)
    assert applied.record["timer_fired"].all()
    run(applied, 0.1, FILL)
    assert not applied.record["timer_fired"].any()
    assert run(applied, 3.0, VENT) == pytest.approx(0.0)


def test_a_single_step_of_fill_restarts_the_timer(applied: Brake) -> None:
    run(applied, 8.0, HOLD)
    applied.step(1.0, codes(FILL), np.full(4, 40.0), 18.0)
    run(applied, 8.0, HOLD)
    assert not applied.record["timer_fired"].any()
    run(applied, 3.0, HOLD)
    assert applied.record["timer_fired"].all()


def test_each_axle_has_a_timer_of_its_own(applied: Brake) -> None:
    valve = np.array([VENT, FILL, HOLD, FILL], np.int8)
    for _ in range(round(11.0 / STEP_S)):
        applied.step(1.0, valve, np.full(4, 40.0), 18.0)
    assert list(applied.record["timer_fired"][0]) == [1, 0, 1, 0]


def test_faults_of_no_sense_are_refused(applied: Brake) -> None:
    with pytest.raises(ValueError, match="axle = 4: 0 to 3"):
        applied.cut_out(4, True)
    with pytest.raises(ValueError, match="axle = -1"):
        applied.leak(-1, 1.0)
    with pytest.raises(ValueError, match="valve = 'relay'"):
        applied.stick_valve(0, "relay", "open")
    with pytest.raises(ValueError, match="position = 'ajar'"):
        applied.stick_valve(0, "hold", "ajar")
    with pytest.raises(ValueError, match="conductance_dm3psbar = -1"):
        applied.leak(0, -1.0)
    before = applied.record.tobytes()
    with pytest.raises(ValueError, match="pressure_bar = nan"):
        applied.fail_supply(float("nan"))
    assert applied.record.tobytes() == before
