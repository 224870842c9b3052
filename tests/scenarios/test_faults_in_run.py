"""[[faults]] of a scenario: each does in the run what it says, and bad entries are refused."""

import math

import numpy as np
import pytest

from scenarios.cosimulation.fault_entries import FAULT_KINDS
from scenarios.cosimulation.faults_at_work import FaultsAtWork
from scenarios.cosimulation.simulation import simulate
from scenarios.errors import BadInput
from scenarios.scenario_file import load_scenario
from scenarios.truth import Truth
from sensors import Tachometers, pulse_edges
from wsp import FILL, VENT, Brake
from wsp.valves import STUCK_OPEN, STUCK_SHUT

# on dry rail nothing slides: what differs from the sound run is the fault's
DRY_STOP = (
    "simulation.initial_speed_kmh=60",
    "simulation.initial_position_m=1350",
    'driver.phases=[{from_m=0.0, action="brake", demand=1.0}]',
    'adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]',
    "simulation.longest_s=12",
)
SLIPPERY_STOP = (
    *DRY_STOP[:3],
    'adhesion.stretches=[{from_m=0.0, surface="low", peak_adhesion=0.05}]',
    "simulation.longest_s=16",
)


def run(*settings: str) -> Truth:
    return simulate(load_scenario("low-adhesion-stop", settings), lambda *_: None, lambda: False)


def at(truth: Truth, t_s: float) -> int:
    return int(np.argmin(np.abs(truth.brake.t_s - t_s)))


def test_faults_of_the_plant_come_and_go_in_their_time() -> None:
    """One run, a fault on each axle: cut out, vent valve stuck open, leak, hold valve stuck shut before the brake."""
    truth = run(
        *DRY_STOP,
        'faults=[{kind="brake-cut-out", axle=1, at_s=7.0}, '
        '{kind="valve-stuck", axle=2, valve="vent", position="open", at_s=7.0, until_s=9.0}, '
        '{kind="pipe-leak", axle=3, conductance_dm3psbar=2.0, at_s=7.0}, '
        '{kind="valve-stuck", axle=4, valve="hold", position="shut", at_s=0.0}]',
    )
    pressure = truth.brake.cylinder_pressure_bar
    before, during, after = (pressure[at(truth, t)] for t in (6.9, 8.9, 11.5))
    assert before[:3] == pytest.approx(np.full(3, 3.45), abs=0.05)
    assert before[3] < 0.05  # its supply never opened
    assert during[0] < 0.05
    assert during[1] < 2.5  # fills and vents at once
    assert 2.5 < during[2] < 3.44  # the leak against the supply
    assert after[1] == pytest.approx(3.45, abs=0.05)
    torque = -truth.wheelsets.brake_torque_nm[at(truth, 8.9)]
    assert torque[0] < 100.0
    assert truth.brake.air_nl[-1] > truth.brake.air_nl[at(truth, 6.9)] + 30.0


def test_an_empty_reservoir_limits_the_brake() -> None:
    truth = run(*DRY_STOP, 'faults=[{kind="low-reservoir", pressure_bar=2.0, at_s=0.0}]')
    brake = truth.brake
    assert brake.reservoir_pressure_bar[at(truth, 0.5)] == pytest.approx(2.0, abs=0.3)
    assert brake.cylinder_pressure_bar[-1].max() < 2.0
    assert brake.reservoir_pressure_bar[-1] == pytest.approx(brake.cylinder_pressure_bar[-1].max(), abs=0.05)


def test_a_dead_controller_leaves_its_commands_until_the_safety_timer_acts() -> None:
    truth = run(
        *SLIPPERY_STOP,
        'faults=[{kind="controller-dead", at_s=4.0}]',
        "brake.safety_timer_s=3.0",
    )
    brake = truth.brake
    dead = brake.t_s > 4.0 + 0.02
    commands = brake.valve_command[dead]
    assert (commands == commands[0]).all()
    assert (commands[0] != FILL).any()  # sliding: not all axles were being filled
    held = commands[0] != FILL
    assert not (brake.valve[at(truth, 6.5)][held] == FILL).any()
    late = at(truth, 7.5)
    assert (brake.valve[late] == FILL).all()
    assert brake.safety_timer_fired[late].astype(bool).tolist() == held.tolist()


def test_tachometer_faults_reach_the_controller() -> None:
    truth = run(
        *DRY_STOP,
        'faults=[{kind="tachometer-lost", axle=1, at_s=3.0, until_s=5.0}, '
        '{kind="tachometer-frozen", axle=2, at_s=3.0}, '
        '{kind="tooth-count", axle=3, teeth=80, at_s=3.0}, {kind="wheel-diameter", axle=4, diameter_mm=860, at_s=3.0}]',
    )
    seen, rim = truth.brake.axle_speed_mps, truth.wheelsets.rim_speed_mps
    row = at(truth, 4.5)
    assert not truth.axle_speeds.valid[450, 0]
    assert truth.axle_speeds.valid[450, 1:].all()
    assert seen[row, 1] == seen[at(truth, 3.2), 1]
    assert seen[row, 2] == pytest.approx(1.25 * rim[row, 2], rel=0.01)
    assert seen[row, 3] == pytest.approx(0.86 / 0.92 * rim[row, 3], rel=0.01)
    assert truth.axle_speeds.valid[520, 0]
    assert seen[at(truth, 6.0), 0] == pytest.approx(rim[at(truth, 6.0), 0], rel=0.01)


