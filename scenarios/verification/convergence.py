"""Stops at the steps that runs use against a reference: steps of 0.25 ms, iterated until the forces are in balance."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.cosimulation.loop import Loop
from scenarios.scenario_file import load_scenario
from scenarios.schema import Scenario
from scenarios.units import KMH_PER_MPS
from scenarios.verification.case import Case
from vehicle import OBSERVATION, Actuation, Coach, CoachState

GROUP = "Convergence of the stop with the step, malvezzi-2014"
REFERENCE = "0.25 ms with Newton's iterations"
REFERENCE_S, SHORTEST_STEP_S = 0.00025, 0.0005  # of the reference, and of scenarios
STEPS_S = (0.005, 0.002, 0.001)
TICK_S = 0.01
FROM_KMH, PEAK_ADHESION = 40.0, 0.08
BUILD_UP_S, BRAKE_NM = 2.0, 4_200.0  # per wheelset; the rail carries 5 kNm
LONGEST_S = 60.0
STANDS_MPS = 0.05


@dataclass(frozen=True)
class Stop:
    """Place and speed at every 10 ms of a stop, until the coach stands."""

    position_m: np.ndarray
    speed_mps: np.ndarray

    @property
    def distance_m(self) -> float:
        return float(self.position_m[-1] - self.position_m[0])


@cache
def _scenario(step_s: float, from_kmh: float) -> Scenario:
    """The built-in stop, shortened: straight level track, one kind of low rail, moderate speed."""
    return load_scenario(
        "low-adhesion-stop",
        [
            "track.curves=[]",
            "track.gradients=[]",
            f"adhesion.stretches=[{{from_m=0.0, surface='low', peak_adhesion={PEAK_ADHESION}}}]",
            f"simulation.initial_speed_kmh={from_kmh}",
            "simulation.initial_position_m=100.0",
            f"simulation.step_s={step_s}",
            f"simulation.longest_s={LONGEST_S}",
            "driver.phases=[{from_m=0.0, action='brake', demand=1.0}]",
        ],
    )


@cache
def plain_stop(step_s: float, from_kmh: float = FROM_KMH) -> Stop:
    """Brakes that build up in two seconds to what the rail carries and stay; no wheel slide protection."""
    scenario = _scenario(max(step_s, SHORTEST_STEP_S), from_kmh)
    line = Line(scenario)
    rows = np.zeros(round(LONGEST_S / TICK_S) + 2, OBSERVATION)
    actuation = Actuation()
    count = 0

    def on_step(t_s: float, state: CoachState) -> Actuation | None:
        nonlocal count
        state.observe(t_s, rows, count)
        count += 1
        actuation.brake_torque_nm[:] = BRAKE_NM * min(t_s / BUILD_UP_S, 1.0)
        return None if state.speed_mps < STANDS_MPS else actuation

    coach = Coach(scenario.coach, line.contact, line.track, line.rail)
    newton = step_s == REFERENCE_S
    coach.run(step_s, LONGEST_S, 100.0, from_kmh / KMH_PER_MPS, on_step, TICK_S, newton)
    return Stop(rows["position_m"][:count], rows["speed_mps"][:count])


@cache
def protected_stop(step_s: float, from_kmh: float = FROM_KMH) -> Stop:
    """The co-simulation's own stop, brakes and wheel slide protection at work, beyond what the rail carries."""
    scenario = _scenario(max(step_s, SHORTEST_STEP_S), from_kmh)
    line = Line(scenario)
    loop = Loop(scenario, line, lambda *_: None, lambda: False)
    coach = Coach(scenario.coach, line.contact, line.track, line.rail)
    newton = step_s == REFERENCE_S
    speed_mps = from_kmh / KMH_PER_MPS
    report = coach.run(step_s, LONGEST_S, 100.0, speed_mps, loop.on_tick, loop.turn_s, newton, loop.plant)
    motion = loop.truth(report).motion
    every = round(TICK_S / scenario.simulation.record_period_s)
    return Stop(motion.position_m[::every], motion.speed_mps[::every])


STOPS: dict[str, Callable[[float], Stop]] = {"plain": plain_stop, "protected": protected_stop}


def _distance_off_m(kind: str, step_s: float) -> float:
    return STOPS[kind](step_s).distance_m - STOPS[kind](REFERENCE_S).distance_m


def _speed_off_kmh(kind: str, step_s: float) -> float:
    """Largest difference of the speeds at the same time, in size."""
    one, two = STOPS[kind](step_s).speed_mps, STOPS[kind](REFERENCE_S).speed_mps
    both = min(len(one), len(two))
    return float(KMH_PER_MPS * np.abs(one[:both] - two[:both]).max())


def _case(kind: str, words: str, step_s: float, distance_m: float, speed_kmh: float) -> tuple[Case, Case]:
    ms = f"{1e3 * step_s:g}"
    return (
        Case(
            f"convergence-{kind}-distance-{ms}", GROUP, f"{words}: stopping distance at {ms} ms, less the reference's",
            REFERENCE, 0.0, "m", partial(_distance_off_m, kind, step_s), distance_m,
        ),
        Case(
            f"convergence-{kind}-speed-{ms}", GROUP, f"{words}: speed at {ms} ms, largest difference on the way",
            REFERENCE, 0.0, "km/h", partial(_speed_off_kmh, kind, step_s), speed_kmh,
        ),
    )  # fmt: skip


CASES = (
    *(case for step_s in STEPS_S for case in _case("plain", "fixed brake torque", step_s, 0.05, 0.05)),
    *(case for step_s in STEPS_S for case in _case("protected", "wheel slide protection", step_s, 1.0, 0.5)),
)
