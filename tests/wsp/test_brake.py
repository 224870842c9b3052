"""The brake plant: dead time, convergence, bounds and air balance under random commands, refusals."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from wsp import BRAKE_PRESETS, FILL, HOLD, VENT, Brake, BrakeParameters

STILL = np.zeros(4)
ROLLING = np.full(4, 60.0)


def codes(code: int) -> np.ndarray:
    return np.full(4, code, np.int8)


def at_rest(parameters: BrakeParameters, step_s: float = 0.0005, **changes: Any) -> Brake:
    """A brake whose distributor and cylinders have come to the full service pressure."""
    changed = parameters.model_copy(update=changes)
    brake = Brake(changed, step_s)
    for _ in range(round((changed.application_time_s + 1.0) / step_s)):
        brake.step(1.0, codes(FILL), STILL, 0.0)
    return brake


@pytest.mark.parametrize("step_s", [0.005, 0.0025, 0.002, 0.001, 0.0005])
def test_a_command_acts_after_the_dead_time_to_the_sample(coach_brake: BrakeParameters, step_s: float) -> None:
    brake = at_rest(coach_brake, step_s, leakage_dm3psbar=0.0)
    dead = round(0.030 / step_s)
    command = np.array([FILL, VENT, HOLD, FILL], np.int8)
    full = brake.cylinder_pressure_bar.copy()
    for _ in range(dead):
        brake.step(1.0, command, STILL, 0.0)
        np.testing.assert_array_equal(brake.valve_state, codes(FILL))
        np.testing.assert_array_equal(brake.cylinder_pressure_bar, full)
    brake.step(1.0, command, STILL, 0.0)
    np.testing.assert_array_equal(brake.valve_state, command)
    assert brake.cylinder_pressure_bar[1] < full[1]
    np.testing.assert_array_equal(brake.cylinder_pressure_bar[[0, 2, 3]], full[[0, 2, 3]])


def worked(brake: Brake, until_s: float = 8.0) -> np.ndarray:
    """Every 10 ms: pressures, torques, reservoir, temperatures, dynamic torque, air, while valves pulse at 108 km/h."""
    per_tick = round(0.01 / brake.step_s)
    brake.track_brake_on = True
    b = brake.record[0]
    rows = []
    for tick in range(round(until_s / 0.01)):
        cycle = tick % 40
        valve = np.array([VENT if cycle < 12 else HOLD if cycle < 20 else FILL] * 4, np.int8)
        valve[1] = FILL
        valve[2] = HOLD if cycle < 30 else FILL
        valve[3] = FILL if tick < 300 else valve[3]
        for _ in range(per_tick):
            brake.step(1.0 if tick < 500 else 0.3, valve, ROLLING, 27.6)
        scaled = (b["torque_nm"] / 1e3, b["dynamic_torque_nm"] / 1e3, b["disc_temperature_degc"] / 10.0)
        others = (b["reservoir_bar"], b["track_brake_force_n"][0] / 1e4, b["drawn_nl"] / 100.0)
        rows.append(np.concatenate([b["cylinder_bar"], *scaled, others]))
    return np.array(rows)


@pytest.mark.parametrize("preset", BRAKE_PRESETS)
def test_results_converge_with_the_step(preset: str, presets: dict[str, BrakeParameters]) -> None:
    parameters = presets[preset].model_copy(update={"leakage_dm3psbar": 0.01})
    finest = worked(Brake(parameters, 0.00025))
    errors = [worked(Brake(parameters, step_s)) - finest for step_s in (0.005, 0.0025, 0.001, 0.0005)]
    largest = [float(np.abs(error).max()) for error in errors]
    rms = [float(np.sqrt(np.mean(error**2))) for error in errors]
    print("errors (bar, kNm, 10 K, 100 nl), largest:", largest, "rms:", rms)
    assert np.all(np.diff(rms) < 0.0)
    assert largest[0] < 0.03
    assert largest[2] < 0.01
    assert rms[3] < 0.15 * rms[0]


def test_cylinders_in_balance_do_not_chatter(coach_brake: BrakeParameters) -> None:
    brake = Brake(coach_brake.model_copy(update={"leakage_dm3psbar": 0.0}), 0.005)
    last = 0.0
    for _ in range(1000):
        brake.step(1.0, codes(FILL), STILL, 0.0)
        assert last <= brake.cylinder_pressure_bar[0] <= brake.distributor_pressure_bar
        last = brake.cylinder_pressure_bar[0]
    assert last == coach_brake.full_service_pressure_bar


def test_same_commands_give_the_same_bytes(coach_brake: BrakeParameters) -> None:
    first, second = (worked(Brake(coach_brake, 0.001), 2.0) for _ in range(2))
    assert first.tobytes() == second.tobytes()


COMMANDS = st.lists(
    st.tuples(st.floats(0.0, 1.0), st.lists(st.integers(FILL, VENT), min_size=4, max_size=4), st.integers(1, 60)),
    min_size=1,
    max_size=12,
)
FAULTS = st.fixed_dictionaries(
    {},
    optional={
        "stick": st.tuples(st.integers(0, 3), st.sampled_from(["hold", "vent"]), st.sampled_from(["open", "shut"])),
        "leak": st.tuples(st.integers(0, 3), st.floats(0.0, 20.0)),
        "cut_out": st.integers(0, 3),
        "fail_supply": st.floats(0.0, 8.0),
    },
)


def break_down(brake: Brake, faults: dict[str, Any]) -> None:
    if "stick" in faults:
        brake.stick_valve(*faults["stick"])
    if "leak" in faults:
        brake.leak(*faults["leak"])
    if "cut_out" in faults:
        brake.cut_out(faults["cut_out"], True)
    if "fail_supply" in faults:
        brake.fail_supply(faults["fail_supply"])


def stored_nl(brake: Brake) -> tuple[float, float]:
    """Air above atmosphere in the empty cylinders' volumes: in all cylinders, and in the reservoir."""
    p, b = brake.parameters, brake.record[0]
    pressure, pads = b["cylinder_bar"], b["pad_bar"]
    volume = p.cylinder_volume_dm3 + p.elastic_volume_dm3pbar * pads
    if p.clearance_volume_dm3 > 0.0:
        travel = p.return_spring_pressure_bar - p.return_spring_preload_bar
        volume = volume + p.clearance_volume_dm3 * np.clip((pressure - p.return_spring_preload_bar) / travel, 0.0, 1.0)
    nl_per_bar_dm3 = 293.15 / (273.15 + p.air_temperature_degc) / 1.013
    cylinders = ((pressure + 1.013) * volume - 1.013 * p.cylinder_volume_dm3).sum()
    return cylinders * nl_per_bar_dm3, b["reservoir_bar"] * p.reservoir_volume_dm3 * nl_per_bar_dm3


