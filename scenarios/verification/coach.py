"""The coach of the odometry paper: its published figures, and whole runs against closed forms."""

from collections.abc import Callable
from functools import cache

import numpy as np

from scenarios.cosimulation import Line
from scenarios.scenario_file import load_scenario
from scenarios.schema import Scenario
from scenarios.verification.case import Case
from vehicle import OBSERVATION, Actuation, Coach, CoachParameters, CoachState
from vehicle.modes import bounce_frequencies_hz

MALVEZZI = "Malvezzi et al. 2014"
GROUP = "Coach malvezzi-2014"
STEP_S = 0.005
GRAVITY_MPS2 = 9.81

FULL_BRAKE_NM = 6_300.0  # per wheelset
STOP_FROM_MPS, MEASURED_AT_MPS = 25.0, 20.0
SLIDING_FRICTION, LOCKING_TORQUE_NM, LOCKING_FROM_MPS = 0.05, 6_000.0, 120.0 / 3.6
DRY = "surface='dry', peak_adhesion=0.3"
_CURVE = f"{{mu0={SLIDING_FRICTION}, falling_a=1.0, falling_b_spm=0.0, k_adhesion=1.0, k_slip=1.0}}"
CONSTANT = f"recovery={{tau_mpj=1e-12, degraded={_CURVE}, recovered={_CURVE}}}"
"""Friction that neither falls with slip nor recovers, saturated at small creep."""
PARKED_GRADIENT_PERMILLE, PARKED_S = 20.0, 60.0


@cache
def _scenario(gradient_permille: float = 0.0, rail: str = DRY) -> Scenario:
    """The coach on a straight line of one gradient and one kind of rail."""
    return load_scenario(
        "low-adhesion-stop",
        [
            "coach.preset=malvezzi-2014",
            "track.curves=[]",
            "track.gradients=[]",
            f"track.initial_gradient_permille={gradient_permille}",
            f"adhesion.stretches=[{{from_m=0.0, {rail}}}]",
        ],
    )


def _parameters() -> CoachParameters:
    return _scenario().coach


def _run(
    scenario: Scenario,
    *,
    duration_s: float,
    speed_mps: float,
    brake_torque_nm: tuple[float, ...],
    until: Callable[[CoachState], bool] = lambda state: False,
) -> np.ndarray:
    """Observations (dtype OBSERVATION) of every step of a run with constant brake torque per wheelset."""
    line = Line(scenario)
    rows = np.zeros(round(duration_s / STEP_S) + 2, OBSERVATION)
    actuation = Actuation(brake_torque_nm=np.array(brake_torque_nm))
    count = 0

    def on_step(t_s: float, state: CoachState) -> Actuation | None:
        nonlocal count
        state.observe(t_s, rows, count)
        count += 1
        return None if until(state) else actuation

    coach = Coach(scenario.coach, line.contact, line.track, line.rail)
    coach.run(STEP_S, duration_s, 200.0, speed_mps, on_step, STEP_S)
    return rows[:count]


def _standing_load_kn() -> float:
    """Mean over the eight wheels of a coach that has stood for a while on level track."""
    rows = _run(_scenario(), duration_s=2.0, speed_mps=0.0, brake_torque_nm=(FULL_BRAKE_NM,) * 4)
    return float(rows["normal_force_n"][-1].mean() / 1e3)


def _dry_deceleration_mps2() -> float:
    """Slope of the speed over the half second about the speed where it is measured."""
    rows = _run(
        _scenario(),
        duration_s=12.0,
        speed_mps=STOP_FROM_MPS,
        brake_torque_nm=(FULL_BRAKE_NM,) * 4,
        until=lambda state: state.speed_mps < MEASURED_AT_MPS - 1.0,
    )
    at = int(np.argmax(rows["speed_mps"] < MEASURED_AT_MPS))
    near = rows[at - 50 : at + 51]
    return float(-np.polyfit(near["t_s"], near["speed_mps"], 1)[0])


