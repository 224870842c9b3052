"""The coach in a curve at balance speed, coasting without running resistance: loads of the rails, and what slows it."""

import math
from functools import cache, partial

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.scenario_file import load_scenario
from scenarios.schema import Scenario
from scenarios.verification.case import Case
from scenarios.verification.coach import run_coach
from vehicle import POWERS
from vehicle.parameters import GRAVITY_MPS2
from wheel_rail.contact_table import RAIL_Y, SLOPE
from wheel_rail.track_parameters import RAIL_SPACING_M

GROUP = "Coach malvezzi-2014 in a curve"
RADIUS_M, CANT_MM = 1200.0, 100.0
BALANCE_MPS = math.sqrt(GRAVITY_MPS2 * RADIUS_M * math.tan(math.asin(CANT_MM / 1000.0 / RAIL_SPACING_M)))
STEADY_S, DURATION_S = 12.0, 32.0
_OUTWARDS = (
    "the wheelsets run 2 to 5 mm outwards and touch the outer rail 9 to 16 mm further in, the inner rail 5 to 7 mm "
    "further out: the load goes with these places, see the row below"
)


@cache
def _scenario() -> Scenario:
    curve = f"{{start_m=250.0, transition_m=120.0, length_m=1500.0, radius_m={RADIUS_M}, cant_mm={CANT_MM}}}"
    return load_scenario(
        "low-adhesion-stop",
        [
            "coach.preset=malvezzi-2014",
            *(f"coach.resistance.{name}=0.0" for name in ("a_n", "b_nspm", "c_ns2pm2")),
            f"track.curves=[{curve}]",
            "track.gradients=[]",
            "adhesion.stretches=[{from_m=0.0, surface='dry', peak_adhesion=0.3}]",
        ],
    )


@cache
def _steady_rows(step_s: float) -> np.ndarray:
    """Observations from when the coach has settled in the circular part."""
    scenario = _scenario()
    rows = run_coach(
        Line(scenario),
        scenario.coach,
        duration_s=DURATION_S,
        speed_mps=BALANCE_MPS,
        brake_torque_nm=(0.0,) * 4,
        step_s=step_s,
    )
    return rows[rows["t_s"] >= STEADY_S]


def _lost(step_s: float) -> tuple[float, float, float]:
    """Kinetic energy lost, what the forces took of it (J), and the way (m)."""
    rows = _steady_rows(step_s)
    taken = -sum(np.trapezoid(rows["power_w"][:, k], rows["t_s"]) for k in range(len(POWERS)))
    energy, place = rows["kinetic_energy_j"], rows["position_m"]
    return float(energy[0] - energy[-1]), float(taken), float(place[-1] - place[0])


def _explained(step_s: float) -> float:
    lost_j, taken_j, _ = _lost(step_s)
    return lost_j / taken_j


def _false_drag_n(step_s: float) -> float:
    lost_j, taken_j, way_m = _lost(step_s)
    return (lost_j - taken_j) / way_m


def _vertical_loads_n() -> np.ndarray:
    """Force of each rail on its four wheels square to the track, (2,): normal and lateral creep force, by the slope."""
    rows = _steady_rows(0.005)
    normal, across = (rows[name].mean(axis=0).reshape(4, 2) for name in ("normal_force_n", "lateral_force_n"))
    slope = _at_contacts(SLOPE)
    # the slope carries the left wheel's lateral force upwards when it acts to the left, the right wheel's downwards
    loads: np.ndarray = ((normal + np.array([1.0, -1.0]) * slope * across) / np.hypot(1.0, slope)).sum(axis=0)
    return loads


def _at_contacts(column: int) -> np.ndarray:
    """A column of the contact table where the eight wheels run, (4, 2)."""
    contact = Line(_scenario()).contact
    displacement = _steady_rows(0.005)["lateral_displacement_m"].mean(axis=0)
    table = contact.constants["table"]
    return np.stack([np.interp(displacement, contact.displacement_m, table[k, :, column]) for k in range(2)], axis=1)


def _load_ratio() -> float:
    left, right = _vertical_loads_n()
    return float(left / right)


def _load_ratio_by_levers() -> float:
    """The ratio over that of the levers: the weight acts where the wheelsets are, the rails where they are touched."""
    rows = _steady_rows(0.005)
    centre = rows["lateral_displacement_m"].mean()
    left, right = _at_contacts(RAIL_Y).mean(axis=0)
    return float(_load_ratio() * (left - centre) / (right + centre))


CASES = (
    Case(
        "curve-loads", GROUP, "load of the inner rail over the outer one at balance speed, R = 1200 m, cant 100 mm",
        "balance of forces", 1.0, "-", _load_ratio, 0.005, known_deviation=_OUTWARDS,
    ),
    Case(
        "curve-loads-levers", GROUP, "the same over what the places of the contacts make of it", "balance of moments",
        1.0, "-", _load_ratio_by_levers, 0.005,
    ),
    *(
        Case(
            f"curve-energy-{1e3 * step_s:g}", GROUP,
            f"energy lost in coasting over what creep and suspension took; step {1e3 * step_s:g} ms",
            "balance of energy", 1.0, "-", partial(_explained, step_s), tolerance,
        )
        for step_s, tolerance in ((0.005, 0.1), (0.001, 0.02))
    ),
    *(
        Case(
            f"curve-false-drag-{1e3 * step_s:g}", GROUP,
            f"drag that no force explains; step {1e3 * step_s:g} ms", "requirement", (-bound_n, bound_n), "N",
            partial(_false_drag_n, step_s),
        )
        for step_s, bound_n in ((0.005, 2.0), (0.001, 0.2))
    ),
)  # fmt: skip
