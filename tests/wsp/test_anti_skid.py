"""Anti-skid of traction on a point mass over four driven wheelsets, on rails of falling friction."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numba import njit

from wsp.anti_skid import AntiSkid
from wsp.anti_skid_parameters import AntiSkidParameters

TICK_S, STEPS = 0.01, 20
MASS_KG, RADIUS_M, INERTIA_KGM2, GRAVITY = 56_000.0, 0.46, 110.0, 9.81
LOAD_N = MASS_KG * GRAVITY / 4 * np.array([0.97, 1.02, 0.98, 1.03])
PITCH_M = 2 * math.pi * RADIUS_M / 100
DEMAND_NM = 9_000.0  # 1.4 m/s2, adhesion 0.14


@njit(cache=True)
def adhesion(creep: float, slip_mps: float, mu0: float) -> float:
    """Polach's curve for one set of sizes; friction falls to 0.4 of mu0."""
    mu = mu0 * (0.6 * math.exp(-0.2 * slip_mps) + 0.4)
    eps = 45.0 * creep / mu
    return 2 * mu / math.pi * (eps / (1 + eps * eps) + math.atan(0.4 * eps))


@njit(cache=True)
def peak(speed_mps: float, mu0: float) -> float:
    best, creep = 0.0, 1e-4
    while creep < 0.3:
        best = max(best, adhesion(creep, creep * max(speed_mps, 0.5), mu0))
        creep *= 1.05
    return best


@njit(cache=True)
def advance(coach, rims, edges, torque_nm, demand_nm, mu0: float, slope: float, load_n, step_s: float, steps: int):
    """coach: time, speed, work done, work possible. edges (4, 3): pitches turned, time of the last edge, reading."""
    offered = peak(coach[1], mu0)
    for _ in range(steps):
        speed = coach[1]
        total = possible = 0.0
        for i in range(4):
            reference = max(abs(speed), abs(rims[i]), 0.5)
            slip = rims[i] - speed
            sign = 1.0 if slip >= 0.0 else -1.0
            force = load_n[i] * adhesion(abs(slip) / reference, abs(slip), mu0)
            slope_n = max(0.0, load_n[i] * adhesion(abs(slip) / reference + 1e-5, abs(slip), mu0) - force)
            gain = RADIUS_M / INERTIA_KGM2 * step_s
            change = gain * (torque_nm[i] - sign * force * RADIUS_M)
            change /= 1 + gain * RADIUS_M * slope_n / (1e-5 * reference)
            turned = (rims[i] + 0.5 * change) * step_s / PITCH_M
            rims[i] += change
            before = edges[i, 0]
            edges[i, 0] = before + turned
            crossed = math.floor(edges[i, 0]) - math.floor(before)
            if crossed >= 1.0:
                at = coach[0] + step_s * (math.floor(edges[i, 0]) - before) / turned
                edges[i, 2] = crossed * PITCH_M / (at - edges[i, 1])
                edges[i, 1] = at
            total += torque_nm[i] / RADIUS_M - INERTIA_KGM2 / RADIUS_M**2 * change / step_s
            possible += min(load_n[i] * offered, demand_nm[i] / RADIUS_M)
        coach[1] += ((total - 800.0) / MASS_KG - GRAVITY * slope) * step_s
        coach[1] = max(coach[1], 0.0)
        coach[0] += step_s
        coach[2] += total * coach[1] * step_s
        coach[3] += possible * coach[1] * step_s


@dataclass
class Start:
    """Rows: time, speed, four rims, reference, four torques."""

    rows: np.ndarray
    utilisation: float

    @property
    def slip_mps(self) -> np.ndarray:
        return self.rows[:, 2:6] - self.rows[:, 1:2]


def start(
    mu0: Any, seconds: float = 40.0, slope: float = 0.0, demand_nm: Any = DEMAND_NM, outside: bool = False,
    control: AntiSkid | None = None, blind: tuple[int, ...] = (), load_n: np.ndarray = LOAD_N,
) -> Start:  # fmt: skip
    """A start from rest; mu0 a number or a function of time. The answer of a tick acts from the next one on."""
    control = control or AntiSkid(AntiSkidParameters(), TICK_S)
    coach, rims, edges = np.zeros(4), np.zeros(4), np.zeros((4, 3))
    edges[:, 0] = (0.1, 0.4, 0.6, 0.8)
    valid = np.array([i not in blind for i in range(4)])
    answer = np.zeros(4)
    rows = []
    demand = demand_nm * np.ones(4)
    for _ in range(round(seconds / TICK_S)):
        in_force = answer.copy()
        silence = np.maximum(coach[0] - edges[:, 1], 1e-5)
        speeds = np.where(valid, np.minimum(edges[:, 2], PITCH_M / silence), 1e3)
        outside_mps = coach[1] if outside else math.nan
        answer = control.step(speeds, valid, demand_nm, outside_mps).copy()
        rows.append((*coach[:2], *rims, control.reference_speed_mps, *in_force))
        friction = mu0(coach[0]) if callable(mu0) else mu0
        advance(coach, rims, edges, in_force, demand, friction, slope, load_n, TICK_S / STEPS, STEPS)
    return Start(np.array(rows), coach[2] / coach[3])


class Off(AntiSkid):
    def step(self, *_: Any) -> np.ndarray:
        return np.full(4, DEMAND_NM)


