"""The linearised step: its forces solve the implicit equations, and its response turns with the track."""

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.vehicle.conftest import Bench, MakeBench, coach_of
from vehicle import coach as coach_module
from vehicle.forces import coach_force
from vehicle.implicit import ALPHA_F, ALPHA_M, BETA, GAMMA, new_response, respond, room_for_response
from vehicle.jacobian import coach_jacobian
from vehicle.layout import SPIN, masses
from vehicle.start import start_state
from wheel_rail.compiled import address_of

STEP_S = 0.005
SHARE = (1.0 - ALPHA_M) / (1.0 - ALPHA_F)
RADIUS_M = 1000.0
CURVE = {"start_m": 100.0, "transition_m": 50.0, "length_m": 400.0, "radius_m": RADIUS_M, "cant_mm": 0.0}
CANTED = {"start_m": 60.0, "transition_m": 50.0, "length_m": 300.0, "radius_m": 500.0, "cant_mm": 100.0}


def sliding_at(bench: Bench, s_m: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The coach's record at a place of the arc, its wheels sliding, with the response there; its response and Jacobian.

    The response is read by its address: keep it.
    """
    record, q, v = start_state(bench.parameters, bench.contact, bench.track, bench.rail, s_m, 20.0)
    v[SPIN : SPIN + 4] *= 0.99
    n = len(q)
    coach_force(q, v, np.empty(n), record, bench.track.table, bench.rail)
    jacobian = np.empty((n, n))
    coach_jacobian(q, v, BETA * STEP_S**2, GAMMA * STEP_S, record, jacobian)
    coach = record[0]
    coach["ahead_q"][:n], coach["ahead_v"][:n] = q, v
    response = room_for_response(n)
    coach["response_at"] = address_of(response)
    new_response(STEP_S, coach)
    return record, response, jacobian


@pytest.mark.parametrize("axle_boxes", ["lumped", "explicit"])
def test_the_masses_alone_make_the_implicit_step(make_bench: MakeBench, axle_boxes: str) -> None:
    record, response, jacobian = sliding_at(make_bench(given=coach_of(axle_boxes=axle_boxes), curves=[CURVE]), 250.0)
    assert len(response) == len(jacobian)
    inertia = SHARE * masses(record[0])
    force = np.random.default_rng(1).normal(size=len(jacobian)) * inertia
    handed = force.copy()
    respond(handed, record[0])
    acceleration = handed / inertia
    assert inertia * acceleration + jacobian @ acceleration == pytest.approx(force, rel=1e-6, abs=1e-8 * inertia.max())


@pytest.mark.parametrize("ahead_m", [0.5, 15.0, 200.0])
def test_the_response_is_that_of_the_new_heading(make_bench: MakeBench, ahead_m: float) -> None:
    """On a level arc all places are alike but for the heading."""
    bench = make_bench(curves=[CURVE])
    old, kept, _ = sliding_at(bench, 200.0)
    new, _fresh, _ = sliding_at(bench, 200.0 + ahead_m)
    force = np.random.default_rng(1).normal(size=len(kept)) * masses(new[0])
    expected, unturned, turned = force.copy(), force.copy(), force.copy()
    respond(expected, new[0])
    respond(unturned, old[0])
    coach = new[0]
    coach["old_axes"], coach["response_at"] = old[0]["old_axes"], address_of(kept)
    respond(turned, coach)
    error = np.abs(turned - expected).max()
    print(f"error {error:.2g} of {np.abs(expected).max():.3g}, without turning {np.abs(unturned - expected).max():.3g}")
    assert error < 1e-9 * np.abs(expected).max()
    assert np.abs(unturned - expected).max() > 30.0 * error


@pytest.mark.parametrize("axle_boxes", ["lumped", "explicit"])
def test_the_solver_takes_from_the_predictor_what_it_is_handed(
    make_bench: MakeBench, monkeypatch: pytest.MonkeyPatch, axle_boxes: str
) -> None:
    """The state at the end of every step is the predictor worked out ahead, moved by the accelerations handed over."""
    records: list[np.ndarray] = []
    begin, start = coach_module.pre_step, coach_module.start_state
    worst = [0.0, 0.0]
    steps = 0

    def spy_start(*rest: object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        state = start(*rest)  # type: ignore[arg-type]
        records.append(state[0])
        return state

    def look() -> None:
        nonlocal steps
        coach = records[0][0]
        n, step_s = int(coach["coordinates"]), float(coach["step_s"])
        if coach["steps"] > 0:
            q, v, _, f = (
                np.ctypeslib.as_array((ctypes.c_double * n).from_address(int(at))) for at in coach["solver_at"]
            )
            d = f / (SHARE * masses(coach))
            worst[0] = max(worst[0], np.abs(coach["ahead_q"][:n] + BETA * step_s**2 * d - q).max())
            worst[1] = max(worst[1], np.abs(coach["ahead_v"][:n] + GAMMA * step_s * d - v).max())
            steps += 1

    def spy(address: int) -> Callable[[Any, float], bool]:
        pre_step = begin(address)

        def looking_step(system: Any, end_s: float) -> bool:
            look()
            return pre_step(system, end_s)

        return looking_step

    monkeypatch.setattr(coach_module, "start_state", spy_start)
    monkeypatch.setattr(coach_module, "pre_step", spy)
    bench = make_bench(0.08, "low", given=coach_of(axle_boxes=axle_boxes), curves=[CANTED])
    bench.run(duration_s=5.0, speed_mps=20.0, brake=lambda t: 6300.0 * (int(2 * t) % 2))
    print(f"{steps} steps, off by {worst[0]:.1e} m or rad, {worst[1]:.1e} m/s or rad/s")
    assert steps > 900
    assert worst[0] < 1e-9
    assert worst[1] < 1e-8