@settings(deadline=None, max_examples=80)
@given(
    st.sampled_from(sorted(BRAKE_PRESETS)),
    COMMANDS,
    FAULTS,
    st.sampled_from([0.005, 0.002, 0.0005]),
    st.floats(-40.0, 60.0),
    st.floats(0.0, 0.01),
)
@example(  # at 0.1 bar, where the stroke ends, a leakage of next to nothing
    "dynamic-magnetic-56t",
    [(demand, [FILL] * 4, steps) for demand, steps in ((1.0, 50), (0.0, 33), (0.0, 54), (0.5, 48), (0.0, 40))],
    {},
    0.005,
    0.0,
    1.1754943508222875e-38,
)
def test_air_balances_and_all_stays_bounded(
    presets: dict[str, BrakeParameters],
    preset: str,
    commands: list[tuple[float, list[int], int]],
    faults: dict[str, Any],
    step_s: float,
    temperature_degc: float,
    leakage: float,
) -> None:
    changes = {
        "air_temperature_degc": temperature_degc,
        "application_time_s": 0.3,
        "release_time_s": 1.0,
        "leakage_dm3psbar": leakage,
        "safety_timer_s": 0.1,
    }
    brake = Brake(presets[preset].model_copy(update=changes), step_s)
    full = brake.parameters.full_service_pressure_bar
    b = brake.record[0]
    cylinders_at_first, reservoir_at_first = stored_nl(brake)
    counters = ("drawn_nl", "vented_nl", "leaked_nl", "supplied_nl")
    before = dict.fromkeys(counters, 0.0)
    for number, (demand, valve, steps) in enumerate(commands):
        if number == len(commands) // 2:
            break_down(brake, faults)
        for _ in range(steps):
            torque = brake.step(demand, np.array(valve, np.int8), ROLLING, 27.6)
            assert torque.min() >= 0.0
            assert b["cylinder_bar"].min() >= 0.0
            assert b["cylinder_bar"].max() <= full + 1e-12
            assert b["distributor_bar"] <= full
            assert b["dynamic_torque_nm"].min() >= 0.0
            assert all(b[name] >= before[name] for name in counters)
            before = {name: float(b[name]) for name in counters}
    cylinders, reservoir = stored_nl(brake)
    assert cylinders_at_first == pytest.approx(0.0, abs=1e-12)
    assert b["drawn_nl"] == pytest.approx(cylinders + b["vented_nl"] + b["leaked_nl"], rel=1e-9, abs=1e-9)
    assert reservoir_at_first + b["supplied_nl"] == pytest.approx(
        reservoir + b["drawn_nl"] + b["let_off_nl"], rel=1e-11, abs=1e-9
    )


