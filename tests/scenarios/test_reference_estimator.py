"""An estimator in the loop, as the reference speed of the wheel slide protection."""

import numpy as np
import pytest

from scenarios.cosimulation.simulation import simulate
from scenarios.errors import BadInput
from scenarios.observe import observe
from scenarios.scenario_file import load_scenario

SLOW_STOP = (
    "simulation.initial_speed_kmh=60",
    "simulation.initial_position_m=1350",
    'driver.phases=[{from_m=0.0, action="brake", demand=1.0}]',
    "wsp.reference_estimator=ins-odo",
)


@pytest.mark.parametrize("record_s", [0.01, 0.005])
def test_the_controller_gets_what_the_estimator_makes_of_the_same_readings_afterwards(record_s: float) -> None:
    """The same object in the loop and offline, the same numbers; its speed, a tick old, is the reference."""
    scenario = load_scenario(
        "low-adhesion-stop",
        [
            *SLOW_STOP,
            "simulation.longest_s=12",
            f"simulation.record_period_s={record_s}",
            f"imu.rate_hz={1.0 / record_s}",
        ],
    )
    truth = simulate(scenario, lambda *_: None, lambda: False)
    estimate = observe(scenario, truth).estimates["ins-odo"]
    brake = truth.brake
    for k in (20, 60, 100):  # the reference at the tick after an estimate is that estimate, a tick further
        at = np.argmin(np.abs(brake.t_s - estimate.t_s[k] - 0.01))
        expected = estimate.speed_mps[k] + 0.01 * estimate.acceleration_mps2[k]
        assert brake.reference_speed_mps[at] == pytest.approx(expected, abs=1e-9)
    braking = brake.t_s > 2.0
    error = (brake.reference_speed_mps - truth.motion.speed_mps)[braking]
    print(f"reference error: rms {np.sqrt(np.mean(error**2)):.3f}, largest {np.abs(error).max():.3f} m/s")
    assert np.abs(error).max() < 0.8
    slid = truth.wheelsets.slip[braking].max()
    assert slid > 0.05


def test_an_estimator_in_the_loop_hangs_on_the_world_seed_alone() -> None:
    """With it the readings shape the truth, so another sensor seed changes nothing."""
    runs = [
        simulate(
            load_scenario("low-adhesion-stop", [*SLOW_STOP, "simulation.longest_s=6", f"scenario.sensor_seed={seed}"]),
            lambda *_: None,
            lambda: False,
        )
        for seed in (1, 2)
    ]
    np.testing.assert_array_equal(runs[0].brake.reference_speed_mps, runs[1].brake.reference_speed_mps)
    np.testing.assert_array_equal(runs[0].motion.position_m, runs[1].motion.position_m)


@pytest.mark.parametrize(
    ("value", "message"), [("scmtt", "must be one of estimators.names"), ("7", "must be the name of an estimator")]
)
def test_a_reference_that_no_estimator_gives_is_refused(value: str, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        load_scenario("low-adhesion-stop", [f"wsp.reference_estimator={value}"])
