"""The driver's speed profile: ramps, braking to a speed, station stops."""

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from scenarios.cosimulation.driver import Driver, DriverParameters
from scenarios.cosimulation.simulation import simulate
from scenarios.cosimulation.traction import TractionParameters
from scenarios.scenario_file import load_scenario

PERIOD_S = 0.1
MASS_KG, DRAG_N, FULL_BRAKE_N = 58_000.0, 2_500.0, 55_000.0


def phases(*items: dict[str, Any]) -> DriverParameters:
    return DriverParameters.model_validate({"phases": items})


def driven(parameters: DriverParameters, seconds: float, speed_mps: float = 0.0, most_n: float = 1e9) -> np.ndarray:
    """Rows of (time, position, speed, traction, demand) of a point mass; `most_n`: what the rail takes."""
    driver = Driver(parameters, TractionParameters(largest_force_n=80_000.0, force_rise_nps=40_000.0), PERIOD_S)
    position, rows = 0.0, []
    for k in range(round(seconds / PERIOD_S)):
        driver.step(position, speed_mps)
        rows.append((k * PERIOD_S, position, speed_mps, driver.traction_n, driver.demand))
        force = min(driver.traction_n, most_n) - driver.demand * FULL_BRAKE_N - DRAG_N * (speed_mps > 0.0)
        speed_mps = max(0.0, speed_mps + PERIOD_S * force / MASS_KG)
        position += PERIOD_S * speed_mps
    return np.array(rows)


def test_acceleration_keeps_to_its_limit() -> None:
    rows = driven(phases({"from_m": 0.0, "action": "hold", "speed_kmh": 90.0, "acceleration_mps2": 0.4}), 120.0)
    t, speed = rows[:, 0], rows[:, 2]
    on_the_way = (t > 20.0) & (t < 55.0)
    assert np.polyfit(t[on_the_way], speed[on_the_way], 1)[0] == pytest.approx(0.4, rel=0.02)
    assert 3.6 * speed.max() < 92.0
    assert 3.6 * speed[-1] == pytest.approx(90.0, abs=0.3)


def test_ramp_waits_for_a_train_that_slippery_rail_holds_back() -> None:
    """The rail gives a third of what the ramp needs for 40 s; once it gives all, the speed wanted is still near."""
    parameters = phases({"from_m": 0.0, "action": "hold", "speed_kmh": 200.0, "acceleration_mps2": 0.6})
    driver = Driver(parameters, TractionParameters(largest_force_n=80_000.0), PERIOD_S)
    speed, history = 0.0, []
    for k in range(700):
        driver.step(0.0, speed)
        speed += PERIOD_S * min(driver.traction_n, 12_000.0 if k < 400 else 1e9) / MASS_KG
        history.append(speed)
    assert driver.traction_n > 0.0
    later = np.diff(history)[500:] / PERIOD_S
    assert later.mean() == pytest.approx(0.6, abs=0.1)
    assert history[399] < 9.0


def test_brakes_to_a_speed_and_accelerates_at_once() -> None:
    rows = driven(
        phases(
            {"from_m": 0.0, "action": "brake", "demand": 0.8, "until_kmh": 60.0},
            {"action": "hold", "speed_kmh": 80.0},
            {"from_m": 3000.0, "action": "coast"},
        ),
        180.0,
        speed_mps=30.0,
    )
    speed, demand = 3.6 * rows[:, 2], rows[:, 4]
    released = int(np.argmax(demand == 0.0))
    assert speed[released] <= 60.0 < speed[released - 1]
    assert (demand[:released] == 0.8).all()
    assert (demand[released:] == 0.0).all()
    assert rows[released, 3] > 0.0
    assert speed[rows[:, 1] < 3000.0][-1] == pytest.approx(80.0, abs=0.3)
    assert rows[rows[:, 1] > 3100.0][:, 3].max() == 0.0


def test_released_at_its_speed_the_train_coasts_to_the_next_phase() -> None:
    rows = driven(
        phases(
            {"from_m": 0.0, "action": "brake", "demand": 1.0, "until_kmh": 70.0},
            {"from_m": 1000.0, "action": "brake", "demand": 0.5},
        ),
        60.0,
        speed_mps=30.0,
    )
    coasts = (rows[:, 2] < 70.0 / 3.6) & (rows[:, 1] < 990.0)
    assert coasts.sum() > 100
    assert (rows[coasts, 3:] == 0.0).all()
    assert rows[rows[:, 1] > 1010.0][0, 4] == 0.5


def test_stands_at_a_station_and_starts_again() -> None:
    rows = driven(
        phases(
            {"from_m": 0.0, "action": "hold", "speed_kmh": 40.0},
            {"from_m": 200.0, "action": "stop", "demand": 0.6, "standing_s": 12.0},
            {"action": "hold", "speed_kmh": 30.0},
        ),
        110.0,
    )
    t, speed = rows[:, 0], rows[:, 2]
    stands = t[(speed == 0.0) & (rows[:, 1] > 200.0)]
    assert stands[-1] - stands[0] == pytest.approx(12.0, abs=0.6)
    assert 3.6 * speed[-1] == pytest.approx(30.0, abs=0.5)


BAD = [
    ([{"from_m": 0.0, "action": "coast"}, {"action": "coast"}], "may do without"),
    ([{"from_m": 0.0, "action": "coast", "until_kmh": 30.0}], "until_kmh: belongs with action = 'brake' only"),
    ([{"from_m": 0.0, "action": "stop", "demand": 0.5}], "standing_s: needed"),
    ([{"from_m": 0.0, "action": "stop", "standing_s": 5.0}], "demand: needed"),
    ([{"from_m": 0.0, "action": "brake", "demand": 0.5, "acceleration_mps2": 0.5}], "acceleration_mps2: belongs"),
    (
        [
            {"from_m": 0.0, "action": "stop", "demand": 0.5, "standing_s": 5.0},
            {"from_m": 10.0, "action": "coast"},
        ],
        "behind a stop begins where that was",
    ),
    (
        [
            {"from_m": 0.0, "action": "coast"},
            {"from_m": 500.0, "action": "brake", "demand": 1.0, "until_kmh": 50.0},
            {"action": "hold", "speed_kmh": 80.0},
            {"from_m": 400.0, "action": "coast"},
        ],
        "phases.3.from_m = 400.0: must lie beyond",
    ),
    ([{"action": "coast"}], "starts at 0"),
]


@pytest.mark.parametrize(("items", "message"), BAD)
def test_bad_profiles_are_refused(items: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        phases(*items)


def test_a_run_goes_on_after_the_station_and_ends_at_the_last_stop() -> None:
    """The coach stands 4 s at the station, which is longer than the 2 s that end a run."""
    truth = simulate(
        load_scenario(
            "test-path",
            [
                "simulation.initial_speed_kmh=20",
                'driver.phases=[{from_m=0.0, action="stop", demand=1.0, standing_s=4.0}, '
                '{action="hold", speed_kmh=18.0}, {from_m=110.0, action="stop", demand=1.0, standing_s=100.0}]',
            ],
        ),
        lambda *_: None,
        lambda: False,
    )
    motion = truth.motion
    stands = np.abs(motion.speed_mps) < 0.05
    begins = np.flatnonzero(np.diff(stands.astype(int)) == 1)
    assert truth.solve.ended == "standstill"
    assert motion.position_m[-1] > 110.0
    at_station = motion.t_s[stands & (motion.position_m < 100.0)]
    assert 4.0 <= at_station[-1] - at_station[0] < 8.0  # the brakes release only then
    assert motion.t_s[-1] - motion.t_s[begins[-1]] < 3.0
