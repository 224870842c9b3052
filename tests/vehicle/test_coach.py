"""Whole runs of the coach against closed forms and balances."""

import gc
import weakref

import numpy as np
import pytest

from tests.vehicle.conftest import MakeBench
from vehicle import POWERS, SolverFailure
from wheel_rail.adhesion_condition import rail_condition
from wheel_rail.recovery import CONDITION, MU0

FULL_BRAKE_NM = 6300.0


def running_resistance_n(bench_parameters: object, speed: np.ndarray) -> np.ndarray:
    r = bench_parameters.resistance  # type: ignore[attr-defined]
    return r.a_n + r.b_nspm * speed + r.c_ns2pm2 * speed**2


def test_recorded_acceleration_is_the_slope_of_the_speed(make_bench: MakeBench) -> None:
    bench = make_bench()
    rows, _ = bench.run(duration_s=8.0, speed_mps=30.0, brake=lambda t: FULL_BRAKE_NM)
    steady = rows[rows["t_s"] > 4.0]
    slope = np.polyfit(steady["t_s"], steady["speed_mps"], 1)[0]
    assert steady["acceleration_mps2"].mean() == pytest.approx(slope, rel=0.005)


def test_coasting_meets_no_false_drag_in_a_curve(make_bench: MakeBench) -> None:
    """On level track in a canted curve the speed falls by the running resistance, cant and creep forces included."""
    curve = {"start_m": 100.0, "transition_m": 100.0, "length_m": 1500.0, "radius_m": 1200.0, "cant_mm": 100.0}
    for curves in ([], [curve]):
        bench = make_bench(curves=curves)
        rows, _ = bench.run(duration_s=25.0, speed_mps=30.0, position_m=60.0)
        energy = -(rows["kinetic_energy_j"][-1] - rows["kinetic_energy_j"][0])
        resistance = -np.trapezoid(rows["power_w"][:, POWERS.index("resistance")], rows["t_s"])
        creep = -np.trapezoid(rows["power_w"][:, POWERS.index("creep")], rows["t_s"])
        print(f"curves {len(curves)}: lost {energy:.0f} J, resistance {resistance:.0f} J, creep {creep:.0f} J")
        assert creep > 0.0
        # curving resistance of a coach in 1200 m: well below a third of its running resistance
        assert energy == pytest.approx(resistance + creep, rel=0.01)
        assert creep < (0.3 if curves else 0.005) * resistance


def test_balance_speed_loads_both_rails_alike(make_bench: MakeBench) -> None:
    radius, cant = 1200.0, 100.0
    speed = np.sqrt(9.81 * radius * np.tan(np.arcsin(cant / 1500.0)))
    curve = {"start_m": 100.0, "transition_m": 100.0, "length_m": 900.0, "radius_m": radius, "cant_mm": cant}
    # cones, whose contacts stay where they are: of profiles, the wheel that touches nearer the centre bears more
    bench = make_bench(geometry="conical", curves=[curve])
    # it coasts: fast enough at first to have the balance speed in the middle of the curve
    rows, _ = bench.run(duration_s=24.0, speed_mps=speed + 0.55, position_m=60.0)
    inside = rows[(rows["position_m"] > 500.0) & (rows["position_m"] < 700.0)]
    left, right = inside["normal_force_n"][:, 0::2].sum(axis=1), inside["normal_force_n"][:, 1::2].sum(axis=1)
    assert left.mean() == pytest.approx(right.mean(), rel=0.01)
    # and a passenger feels no lateral force
    assert abs(inside["specific_force_mps2"][:, 1].mean()) < 0.02


def test_trailing_wheelset_of_each_bogie_locks_first(make_bench: MakeBench) -> None:
    """Braking moves load forward within each bogie; it must come out of the model."""
    bench = make_bench(0.07, "low")
    rows, _ = bench.run(duration_s=5.0, speed_mps=30.0, brake=lambda t: min(t / 2.0, 1.0) * FULL_BRAKE_NM)
    load = rows["normal_force_n"].reshape(-1, 4, 2).sum(axis=2)[200:].mean(axis=0)
    assert load[0] > load[1]
    assert load[2] > load[3]
    locked = [rows["t_s"][np.argmax(rows["rim_speed_mps"][:, i] < 1.0)] for i in range(4)]
    assert locked[1] < locked[0]
    assert locked[3] < locked[2]


def test_wheels_of_a_parked_coach_stand(make_bench: MakeBench) -> None:
    """On 20 per mille with brakes on."""
    bench = make_bench(initial_gradient_permille=20.0)
    rows, _ = bench.run(duration_s=10.0, speed_mps=0.0, position_m=200.0, brake=lambda t: FULL_BRAKE_NM)
    assert np.abs(rows["rim_speed_mps"][rows["t_s"] > 3.0]).max() < 1e-3


def test_released_coach_rolls_away(make_bench: MakeBench) -> None:
    """The same coach without brakes rolls down by its weight less its resistance: parking is no artefact."""
    bench = make_bench(initial_gradient_permille=20.0)
    rows, _ = bench.run(duration_s=10.0, speed_mps=0.0, position_m=2000.0)
    mass, effective = bench.parameters.mass_kg, bench.parameters.effective_mass_kg
    pull = (mass * 9.81 * np.sin(np.arctan(0.02)) - running_resistance_n(bench.parameters, np.float64(1.0))) / effective
    assert rows["speed_mps"][-1] == pytest.approx(-pull * 10.0, rel=0.02)


