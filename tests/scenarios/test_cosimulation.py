"""The co-simulation: order and delay of its links, convergence, the driver, the ends of a run."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel, ValidationError

from scenarios.cosimulation import loop as loop_module
from scenarios.cosimulation import simulation
from scenarios.cosimulation.driver import Driver, DriverParameters
from scenarios.cosimulation.line import Line
from scenarios.cosimulation.loop import Loop
from scenarios.cosimulation.simulation import simulate
from scenarios.cosimulation.traction import TractionParameters
from scenarios.errors import SolveFailed
from scenarios.metrics import stop_metrics
from scenarios.observe import observe
from scenarios.scenario_file import load_scenario
from scenarios.schema import TICK_S, Scenario
from scenarios.shortest_stop import shortest_stop
from scenarios.truth import Truth
from sensors import pulse_edges
from vehicle import Actuation, CoachState
from wsp import CONTROLLERS, FILL, VENT, ControllerOutput

SLOW_STOP = (
    "simulation.initial_speed_kmh=60",
    "simulation.initial_position_m=1350",
    'driver.phases=[{from_m=0.0, action="brake", demand=1.0}]',
    "adhesion.stretches.1.correlation_length_m=15",
)


def run(*settings: str) -> Truth:
    return simulate(load_scenario("low-adhesion-stop", settings), lambda *_: None, lambda: False)


def test_halving_the_step_hardly_moves_the_stop() -> None:
    """Mean change of the stopping distance over several rails, WSP at work: under 0.5 %."""
    changes = []
    for seed in (1, 2, 3):
        distances = [
            stop_metrics(run(*SLOW_STOP, f"scenario.world_seed={seed}", f"simulation.step_s={step}"), None).distance_m
            for step in (0.005, 0.0025)
        ]
        assert distances[0] is not None
        assert distances[1] is not None
        changes.append(abs(distances[0] / distances[1] - 1.0))
    print("relative changes:", [f"{change:.1e}" for change in changes])
    assert np.mean(changes) < 0.005


def test_no_wsp_locks_the_wheels_and_stops_later() -> None:
    with_wsp, without = run(*SLOW_STOP), run(*SLOW_STOP, "wsp.controller=none")
    rolling, locked = (stop_metrics(truth, None).distance_m for truth in (with_wsp, without))
    assert rolling is not None
    assert locked is not None
    assert locked > 1.1 * rolling
    above = without.motion.speed_mps > 30.0 / 3.6
    assert (np.abs(without.wheelsets.rim_speed_mps[above]) < 0.1).mean() > 0.5


def test_shortest_stop_is_that_of_a_point_mass_on_even_rail() -> None:
    """Constant adhesion, level, hardly any resistance: the build-up apart, v^2/(2 mu g)."""
    level = (
        "track.gradients=[]",
        'adhesion.stretches=[{from_m=0.0, surface="low", peak_adhesion=0.06}]',
        "coach.resistance.a_n=0",
        "coach.resistance.b_nspm=0",
        "coach.resistance.c_ns2pm2=0",
        "brake.application_time_s=0.02",
    )
    settings = (*SLOW_STOP, *level)
    truth = run(*settings)
    shortest = shortest_stop(load_scenario("low-adhesion-stop", settings), truth)
    assert shortest is not None
    # the peak rises a little as the speed falls: bounded by its values at 60 km/h and at a crawl
    speed = truth.motion.speed_mps[0]
    peaks = truth.wheelsets.peak_adhesion[truth.motion.speed_mps > 1.0]
    low, high = (speed**2 / (2.0 * mu * 9.81) for mu in (np.quantile(peaks, 0.99), np.quantile(peaks, 0.01)))
    # 0.1 s until the driver's demand counts, and a fill of 0.3 s
    assert low < shortest < high + 0.4 * speed
    distance = stop_metrics(truth, shortest).distance_m
    assert distance is not None
    assert distance >= shortest * 0.999


def test_recording_does_not_touch_the_run() -> None:
    """Twice as many rows: those in common are the same to the last bit."""
    settings = (*SLOW_STOP, "simulation.longest_s=8")
    fine = run(*settings, "simulation.record_period_s=0.005")
    coarse = run(*settings, "simulation.record_period_s=0.01")
    rows = slice(0, 2 * len(coarse.motion), 2)
    assert np.array_equal(fine.motion.specific_force_mps2[rows], coarse.motion.specific_force_mps2)
    assert np.array_equal(fine.wheelsets.longitudinal_force_n[rows], coarse.wheelsets.longitudinal_force_n)
    assert np.array_equal(fine.brake.cylinder_pressure_bar[rows], coarse.brake.cylinder_pressure_bar)


def test_energy_and_momentum_balance_over_a_whole_run() -> None:
    """Drive, coasting, curve, cant, gradient, valves and WSP at work, standstill: 1 % of the summed absolute work."""
    motion = run(
        "track.curves.0.start_m=30",
        "track.curves.0.length_m=50",
        "track.gradients.0.from_m=400",
        "adhesion.stretches.1.from_m=450",
        'driver.phases=[{from_m=0.0, action="hold", speed_kmh=75.0}, {from_m=350.0, action="coast"}, '
        '{from_m=500.0, action="brake", demand=1.0}]',
        "simulation.initial_speed_kmh=70",
        "simulation.initial_position_m=12",
    ).motion
    names = ("gravity", "suspension", "contact_normal", "creep", "brake", "drive", "resistance")
    powers = {name: getattr(motion, f"power_{name}_w") for name in names}
    work = {name: float(np.trapezoid(power, motion.t_s)) for name, power in powers.items()}
    absolute = sum(float(np.trapezoid(np.abs(power), motion.t_s)) for power in powers.values())
    gained = motion.kinetic_energy_j[-1] - motion.kinetic_energy_j[0]
    print({name: round(value) for name, value in work.items()}, f"gained {gained:.0f} J, of {absolute:.0f} J")
    assert all(abs(work[name]) > 1e4 for name in ("gravity", "creep", "brake", "drive", "resistance"))
    assert abs(gained - sum(work.values())) < 0.01 * absolute

    impulse = np.trapezoid(motion.external_force_n, motion.t_s, axis=0)
    total = float(np.trapezoid(np.linalg.norm(motion.external_force_n, axis=1), motion.t_s))
    assert np.abs(motion.momentum_ns[-1] - motion.momentum_ns[0] - impulse).max() < 0.01 * total


def test_coasting_up_ten_per_mille_the_orientation_filter_reads_ten_per_mille() -> None:
    """On the coach itself, through masks and all: within the accelerometer's share, 0.42 per mille, and its noise."""
    scenario = load_scenario(
        "low-adhesion-stop",
        [
            "track.curves=[]",
            "track.gradients=[{from_m=300.0, gradient_permille=10.0, rounding_m=100.0}]",
            'driver.phases=[{from_m=0.0, action="coast"}]',
            'adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]',
            "simulation.longest_s=60",
            'estimators.names=["orientation"]',
        ],
    )
    truth = simulate(scenario, lambda *_: None, lambda: False)
    estimate = observe(scenario, truth).estimates["orientation"]
    settled = estimate.t_s > 30.0
    print(f"reads {estimate.gradient_permille[settled].mean():.2f} per mille")
    assert truth.motion.gradient_permille[-1] == pytest.approx(10.0)
    assert estimate.gradient_permille[settled].mean() == pytest.approx(10.0, abs=0.8)