def _expected_deceleration_mps2() -> float:
    p = _parameters()
    braking_n = 4.0 * FULL_BRAKE_NM / (0.5 * p.wheelset.wheel_diameter_m)
    r = p.resistance
    resistance_n = r.a_n + r.b_nspm * MEASURED_AT_MPS + r.c_ns2pm2 * MEASURED_AT_MPS**2
    return (braking_n + resistance_n) / p.effective_mass_kg


def _time_to_lock_s() -> float:
    """One wheelset braked beyond a friction that is the same at every slip; the others roll."""
    rows = _run(
        _scenario(rail=CONSTANT),
        duration_s=6.0,
        speed_mps=LOCKING_FROM_MPS,
        brake_torque_nm=(LOCKING_TORQUE_NM, 0.0, 0.0, 0.0),
        until=lambda state: bool(state.wheel_rate_radps[0] <= 0.0),
    )
    return float(rows["t_s"][-1])


def _expected_time_to_lock_s() -> float:
    """J (v/r)/(T - mu N r): whatever the coach's speed does meanwhile, while friction slides its torque is constant.

    The brake's reaction turns the bogie and so loads its leading wheelset by T/wheelbase.
    """
    p = _parameters()
    radius_m = 0.5 * p.wheelset.wheel_diameter_m
    load_n = 2.0 * p.static_wheel_load_n + LOCKING_TORQUE_NM / p.wheelbase_m
    slowing_nm = LOCKING_TORQUE_NM - SLIDING_FRICTION * load_n * radius_m
    return p.wheelset.spin_inertia_kgm2 * LOCKING_FROM_MPS / radius_m / slowing_nm


def _parked_creep_mm() -> float:
    """How far the carbody or any wheelset is ever found from where it was left."""
    rows = _run(
        _scenario(PARKED_GRADIENT_PERMILLE),
        duration_s=PARKED_S,
        speed_mps=0.0,
        brake_torque_nm=(FULL_BRAKE_NM,) * 4,
    )
    places_m = np.column_stack([rows["position_m"], rows["wheelset_position_m"]])
    return float(1e3 * np.abs(places_m - places_m[0]).max())


CASES = (
    Case("coach-mass", GROUP, "mass", MALVEZZI, 56.0, "t", lambda: _parameters().mass_kg / 1e3, 0.01, relative=True),
    Case(
        "coach-body-bounce", GROUP, "natural frequency of the carbody's bounce", MALVEZZI, 0.8, "Hz",
        lambda: bounce_frequencies_hz(_parameters())[0], 0.05, relative=True,
    ),
    Case(
        "coach-bogie-bounce", GROUP, "natural frequency of the bogies' bounce", MALVEZZI, 4.5, "Hz",
        lambda: bounce_frequencies_hz(_parameters())[1], 0.05, relative=True,
    ),
    Case(
        "coach-static-load", GROUP, "normal force of a wheel of the standing coach: m g/8", "closed form",
        _parameters().mass_kg * GRAVITY_MPS2 / 8e3, "kN", _standing_load_kn, 0.005, relative=True,
    ),
    Case(
        "coach-dry-stop", GROUP, "deceleration in a dry stop, at 20 m/s: (brake + resistance)/effective mass",
        "closed form", _expected_deceleration_mps2(), "m/s²", _dry_deceleration_mps2, 0.005, relative=True,
    ),
    Case(
        "coach-time-to-lock", GROUP, "time to lock one wheelset, mu = 0.05, 120 km/h: J omega/(T - mu N r)",
        "closed form", _expected_time_to_lock_s(), "s", _time_to_lock_s, 0.05, relative=True,
    ),
    Case(
        "coach-parked", GROUP, "creeping of the parked coach in 60 s on 20 per mille, brakes on", "requirement",
        (0.0, 10.0), "mm", _parked_creep_mm,
    ),
)  # fmt: skip
