"""The coach of the odometry paper: its published figures, and whole runs against closed forms."""

from collections.abc import Callable
from functools import cache, partial

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.scenario_file import load_scenario
from scenarios.schema import Scenario
from scenarios.units import KMH_PER_MPS
from scenarios.verification.case import Case
from scenarios.verification.profiles import CONICITIES
from vehicle import OBSERVATION, POWERS, Actuation, Coach, CoachParameters, CoachState
from vehicle.modes import bounce_frequencies_hz
from wheel_rail.adhesion_state import STATE_CELL_M
from wheel_rail.contact_table import ROLLING_RADIUS
from wheel_rail.equivalent_conicity import equivalent_conicity

MALVEZZI = "Malvezzi et al. 2014"
GROUP = "Coach malvezzi-2014"
STEP_S = 0.005

FULL_BRAKE_NM = 6_300.0  # per wheelset
STOP_FROM_MPS, MEASURED_AT_MPS = 25.0, 20.0
SLIDE_FROM_MPS, SLIDE_S = 30.0, 8.0
SLIDING_FRICTION, LOCKING_TORQUE_NM, LOCKING_FROM_MPS = 0.05, 6_000.0, 120.0 / KMH_PER_MPS
DRY = "surface='dry', peak_adhesion=0.3"
_CURVE = f"{{mu0={SLIDING_FRICTION}, falling_a=1.0, falling_b_spm=0.0, k_adhesion=1.0, k_slip=1.0}}"
CONSTANT = f"recovery={{tau_mpj=1e-12, degraded={_CURVE}, recovered={_CURVE}}}"
"""Friction that neither falls with slip nor recovers, saturated at small creep."""
RECOVERING = "recovery='low-recovering', peak_adhesion=0.07"
PARKED_GRADIENT_PERMILLE, PARKED_S = 20.0, 60.0
_ELASTIC = (
    "the coach's table is that of an elastic contact, a mean over a patch a centimetre wide; with vanishing "
    "penetration its figure goes to the 0.177 of the rigid profiles; the published figure is that of a wheelset kept "
    "level on a crown of R300 wider by 0.5 mm"
)


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


def run_coach(
    line: Line,
    coach: CoachParameters,
    *,
    duration_s: float,
    speed_mps: float,
    brake_torque_nm: tuple[float, ...],
    step_s: float = STEP_S,
    until: Callable[[CoachState], bool] = lambda state: False,
) -> np.ndarray:
    """Observations (dtype OBSERVATION) of every step of a run with constant brake torque per wheelset."""
    rows = np.zeros(round(duration_s / step_s) + 2, OBSERVATION)
    actuation = Actuation()
    actuation.brake_torque_nm[:] = brake_torque_nm
    count = 0

    def on_step(t_s: float, state: CoachState) -> Actuation | None:
        nonlocal count
        state.observe(t_s, rows, count)
        count += 1
        return None if until(state) else actuation

    Coach(coach, line.contact, line.track, line.rail).run(step_s, duration_s, 200.0, speed_mps, on_step, step_s)
    return rows[:count]


def _standing_load_kn() -> float:
    """Mean over the eight wheels of a coach that has stood for a while on level track."""
    rows = run_coach(
        Line(_scenario()), _parameters(), duration_s=2.0, speed_mps=0.0, brake_torque_nm=(FULL_BRAKE_NM,) * 4
    )
    return float(rows["normal_force_n"][-1].mean() / 1e3)