class Script:
    """A controller that vents from a given tick on and writes down what it sees."""

    class Parameters(BaseModel):
        """None."""

    period_s = 0.01
    vents_at_s = 0.5

    def __init__(self, parameters: Any) -> None:
        self.output = ControllerOutput()
        self.seen: list[tuple[float, np.ndarray]] = []

    def reset(self, t_s: float, direction: int) -> None:
        self.seen.clear()

    def step(
        self, t_s: float, axle_speed_mps: Any, valid: Any, demand: float, direction: int, outside_reference_mps: float
    ) -> ControllerOutput:
        self.seen.append((t_s, np.array(axle_speed_mps)))
        assert math.isnan(outside_reference_mps)
        self.output.valve[:] = VENT if t_s >= self.vents_at_s - 1e-9 else FILL
        return self.output


@pytest.mark.parametrize("step_s", [0.005, 0.0025, 0.001])
def test_a_command_acts_one_tick_and_the_dead_time_later(step_s: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Inputs of tick k, answer in force at tick k + 1, and the valve moves after its dead time: to the sample."""
    script = Script(None)
    monkeypatch.setattr(Scenario, "make_controller", lambda self: script)
    monkeypatch.setattr(simulation, "_compile", lambda *_: None)  # two ticks that the script would note
    settings = (
        *SLOW_STOP,
        "simulation.longest_s=1",
        f"simulation.step_s={step_s}",
        f"simulation.record_period_s={step_s}",
    )
    scenario = load_scenario("low-adhesion-stop", settings)
    truth = simulate(scenario, lambda *_: None, lambda: False)
    moved = truth.brake.t_s[np.argmax(truth.brake.valve[:, 0] == VENT)]
    # the recorder writes the state that the plant reached in the step before
    expected = Script.vents_at_s + TICK_S + scenario.brake.valve_dead_time_s + step_s
    assert moved == pytest.approx(expected, abs=1e-9)
    times = np.array([t for t, _ in script.seen])
    assert times == pytest.approx(TICK_S * np.arange(len(times)), abs=1e-9)
    # it sees what the tachometers gave, nothing else
    assert np.array_equal(
        np.array([speeds for _, speeds in script.seen]), truth.axle_speeds.axle_speed_mps[: len(times)]
    )


class Forgetful(Script):
    """The same answers, as a new output each time, which nobody else keeps."""

    def step(self, *inputs: Any) -> ControllerOutput:
        output = ControllerOutput()
        output.valve = super().step(*inputs).valve
        output.reference_speed_mps = inputs[0]
        self.output.valve[:] = FILL
        return output


def test_an_output_that_the_controller_does_not_keep_is_obeyed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation, "_compile", lambda *_: None)
    commands = []
    for script in (Script(None), Forgetful(None)):
        monkeypatch.setattr(Scenario, "make_controller", lambda self, script=script: script)
        truth = run(*SLOW_STOP, "simulation.longest_s=1")
        commands.append(truth.brake.valve_command)
    assert commands[0].any()
    assert np.array_equal(*commands)
    assert truth.brake.reference_speed_mps == pytest.approx(truth.brake.t_s)  # recorded at each tick, here its time


def test_python_at_every_tick_leaves_the_run_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """To the last bit and row, over more rows, ticks and pulses than the arrays first have room for."""
    turns: list[float] = []
    on_tick = Loop.on_tick

    def noted(self: Loop, t_s: float, state: CoachState) -> Actuation | None:
        turns.append(t_s)
        return on_tick(self, t_s, state)

    monkeypatch.setattr(Loop, "on_tick", noted)
    monkeypatch.setattr(loop_module, "_FIRST_TICKS", 64)
    monkeypatch.setattr(simulation, "_compile", lambda *_: None)
    settings = (*SLOW_STOP, "simulation.record_period_s=0.005", "tachometers.pulses_per_revolution=4096")
    seldom, counted = run(*settings), len(turns)
    monkeypatch.setattr(Loop, "turn_s", TICK_S)
    often = run(*settings)
    assert seldom.solve.ended == "standstill"
    assert len(seldom.motion) > 4096
    assert len(seldom.tachometer.t_s) > 1 << 17
    assert len(turns) - counted == len(seldom.axle_speeds.t_s) == 10 * (counted - 1) + 1
    for stream in ("motion", "wheelsets", "brake", "tachometer", "axle_speeds", "rail"):
        one, other = getattr(seldom, stream), getattr(often, stream)
        for field in dataclasses.fields(one):
            assert np.array_equal(getattr(one, field.name), getattr(other, field.name), equal_nan=True), field.name


@pytest.mark.parametrize("name", ["rule-table", "slip-tracking", "adaptive"])
def test_a_controller_answers_in_the_loop_as_it_does_outside(name: str) -> None:
    """Fed with what was recorded, tick by tick: the same reference speed, the same commands one tick later."""
    settings = (*SLOW_STOP, "simulation.longest_s=12", f"wsp.controller={name}")
    truth, controller = run(*settings), load_scenario("low-adhesion-stop", settings).make_controller()
    controller.reset(0.0, 1)
    seen, brake = truth.axle_speeds, truth.brake
    assert (brake.valve_command == VENT).any()
    in_force = np.full(4, FILL)
    for k, t_s in enumerate(brake.t_s):
        assert np.array_equal(brake.valve_command[k], in_force), t_s
        output = controller.step(t_s, seen.axle_speed_mps[k], seen.valid[k], brake.demand[k], 1, math.nan)
        assert output.reference_speed_mps == brake.reference_speed_mps[k], t_s
        in_force = output.valve.copy()


class Loud(CONTROLLERS["rule-table"]):
    """Would say something at each of its ticks."""

    def step(self, *inputs: Any) -> ControllerOutput:
        return super().step(*inputs)


@pytest.mark.parametrize(
    ("turn_s", "setting"),
    [
        (0.1, "wsp.controller=rule-table"),
        (0.1, "wsp.controller=adaptive"),
        (TICK_S, "wsp.controller=none"),
        (TICK_S, f"wsp.controller={__file__}:Loud"),
        (TICK_S, "wsp.reference_estimator=ins-odo"),
        (TICK_S, 'faults=[{kind="brake-cut-out", axle=1, at_s=0.53}]'),
    ],
)
def test_python_has_its_turn_where_it_has_something_to_say(turn_s: float, setting: str) -> None:
    scenario = load_scenario("low-adhesion-stop", [setting])
    assert Loop(scenario, Line(scenario), lambda *_: None, lambda: False).turn_s == pytest.approx(turn_s)


def test_a_wheel_that_jumps_between_two_turns_of_python_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    on_tick = Loop.on_tick

    def jumping(self: Loop, t_s: float, state: CoachState) -> Actuation | None:
        actuation = on_tick(self, t_s, state)
        if t_s > 0.45:
            self.tachometers.state[pulse_edges.EDGE, 2] -= 1e6
        return actuation

    monkeypatch.setattr(Loop, "on_tick", jumping)
    with pytest.raises(ValueError, match=r"^t_s = 0.51: the angle of a wheel has jumped"):
        run(*SLOW_STOP)


def test_the_brake_torque_of_a_step_is_that_of_the_plant_at_its_end() -> None:
    truth = run(*SLOW_STOP, "simulation.longest_s=3", "wsp.controller=none")
    capacity, torque = truth.brake.friction_torque_capacity_nm, -truth.wheelsets.brake_torque_nm
    assert torque.max() > 1000.0
    assert torque == pytest.approx(capacity, abs=1e-6)  # wheels turn: the discs slide and give all they have


def test_a_track_too_short_says_so_and_keeps_what_it_had() -> None:
    with pytest.raises(SolveFailed, match="left the track.*track.length_m = 1700") as failure:
        run(*SLOW_STOP, "track.length_m=1700", "simulation.initial_speed_kmh=120", "balises.first_m=1400")
    partial = failure.value.partial
    assert isinstance(partial, Truth)
    assert partial.motion.position_m[-1] > 1600.0


def test_a_solve_that_breaks_down_keeps_what_it_had(monkeypatch: pytest.MonkeyPatch) -> None:
    on_tick = Loop.on_tick

    def broken(self: Loop, t_s: float, state: CoachState) -> Actuation | None:
        actuation = on_tick(self, t_s, state)
        if actuation is not None and self.brake.record["cylinder_bar"][0, 0] > 1.0:
            state.wheel_rate_radps[0] = math.nan
        return actuation

    monkeypatch.setattr(Loop, "on_tick", broken)
    with pytest.raises(SolveFailed, match=r"not finite at t = .*step of 5 ms") as failure:
        run(*SLOW_STOP)
    assert isinstance(failure.value.partial, Truth)


def phases(*items: dict[str, Any]) -> DriverParameters:
    return DriverParameters.model_validate({"phases": items})


def test_driver_holds_a_speed_on_a_point_mass() -> None:
    """56 t against 2.5 kN: after the start the speed stays within 0.1 km/h."""
    driver = Driver(phases({"from_m": 0.0, "action": "hold", "speed_kmh": 120.0}), TractionParameters(), 0.1)
    speed, history = 119.0 / 3.6, []
    for _ in range(1200):
        driver.step(0.0, speed)
        speed += 0.1 * (driver.traction_n - 2500.0) / 58_000.0
        history.append(3.6 * speed)
    assert max(history) < 120.5
    assert history[-1] == pytest.approx(120.0, abs=0.1)


def test_driver_goes_through_its_phases_and_limits_the_rise_of_traction() -> None:
    driver = Driver(
        phases(
            {"from_m": 0.0, "action": "hold", "speed_kmh": 100.0},
            {"from_m": 100.0, "action": "coast"},
            {"from_m": 200.0, "action": "brake", "demand": 0.5},
        ),
        TractionParameters(),
        0.1,
    )
    forces = []
    for position in (0.0, 10.0, 20.0, 100.0, 110.0, 120.0, 130.0):
        driver.step(position, 20.0)
        forces.append(driver.traction_n)
        assert driver.demand == 0.0
    assert np.abs(np.diff(forces)).max() <= 3000.0 + 1e-9
    assert forces[-1] == 0.0
    driver.step(250.0, 20.0)
    assert driver.demand == 0.5


BAD_PHASES = [
    ([], "at least 1"),
    ([{"from_m": 10.0, "action": "coast"}], "starts at 0"),
    ([{"from_m": 0.0, "action": "hold"}], "speed_kmh: needed"),
    ([{"from_m": 0.0, "action": "coast", "demand": 0.5}], "demand: belongs"),
    ([{"from_m": 0.0, "action": "brake", "demand": 1.5}], "less than or equal to 1"),
    ([{"from_m": 0.0, "action": "coast"}, {"from_m": 0.0, "action": "coast"}], "beyond the phase before"),
]


@pytest.mark.parametrize(("items", "message"), BAD_PHASES)
def test_bad_phases_are_refused(items: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        phases(*items)