def test_a_vent_valve_stuck_shut_locks_its_axle_alone() -> None:
    """The controller vents in vain; the others go on braking."""
    truth = run(*SLIPPERY_STOP, 'faults=[{kind="valve-stuck", axle=2, valve="vent", position="shut", at_s=0.0}]')
    above = truth.motion.speed_mps > 30.0 / 3.6
    standing = (np.abs(truth.wheelsets.rim_speed_mps[above]) < 0.5).any(axis=0)
    assert standing.tolist() == [False, True, False, False]
    assert (truth.brake.valve_command[above, 1] == VENT).any()


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('{kind="valve-stuk", axle=1, at_s=1.0}', "faults.0.kind = 'valve-stuk': must be one of valve-stuck"),
        ('{kind="pipe-leak", axle=5, conductance_dm3psbar=1.0, at_s=1.0}', "faults.0.axle = 5"),
        ('{kind="pipe-leak", axle=1, at_s=1.0}', "faults.0.conductance_dm3psbar: is missing"),
        ('{kind="controller-dead"}', "faults.0.at_s: is missing"),
        ('{kind="controller-dead", at_s=5.0, until_s=5.0}', "faults.0.until_s = 5.0: must be later"),
        ('{kind="controller-dead", at_s=5.0, axle=1}', "faults.0.axle: unknown key"),
        ('{kind="controller-dead", at_s=-5.0}', "faults.0.at_s = -5.0"),
        ("3", "faults.0.kind = None: must be one of"),
    ],
)
def test_bad_faults_are_refused(entry: str, message: str) -> None:
    with pytest.raises(BadInput) as refusal:
        load_scenario("low-adhesion-stop", [f"faults=[{entry}]"])
    assert message in str(refusal.value)


def test_faults_must_be_an_array() -> None:
    with pytest.raises(BadInput, match="must be an array of tables"):
        load_scenario("low-adhesion-stop", ["faults=3"])


def test_faults_on_one_part_act_together() -> None:
    """Teeth and diameter count together and end one by one; of two valves stuck the last rules; leaks add up."""
    scenario = load_scenario("low-adhesion-stop")
    brake, tachometers = Brake(scenario.brake, 0.005), Tachometers(scenario.tachometers, np.random.default_rng(1))
    entries = [
        FAULT_KINDS["tooth-count"](kind="tooth-count", axle=1, teeth=96, at_s=1.0, until_s=4.0),
        FAULT_KINDS["wheel-diameter"](kind="wheel-diameter", axle=1, diameter_mm=860.0, at_s=2.0, until_s=5.0),
        FAULT_KINDS["valve-stuck"](kind="valve-stuck", axle=2, valve="vent", position="open", at_s=1.0),
        FAULT_KINDS["valve-stuck"](kind="valve-stuck", axle=2, valve="vent", position="shut", at_s=2.0, until_s=3.0),
        FAULT_KINDS["pipe-leak"](kind="pipe-leak", axle=3, conductance_dm3psbar=1.0, at_s=1.0, until_s=3.0),
        FAULT_KINDS["pipe-leak"](kind="pipe-leak", axle=3, conductance_dm3psbar=2.0, at_s=2.0, until_s=4.0),
    ]
    faults = FaultsAtWork(entries, brake, tachometers)
    sound_leak = brake.record["leak_dm3pbar"][0, 2]
    seen = {}
    while faults.next_s < math.inf:
        t_s = faults.next_s
        faults.step(t_s)
        pitch_m = tachometers.state[pulse_edges.PITCH, 0]
        leak = (brake.record["leak_dm3pbar"][0, 2] - sound_leak) / 0.005
        seen[t_s] = (pitch_m / (2.0 * math.pi), brake.record["exhaust_stuck"][0, 1], leak)
    pitches, stuck, leaks = zip(*(seen[t] for t in (1.0, 2.0, 3.0, 4.0, 5.0)), strict=True)
    assert pitches == pytest.approx((0.46 / 96, 0.43 / 96, 0.43 / 96, 0.43 / 100, 0.46 / 100))
    assert stuck == (STUCK_OPEN, STUCK_SHUT, STUCK_OPEN, STUCK_OPEN, STUCK_OPEN)
    assert leaks == pytest.approx((1.0, 3.0, 2.0, 0.0, 0.0), abs=1e-6)