RAILS: dict[str, dict[str, Any]] = {
    "0.03": {"mu0": 0.03},
    "0.05": {"mu0": 0.05},
    "0.08": {"mu0": 0.08},
    "0.12": {"mu0": 0.12},
    "20 permille uphill": {"mu0": 0.08, "slope": 0.02},
    "20 permille downhill": {"mu0": 0.05, "slope": -0.02},
    "waves": {"mu0": lambda t: 0.06 + 0.02 * math.sin(t)},
    "a sudden fall": {"mu0": lambda t: 0.12 if t < 15 else 0.04},
    "a sudden rise": {"mu0": lambda t: 0.04 if t < 15 else 0.3},
    "dry": {"mu0": 0.35},
    "reference from outside": {"mu0": 0.05, "outside": True},
    "one axle not seen": {"mu0": 0.05, "blind": (1,)},
}


@pytest.mark.parametrize("rail", RAILS)
def test_a_start_uses_most_of_the_adhesion_and_no_wheel_spins_away(rail: str) -> None:
    """Work of the wheels over that of peak adhesion times load, or of the demand where that is less."""
    run = start(**RAILS[rail])
    error = run.rows[:, 6] - run.rows[:, 1]
    seen = [i for i in range(4) if i not in RAILS[rail].get("blind", ())]
    slip = run.slip_mps[:, seen]
    print(
        f"{rail}: utilisation {run.utilisation:.3f}, {3.6 * run.rows[-1, 1]:.0f} km/h after 40 s, largest slip "
        f"{slip.max():.2f} m/s, 95 % below {np.quantile(slip, 0.95):.2f}, reference within {np.abs(error).max():.2f}"
    )
    assert run.utilisation > 0.88
    assert slip.max() < 2.0
    assert np.quantile(slip, 0.95) < 0.8
    assert np.abs(error).max() < 0.6


def test_without_it_the_wheels_spin_away() -> None:
    run = start(0.05, control=Off(AntiSkidParameters(), TICK_S))
    assert run.slip_mps.max() > 100.0
    assert run.utilisation < 0.5


def test_dry_rail_gives_the_driver_what_is_demanded() -> None:
    run = start(0.35, seconds=20.0)
    assert run.rows[200:, 7:] == pytest.approx(DEMAND_NM)


def test_two_driven_axles_leave_the_others_alone() -> None:
    run = start(0.05, demand_nm=np.array([DEMAND_NM, 0.0, DEMAND_NM, 0.0]))
    assert np.abs(run.rows[:, [8, 10]]).max() == 0.0
    assert run.utilisation > 0.88


@pytest.mark.parametrize("mass_factor", [0.7, 1.4])
def test_a_mass_that_is_not_the_one_assumed_is_learnt(mass_factor: float) -> None:
    control = AntiSkid(AntiSkidParameters(mass_kg=mass_factor * MASS_KG), TICK_S)
    run = start(0.05, control=control)
    error = run.rows[:, 6] - run.rows[:, 1]
    print(f"{mass_factor}: utilisation {run.utilisation:.3f}, reference {error.min():+.2f}..{error.max():+.2f} m/s")
    assert run.utilisation > 0.85
    assert np.abs(error).max() < 0.6


def test_backwards_is_the_mirror_of_forwards() -> None:
    forward, backward = (AntiSkid(AntiSkidParameters(), TICK_S) for _ in range(2))
    valid = np.ones(4, np.bool_)
    rng = np.random.default_rng(1)
    for tick in range(500):
        speeds = 0.005 * tick + np.abs(rng.normal(0.0, 0.1, 4))
        ahead = forward.step(speeds, valid, 5000.0).copy()
        np.testing.assert_array_equal(backward.step(-speeds, valid, -5000.0), -ahead)
    assert ahead.min() > 0.0


def test_torque_stays_between_nothing_and_the_demand_whatever_is_read() -> None:
    control = AntiSkid(AntiSkidParameters(), TICK_S)
    rng = np.random.default_rng(2)
    for tick in range(3000):
        speeds = rng.choice([0.0, 5.0, 50.0, -3.0, np.nan, 1e3], 4)
        demand = rng.uniform(0.0, 9000.0, 4) if tick % 7 else np.zeros(4)
        torque = control.step(speeds, rng.random(4) < 0.8, demand, 5.0 if tick % 3 == 0 else np.nan)
        assert np.all((torque >= 0.0) & (torque <= demand))
        assert math.isfinite(control.reference_speed_mps)


def test_blind_on_all_axles_nothing_is_driven() -> None:
    control = AntiSkid(AntiSkidParameters(), TICK_S)
    for _ in range(200):
        torque = control.step(np.zeros(4), np.zeros(4, np.bool_), 5000.0)
    np.testing.assert_array_equal(torque, 0.0)


def test_reset_forgets() -> None:
    used, fresh = (AntiSkid(AntiSkidParameters(), TICK_S) for _ in range(2))
    start(0.05, seconds=5.0, control=used)
    used.reset()
    np.testing.assert_array_equal(start(0.05, 5.0, control=used).rows, start(0.05, 5.0, control=fresh).rows)


@pytest.mark.parametrize("demand", [np.array([1.0, -1.0, 0.0, 0.0]), math.nan, math.inf])
def test_demands_of_no_sense_are_refused(demand: Any) -> None:
    with pytest.raises(ValueError, match="demand_nm = .*finite torques of one sign"):
        AntiSkid(AntiSkidParameters(), TICK_S).step(np.zeros(4), np.ones(4, np.bool_), demand)


@pytest.mark.parametrize("period_s", [0.0, -0.01, math.nan])
def test_a_period_must_be_positive(period_s: float) -> None:
    with pytest.raises(ValueError, match="period_s"):
        AntiSkid(AntiSkidParameters(), period_s)