def test_energy_and_momentum_balance_over_a_braked_run(make_bench: MakeBench) -> None:
    """Curve, cant, gradient, locking wheels, standstill: each balance closes to 1 % of the summed absolute work."""
    bench = make_bench(
        0.07,
        "low",
        curves=[{"start_m": 100.0, "transition_m": 80.0, "length_m": 200.0, "radius_m": 1200.0, "cant_mm": 100.0}],
        gradients=[{"from_m": 700.0, "gradient_permille": -5.0}],
    )
    # a driver's own anti-slip: brakes come and go each second, so that wheels slide, lock and recover
    rows, _ = bench.run(
        duration_s=80.0, speed_mps=30.0, brake=lambda t: 0.0 if t < 20.0 else FULL_BRAKE_NM * (0.3 + 0.7 * (int(t) % 2))
    )
    t, energy = rows["t_s"], rows["kinetic_energy_j"]
    work = {name: np.trapezoid(rows["power_w"][:, k], t) for k, name in enumerate(POWERS)}
    absolute = sum(np.trapezoid(np.abs(rows["power_w"][:, k]), t) for k in range(len(POWERS)))
    balance = energy[-1] - energy[0] - sum(work.values())
    print({name: round(float(value)) for name, value in work.items()}, f"open {balance:.0f} J of {absolute:.0f} J")
    assert abs(balance) < 0.01 * absolute
    assert work["creep"] < 0.0
    assert work["brake"] < 0.0
    assert work["suspension"] < 0.0  # dampers only take

    impulse = np.trapezoid(rows["external_force_n"], t, axis=0)
    change = rows["momentum_ns"][-1] - rows["momentum_ns"][0]
    total = np.trapezoid(np.linalg.norm(rows["external_force_n"], axis=1), t)
    print(f"momentum open {np.abs(change - impulse).max():.1f} of {total:.1f} Ns")
    assert np.abs(change - impulse).max() < 0.01 * total


def test_contact_force_stays_within_friction_over_a_run(make_bench: MakeBench) -> None:
    bench = make_bench(0.07, "low")
    rows, _ = bench.run(duration_s=20.0, speed_mps=20.0, brake=lambda t: FULL_BRAKE_NM * (int(2 * t) % 2))
    tangential = np.hypot(rows["longitudinal_force_n"], rows["lateral_force_n"])
    condition = np.empty(CONDITION)
    rail_condition(100.0, 0, 10.0, bench.rail, condition)  # the same everywhere
    assert np.all(tangential <= condition[MU0] * rows["normal_force_n"] * (1.0 + 1e-9))
    assert tangential.max() > 3000.0


def test_step_convergence_without_controller(make_bench: MakeBench) -> None:
    """Stops on several rails at 5 ms against 1 ms."""
    changes = []
    for peak in (0.05, 0.08, 0.3):
        bench = make_bench(peak, "low" if peak < 0.1 else "dry")
        places = []
        for step_s in (0.005, 0.001):
            rows, _ = bench.run(
                step_s=step_s, duration_s=60.0, speed_mps=10.0,
                brake=lambda t: FULL_BRAKE_NM * (0.4 + 0.6 * (int(t) % 2)),
                until=lambda state: state.speed_mps < 0.05,
            )  # fmt: skip
            places.append(rows["position_m"][-1] - rows["position_m"][0])
        changes.append(abs(places[0] / places[1] - 1.0))
    print("relative changes of the stop:", [f"{c:.2e}" for c in changes])
    assert np.mean(changes) < 0.001


def test_same_run_same_bytes(make_bench: MakeBench) -> None:
    bench = make_bench(0.07, "low")
    one, _ = bench.run(duration_s=3.0, speed_mps=20.0, brake=lambda t: FULL_BRAKE_NM)
    two, _ = bench.run(duration_s=3.0, speed_mps=20.0, brake=lambda t: FULL_BRAKE_NM)
    assert one.tobytes() == two.tobytes()


def test_errors_of_the_callback_come_out_as_they_are(make_bench: MakeBench) -> None:
    bench = make_bench()

    def broken(_t: float) -> float:
        raise ZeroDivisionError("in the callback")

    with pytest.raises(ZeroDivisionError, match="in the callback"):
        bench.run(duration_s=1.0, speed_mps=10.0, brake=broken)


def test_a_state_that_blows_up_is_reported_with_time_and_place(make_bench: MakeBench) -> None:
    bench = make_bench()
    with pytest.raises(SolverFailure, match=r"t = .* s = .* m, with a step of 5 ms"):
        bench.run(duration_s=5.0, speed_mps=10.0, drive=lambda t: float("nan") if t > 1.0 else 0.0)


@pytest.mark.parametrize("newton", [False, True])
def test_what_a_callback_knows_goes_with_the_run(make_bench: MakeBench, newton: bool) -> None:
    bench = make_bench()

    def rolling(_t: float) -> float:
        return 0.0

    callback = weakref.ref(rolling)
    bench.run(duration_s=0.05, speed_mps=10.0, drive=rolling, newton=newton)
    del rolling
    gc.collect()
    assert callback() is None
