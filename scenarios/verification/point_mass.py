"""The reduced model: the run that the thesis reports, and the coach beside it.

Of the reported run, only times and the top speed are known; the forces are not. They are found here by quadrature of
the model's own equation, t = integral of dv/a(v), so that the reported times come out, and the simulator must hit them.
"""

from functools import cache, partial

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from scenarios.cosimulation.simulation import simulate
from scenarios.point_mass import POINT_MASSES, STEP_S, Line, PointMass, PointMassStream, simulate_point_mass
from scenarios.point_mass_drive import drive_point_mass
from scenarios.scenario_file import load_scenario
from scenarios.truth import MotionStream
from scenarios.units import KMH_PER_MPS
from scenarios.verification.case import Case
from vehicle import GRAVITY_MPS2

LEMMA = "Lemma's thesis"
GROUP = "Reduced model of the coach"
MASS_KG = 56_000.0
TRACTION_UNTIL_S, BRAKE_FROM_S, STOPPED_AT_S, AWAY_AT_S, TOP_AT_S, ENDS_AT_S = 60.0, 80.0, 130.0, 150.0, 210.0, 240.0
TOP_MPS = 220.0 / KMH_PER_MPS
FIRST_TRACTION_SHARE = 0.9  # of the force of the second; not reported
DRY = 'adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]'
STRAIGHT = ("track.curves=[]", "track.gradients=[]", DRY)


def _seconds(model: PointMass, force_n: float, to_mps: float) -> float:
    """From rest to a speed under a constant force (against: from that speed to rest)."""
    weight_n, effective_kg = MASS_KG * GRAVITY_MPS2, (1.0 + model.rotating_share) * MASS_KG
    r0, r1, r2 = model.resistance_npkn

    def per_mps(v: float) -> float:
        kmh = KMH_PER_MPS * v
        drag_n = weight_n / 1000.0 * (r0 + kmh * (r1 + kmh * r2))
        return effective_kg / abs(force_n - drag_n)

    return float(quad(per_mps, 0.0, to_mps)[0])


@cache
def reported_run(name: str) -> PointMassStream:
    """Traction, no force, brake from 80 to 150 s, traction again, with the forces that the reported times ask for."""
    model = POINT_MASSES[name]
    top_drag_n = MASS_KG * GRAVITY_MPS2 * model.resistance(TOP_MPS) / 1000.0
    seconds = TOP_AT_S - AWAY_AT_S
    traction_n = brentq(lambda f: _seconds(model, f, TOP_MPS) - seconds, 1.0001 * top_drag_n, top_drag_n + 1e6)
    force_n = np.zeros(round(ENDS_AT_S / STEP_S))
    times = STEP_S * np.arange(len(force_n)) + 1e-9
    force_n[times < TRACTION_UNTIL_S] = FIRST_TRACTION_SHARE * traction_n
    force_n[times >= AWAY_AT_S] = traction_n
    line = Line(np.zeros(2), np.zeros(0))
    before = simulate_point_mass(model, MASS_KG, force_n[times < BRAKE_FROM_S], line).speed_mps[-1]
    seconds = STOPPED_AT_S - BRAKE_FROM_S
    brake_n = brentq(lambda f: _seconds(model, -f, before) - seconds, 1e3, 1e6)
    force_n[(times >= BRAKE_FROM_S) & (times < AWAY_AT_S)] = -brake_n
    return simulate_point_mass(model, MASS_KG, force_n, line)


def _top_at_s(name: str) -> float:
    run = reported_run(name)
    return float(run.t_s[np.argmax(run.speed_mps >= TOP_MPS)])


def _stopped(name: str, row: int) -> float:
    """When the train stops (row 0) and starts again (row -1)."""
    run = reported_run(name)
    still = np.flatnonzero((run.speed_mps <= 0.0) & (run.t_s > BRAKE_FROM_S))
    return float(run.t_s[still[row]])


@cache
def _both(*settings: str) -> tuple[MotionStream, PointMassStream]:
    scenario = load_scenario("low-adhesion-stop", [*STRAIGHT, *settings])
    return simulate(scenario, lambda *_: None, lambda: False).motion, drive_point_mass(
        scenario, POINT_MASSES["point-mass"]
    )


def _dry_stop() -> float:
    """Ways of the stops, point mass over coach."""
    coach, point = _both('driver.phases=[{from_m=0.0, action="brake", demand=1.0}]')
    return float((point.position_m[-1] - point.position_m[0]) / (coach.position_m[-1] - coach.position_m[0]))


def _coasting() -> float:
    """Losses of speed over 3 km, point mass over coach."""
    runs = _both('driver.phases=[{from_m=0.0, action="coast"}]', "simulation.longest_s=95")
    point, coach = (float(run.speed_mps[0] - np.interp(3050.0, run.position_m, run.speed_mps)) for run in runs[::-1])
    return point / coach


CASES = (
    *(
        Case(f"{name}-{id}", GROUP, f"{quantity}, {name}", LEMMA, expected, "s", partial(obtain, name), 2.0 * STEP_S)
        for name in POINT_MASSES
        for id, quantity, expected, obtain in (
            ("stopped", "braked from 80 s on, the train stops at", STOPPED_AT_S, partial(_stopped, row=0)),
            ("away", "braked until 150 s, it stands until", AWAY_AT_S, partial(_stopped, row=-1)),
            ("top", "220 km/h are reached at", TOP_AT_S, _top_at_s),
        )
    ),
    Case(
        "point-mass-dry-stop", GROUP, "way of a dry stop from 120 km/h, point mass over coach", "the coach", 1.0, "-",
        _dry_stop, 0.01,
    ),
    Case(
        "point-mass-coasting", GROUP, "speed lost coasting 3 km from 120 km/h, point mass over coach", "the coach", 1.0,
        "-", _coasting, 0.01,
    ),
)  # fmt: skip