def test_the_reservoir_falls_by_what_was_drawn_and_is_charged_again(coach_brake: BrakeParameters) -> None:
    brake = at_rest(coach_brake, 0.005)
    b = brake.record[0]
    low = float(b["reservoir_bar"])
    assert low < coach_brake.feed_pressure_bar - 0.15
    for _ in range(round(60.0 / 0.005)):
        brake.step(1.0, codes(FILL), STILL, 0.0)
    assert b["reservoir_bar"] == pytest.approx(coach_brake.feed_pressure_bar, abs=1e-3)


def test_the_distributor_gives_no_more_than_the_reservoir_has(coach_brake: BrakeParameters) -> None:
    brake = at_rest(coach_brake, 0.005, leakage_dm3psbar=0.0)
    for _ in range(20):
        brake.step(1.0, codes(FILL), STILL, 0.0)
    brake.fail_supply(2.0)
    for _ in range(200):
        brake.step(1.0, codes(FILL), STILL, 0.0)
    assert brake.distributor_pressure_bar == 2.0
    assert brake.cylinder_pressure_bar == pytest.approx(
        coach_brake.full_service_pressure_bar
    )  # the check valve holds it
    for code in (VENT, FILL):
        for _ in range(600):
            brake.step(1.0, codes(code), STILL, 0.0)
    reservoir = float(brake.record["reservoir_bar"][0])
    assert reservoir < 2.0
    assert brake.cylinder_pressure_bar == pytest.approx(reservoir, abs=0.01)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"demand": 1.2}, "demand = 1.2"),
        ({"demand": -0.1}, "demand = -0.1"),
        ({"demand": math.nan}, "demand = nan"),
        ({"valve": np.array([0, 0, 3, 0], np.int8)}, r"valve = \[0 0 3 0\]"),
        ({"valve": np.array([-1, 0, 0, 0], np.int8)}, r"valve = \[-1"),
        ({"valve": np.array([0, 0], np.int8)}, r"valve = \[0 0\]"),
        ({"wheel_rate_radps": np.array([0.0, 0.0, math.nan, 0.0])}, "wheel_rate_radps"),
        ({"wheel_rate_radps": np.zeros(3)}, "wheel_rate_radps"),
        ({"speed_mps": math.inf}, "speed_mps = inf"),
    ],
)
def test_refused_input_changes_nothing(coach_brake: BrakeParameters, change: dict[str, Any], said: str) -> None:
    brake = at_rest(coach_brake, 0.005)
    before = brake.record.tobytes()
    with pytest.raises(ValueError, match=said):
        brake.step(**{"demand": 1.0, "valve": codes(FILL), "wheel_rate_radps": STILL, "speed_mps": 0.0} | change)
    assert brake.record.tobytes() == before


@pytest.mark.parametrize("step_s", [0.0, -0.001, math.inf, math.nan, 1e-5])
def test_a_step_must_be_positive_and_not_too_short(coach_brake: BrakeParameters, step_s: float) -> None:
    with pytest.raises(ValueError, match="step_s"):
        Brake(coach_brake, step_s)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"pad_friction": 1.5}, "pad_friction"),
        ({"cylinder_volume_dm3": 0.0}, "cylinder_volume_dm3"),
        ({"critical_ratio": math.nan}, "critical_ratio"),
        ({"pressure": 3.0}, "pressure"),
        ({"reservoir_volume_dm3": 9.0}, "reservoir_volume_dm3 = 9.0: must be at least .* 9.5"),
        ({"feed_pressure_bar": 3.0}, "feed_pressure_bar = 3.0: must be at least full_service_pressure_bar = 3.45"),
        ({"return_spring_preload_bar": 0.1}, "return_spring_preload_bar = 0.1.*must be below"),
        ({"friction_curve": {"sliding_speed_mps": [0.0, 0.0], "speed_factor": [1.0, 1.0]}}, "must rise"),
        ({"friction_curve": {"sliding_speed_mps": [0.0, 9.0], "speed_factor": [1.0]}}, "one for each"),
        ({"friction_curve": {"temperature_degc": [0.0, 9.0]}}, "temperature_factor has 1 values"),
        ({"dynamic_brake": {"fade_to_kmh": 20.0}}, "fade_to_kmh = 20.0: must be below fade_from_kmh = 12.0"),
        ({"track_brake": {"friction": [0.1]}}, "friction has 1 values, speed_kmh has 5"),
        ({"block_friction": "wood"}, "block_friction"),
    ],
)
def test_bad_parameters_are_refused_with_the_reason(
    presets: dict[str, BrakeParameters], change: dict[str, Any], said: str
) -> None:
    raw = presets["dynamic-magnetic-56t"].model_dump()
    for key, value in change.items():
        raw[key] = raw[key] | value if isinstance(value, dict) and key != "friction_curve" else value
    with pytest.raises(ValidationError, match=said):
        BrakeParameters.model_validate(raw)
