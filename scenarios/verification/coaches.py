"""The other coaches and forms: Manchester benchmark vehicle 1, the UIC-Z1-like coach, explicit axle boxes, loads."""

from functools import cache, partial

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.scenario_file import load_scenario
from scenarios.schema import Scenario
from scenarios.verification.case import Case
from scenarios.verification.coach import MALVEZZI
from vehicle import GRAVITY_MPS2, OBSERVATION, Actuation, Coach, CoachState
from vehicle.forces import SUSPENSION, forces_by_class
from vehicle.modes import bounce_frequencies_hz
from vehicle.start import start_state

IWNICKI = "Iwnicki 1998"
MANCHESTER, UIC, EXPLICIT = "manchester-1", "uic-z1", "malvezzi-2014, explicit axle boxes"
GROUP = "Other coaches and forms"
MANCHESTER_MASS_KG = 32_000.0 + 2.0 * 2_615.0 + 4.0 * 1_813.0
STOP_AT_M, STOP_FORCE_N = 0.045, 6_870.0
_STANDING_S, _STEP_S, _BRAKE_NM = 2.0, 0.005, 6_300.0


@cache
def _scenario(*settings: str) -> Scenario:
    """A coach on straight level track."""
    level = (
        "track.curves=[]",
        "track.gradients=[]",
        'adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]',
    )
    return load_scenario("low-adhesion-stop", [f"coach.{setting}" for setting in settings] + list(level))


_MANCHESTER = (f"preset={MANCHESTER}",)
_EXPLICIT = ("preset=malvezzi-2014", "axle_boxes=explicit")


def _standing_load_kn(*settings: str) -> float:
    """Mean over the eight wheels of a coach that has stood for a while."""
    scenario = _scenario(*settings)
    line = Line(scenario)
    rows = np.zeros(1, OBSERVATION)
    actuation = Actuation()
    actuation.brake_torque_nm[:] = _BRAKE_NM

    def on_step(t_s: float, state: CoachState) -> Actuation:
        state.observe(t_s, rows, 0)
        return actuation

    Coach(scenario.coach, line.contact, line.track, line.rail).run(_STEP_S, _STANDING_S, 200.0, 0.0, on_step, _STEP_S)
    return float(rows["normal_force_n"].mean() / 1e3)


def _lateral_stop_n() -> float:
    """What the stops of both bogies add when the body is moved from 0 to where they act, less the springs."""
    scenario = _scenario(*_MANCHESTER)
    line = Line(scenario)
    record, q, v = start_state(scenario.coach, line.contact, line.track, line.rail, 200.0, 0.0)
    forces = []
    for moved_m in (0.0, STOP_AT_M):
        at = q.copy()
        at[1] += moved_m
        forces_by_class(at, v, record[0], line.track.table, line.rail)
        forces.append(float(record[0]["force"][SUSPENSION, 1]))
    springs_n = 4.0 * scenario.coach.secondary.stiffness_npm[1] * STOP_AT_M
    return (forces[0] - forces[1] - springs_n) / 2.0


def _bounce_hz(which: int) -> float:
    return bounce_frequencies_hz(_scenario(*_EXPLICIT).coach)[which]


def _full_service_share() -> float:
    """Pressure on the pads over the mass to be braked: seated over empty."""
    shares = []
    for load in ("empty", "seated"):
        scenario = _scenario("preset=malvezzi-2014", f"load={load}")
        brake = scenario.brake_at_load
        pads_bar = brake.full_service_pressure_bar - brake.return_spring_pressure_bar
        shares.append(pads_bar / scenario.coach.effective_mass_kg)
    return shares[1] / shares[0]


CASES = (
    Case(
        "manchester-static-load", GROUP, f"{MANCHESTER}: normal force of a wheel of the standing coach, its masses",
        IWNICKI, MANCHESTER_MASS_KG * GRAVITY_MPS2 / 8e3, "kN", partial(_standing_load_kn, *_MANCHESTER), 0.005,
        relative=True,
    ),
    Case(
        "manchester-lateral-stop", GROUP, f"{MANCHESTER}: bump stop of a bogie, body {1e3 * STOP_AT_M:g} mm off",
        IWNICKI, STOP_FORCE_N, "N", _lateral_stop_n, 0.001, relative=True,
    ),
    Case(
        "uic-z1-static-load", GROUP, f"{UIC}: normal force of a wheel, a coach of 45 to 50 t", "typical of the class",
        (45.0 * GRAVITY_MPS2 / 8.0, 50.0 * GRAVITY_MPS2 / 8.0), "kN", partial(_standing_load_kn, f"preset={UIC}"),
    ),
    Case(
        "explicit-static-load", GROUP, f"{EXPLICIT}: normal force of a wheel of the standing coach, 56 t", MALVEZZI,
        56.0 * GRAVITY_MPS2 / 8.0, "kN", partial(_standing_load_kn, *_EXPLICIT), 0.01, relative=True,
    ),
    Case(
        "explicit-body-bounce", GROUP, f"{EXPLICIT}: natural frequency of the carbody's bounce", MALVEZZI, 0.8, "Hz",
        partial(_bounce_hz, 0), 0.05, relative=True,
    ),
    Case(
        "explicit-bogie-bounce", GROUP, f"{EXPLICIT}: natural frequency of the bogies' bounce", MALVEZZI, 4.5, "Hz",
        partial(_bounce_hz, 1), 0.05, relative=True,
    ),
    Case(
        "seated-static-load", GROUP, "malvezzi-2014 with 8 t of payload: normal force of a wheel", "closed form",
        64.0 * GRAVITY_MPS2 / 8.0, "kN", partial(_standing_load_kn, "preset=malvezzi-2014", "load=seated"), 0.005,
        relative=True,
    ),
    Case(
        "seated-full-service", GROUP, "pads' pressure over the mass to be braked, rotating parts too: seated/empty",
        "load-proportional brake", 1.0, "-", _full_service_share, 1e-6,
    ),
)  # fmt: skip