def _dry_deceleration_mps2() -> float:
    """Slope of the speed over the half second about the speed where it is measured."""
    rows = run_coach(
        Line(_scenario()),
        _parameters(),
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


def _time_to_lock_s(step_s: float) -> float:
    """One wheelset braked beyond a friction that is the same at every slip; the others roll."""
    rows = run_coach(
        Line(_scenario(rail=CONSTANT)),
        _parameters(),
        duration_s=6.0,
        speed_mps=LOCKING_FROM_MPS,
        brake_torque_nm=(LOCKING_TORQUE_NM, 0.0, 0.0, 0.0),
        step_s=step_s,
        until=lambda state: bool(state.wheel_rate_radps[0] <= 0.0),
    )
    # when the rim came to rest within the last step
    return float(np.interp(0.0, -rows["rim_speed_mps"][-2:, 0], rows["t_s"][-2:]))


def _expected_time_to_lock_s() -> float:
    """J (v/r)/(T - mu N r): whatever the coach's speed does meanwhile, while friction slides its torque is constant.

    The brake's reaction turns the bogie and so loads its leading wheelset by T/wheelbase. That bogies and carbody dip
    as they slow down, another 0.5 % of load, is left out: it takes 0.6 % longer.
    """
    p = _parameters()
    radius_m = 0.5 * p.wheelset.wheel_diameter_m
    load_n = 2.0 * p.static_wheel_load_n + LOCKING_TORQUE_NM / p.wheelbase_m
    slowing_nm = LOCKING_TORQUE_NM - SLIDING_FRICTION * load_n * radius_m
    return p.wheelset.spin_inertia_kgm2 * LOCKING_FROM_MPS / radius_m / slowing_nm


def _parked_creep_mm() -> float:
    """How far the carbody or any wheelset is ever found from where it was left."""
    rows = run_coach(
        Line(_scenario(PARKED_GRADIENT_PERMILLE)),
        _parameters(),
        duration_s=PARKED_S,
        speed_mps=0.0,
        brake_torque_nm=(FULL_BRAKE_NM,) * 4,
    )
    places_m = np.column_stack([rows["position_m"], rows["wheelset_position_m"]])
    return float(1e3 * np.abs(places_m - places_m[0]).max())


def _energy_kept() -> float:
    """What a sliding coach leaves on the rail over the work of its creep forces."""
    scenario = _scenario(rail=RECOVERING)
    line = Line(scenario)
    rows = run_coach(
        line,
        scenario.coach,
        duration_s=SLIDE_S,
        speed_mps=SLIDE_FROM_MPS,
        brake_torque_nm=(FULL_BRAKE_NM,) * 4,
    )
    work_j = -np.trapezoid(rows["power_w"][:, POWERS.index("creep")], rows["t_s"])
    return float(line.state.energy_jpm.sum() * STATE_CELL_M / work_j)


def _conicity() -> float:
    """Equivalent conicity at 3 mm of the table from which the coach's contact is read."""
    contact = Line(_scenario()).contact
    left, right = contact.constants["table"][..., ROLLING_RADIUS]
    return float(equivalent_conicity(contact.displacement_m, left - right, np.array([0.003]), contact.radius_m)[0])


def _published_conicity() -> float:
    """That of the profiles, inclination and gauge of the coach."""
    profiles = _parameters().contact.profiles
    for slope, gauge_mm, published in CONICITIES:
        if profiles is not None and (1.0 / slope, gauge_mm) == (profiles.rail_inclination, 1e3 * profiles.gauge_m):
            return published
    raise ValueError("no figure is published for the rails on which this coach runs")


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
        _parameters().static_wheel_load_n / 1e3, "kN", _standing_load_kn, 0.005, relative=True,
    ),
    Case(
        "coach-dry-stop", GROUP, "deceleration in a dry stop, at 20 m/s: (brake + resistance)/effective mass",
        "closed form", _expected_deceleration_mps2(), "m/s²", _dry_deceleration_mps2, 0.005, relative=True,
    ),
    *(
        Case(
            f"coach-time-to-lock-{1e3 * step_s:g}", GROUP,
            "time to lock one wheelset, mu = 0.05, 120 km/h: J omega/(T - mu N r); "
            f"step {1e3 * step_s:g} ms", "closed form", _expected_time_to_lock_s(), "s",
            partial(_time_to_lock_s, step_s), 0.015, relative=True,
        )
        for step_s in (STEP_S, 0.001)
    ),
    Case(
        "coach-energy-on-rail", GROUP, "energy left on the rail over the work of the creep forces, sliding for 8 s",
        "balance of energy", 1.0, "-", _energy_kept, 0.01,
    ),
    Case(
        "coach-conicity", GROUP, "equivalent conicity of the table from which the contact is read, amplitude 3 mm",
        "reference figures, S1002/UIC60", _published_conicity(), "-", _conicity, 0.005, known_deviation=_ELASTIC,
    ),
    Case(
        "coach-parked", GROUP, "creeping of the parked coach in 60 s on 20 per mille, brakes on", "requirement",
        (0.0, 10.0), "mm", _parked_creep_mm,
    ),
)  # fmt: skip
