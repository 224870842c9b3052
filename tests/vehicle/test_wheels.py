"""Unequal and out-of-round wheels: rolling, loads, energy."""

import numpy as np
import pytest

from tests.vehicle.conftest import MakeBench, coach_of
from vehicle import POWERS, CoachParameters
from wheel_rail.track_parameters import RAIL_SPACING_M

UNEQUAL_M = [0.92, 0.92, 0.90, 0.90, 0.92, 0.92, 0.91, 0.91]
AMPLITUDE_M = 5e-4


def test_smaller_wheels_turn_faster_and_stand_at_once(make_bench: MakeBench) -> None:
    """Each rolls with its own radius, and no transient follows from the start."""
    for form in ("lumped", "explicit"):
        bench = make_bench(given=coach_of(wheels={"diameter_m": UNEQUAL_M}, axle_boxes=form))
        rows, _ = bench.run(duration_s=4.0, speed_mps=20.0)
        turned = rows["wheel_angle_rad"][-1] - rows["wheel_angle_rad"][200]
        way_m = rows["position_m"][-1] - rows["position_m"][200]
        nominal = bench.contact.rolling_radius_m
        radius_m = nominal + 0.5 * (np.array(UNEQUAL_M[::2]) - 0.92)
        assert turned * radius_m == pytest.approx(np.full(4, way_m), rel=2e-4)
        # the lower wheelset unloads as little as its springs are let down: levelled by the start, nothing swings
        load = rows["normal_force_n"].reshape(-1, 4, 2).sum(axis=2)
        assert np.abs(load / load.mean() - 1.0).max() < 0.02
        slip = rows["wheelset_speed_mps"] - rows["rim_speed_mps"]
        assert np.abs(slip[200:]).max() < 0.01 * 20.0


def test_larger_left_wheels_run_to_where_both_roll_alike(make_bench: MakeBench) -> None:
    """The whole coach runs to the right until the cones' radii have made up for it: y = dr/(2 conicity)."""
    bench = make_bench(given=coach_of(wheels={"diameter_m": [0.9202, 0.92] * 4}), geometry="conical")
    rows, _ = bench.run(duration_s=60.0, speed_mps=15.0)
    shifted = rows["lateral_displacement_m"][-2000:].mean(axis=0)
    assert shifted == pytest.approx(np.full(4, -1e-4 / (2.0 * 0.05)), rel=0.05)


def static_swing_n(coach: CoachParameters, roll_rad: float) -> float:
    """Change of load of a wheel of a bogie's second wheelset that is rolled: springs in roll between wheelsets, bogies
    and body in balance. (Lifting a wheelset straight changes no load: that is statically determined.)
    """
    p = coach
    arm = 1.0 / (1.0 / 4e6 + 0.7**2 / 20_400.0)
    k1 = 2.0 * (p.primary.stiffness_npm[2] + arm + 10_700.0 + 45_000.0)  # springs 1 m off the centre
    k2 = 2.0 * p.secondary.stiffness_npm[2] + p.anti_roll_bar_nmprad
    a = np.array([[1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 0], [-1, 0, 1], [0, -1, 1]], dtype=float)
    stiffness = np.diag([k1] * 4 + [k2] * 2)
    rolled = np.zeros(6)
    rolled[1] = roll_rad
    moved = np.linalg.solve(a.T @ stiffness @ a, a.T @ stiffness @ rolled)
    return float(k1 * (roll_rad - a[1] @ moved)) / RAIL_SPACING_M


def test_a_wheelset_eccentric_in_opposition_twists_the_coach_once_a_turn(make_bench: MakeBench) -> None:
    """Rolling slowly, each wheel presses more where it is larger, by what rolling the wheelset in its suspension takes.

    On rails so slippery that the wheels, a tenth of a per cent apart in radius, do not steer it.
    """
    coach = coach_of(wheels={"out_of_roundness": [
        {"wheel": "2L", "order": 1, "amplitude_m": AMPLITUDE_M},
        {"wheel": "2R", "order": 1, "amplitude_m": AMPLITUDE_M, "phase_deg": 180.0},
    ]})  # fmt: skip
    bench = make_bench(0.01, "very-low", "conical", coach)
    rows, _ = bench.run(duration_s=26.0, speed_mps=0.5, drive=lambda t: 101.4)
    late = rows[rows["t_s"] > 8.0]
    angle = late["wheel_angle_rad"][:, 1]
    basis = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle)])
    swing, across, _ = np.linalg.lstsq(basis, late["normal_force_n"][:, 2:4], rcond=None)[0]
    expected = static_swing_n(coach, 2.0 * AMPLITUDE_M / RAIL_SPACING_M)
    print(f"swing {swing[0]:.1f} and {swing[1]:.1f} N, across {np.abs(across).max():.1f} N, expected {expected:.1f} N")
    assert swing == pytest.approx([expected, -expected], rel=0.1)
    assert np.abs(across).max() < 0.1 * expected


def test_energy_balances_on_wheels_out_of_round(make_bench: MakeBench) -> None:
    """The normal force of a wheel that is not round turns it: with that torque left out the balance would not close."""
    harmonics = [{"wheel": w, "order": n, "amplitude_m": 4e-4 / n, "phase_deg": 40.0 * n}
                 for w in ("1L", "1R", "3L") for n in (1, 2, 3)]  # fmt: skip
    bench = make_bench(given=coach_of(wheels={"out_of_roundness": harmonics}))
    rows, _ = bench.run(step_s=0.001, duration_s=6.0, speed_mps=25.0)
    work = np.trapezoid(rows["power_w"], rows["t_s"], axis=0)
    gained = rows["kinetic_energy_j"][-1] - rows["kinetic_energy_j"][0]
    contact_j = work[POWERS.index("contact_normal")]
    print(f"open {gained - work.sum():.0f} J of {gained:.0f} J; normal contact {contact_j:.0f} J")
    assert gained == pytest.approx(work.sum(), abs=0.01 * np.abs(work).sum())
    # what shakes the coach comes out of its motion: more is lost than by resistance and creep alone
    assert -gained > -(work[POWERS.index("resistance")] + work[POWERS.index("creep")])
