"""A slide bench: four wheelsets under a point mass on slippery rail, to try a controller on the brake plant.

The rail is Polach's `low` curve on CONTACT's ellipse scaled to 68.7 kN a wheel; its friction is scaled so that the peak
at 100 km/h is the one asked for at the place. Axle loads differ by place in the bogie and swing with the body's pitch.
Tachometers have 100 teeth with pitch errors and eccentricity, edges are timed to 1 us; the link latches by one tick.
"""

import tomllib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numba import njit

from wsp import BRAKE_PRESETS, FILL, Brake, BrakeParameters

GRAVITY_MPS2 = 9.81
MASS_KG = 56_000.0
RADIUS_M = 0.46
INERTIA_KGM2 = 110.0
LOAD_SHARE = np.array([1.03, 0.98, 1.02, 0.97])
LOAD_SWING, SWING_HZ = 0.01, 1.2
RESISTANCE_NPKG = 0.0125  # 1.25 daN/t
TEETH = 100
FALL_A, FALL_B_SPM, K_A, K_S = 0.40, 0.20, 1.0, 0.40
# G pi a b c11 / 4 of the ellipse 6.304 x 12.61 mm at 106.7 kN
STIFFNESS_N = 0.25 * 82e9 * np.pi * 6.304e-3 * 12.61e-3 * 3.7335 * (68.7 / 106.7) ** (2 / 3)


@njit(cache=True)
def utilised_adhesion(creep: float, speed_mps: float, mu0: float, wheel_load_n: float) -> float:
    mu = mu0 * ((1 - FALL_A) * np.exp(-FALL_B_SPM * creep * speed_mps) + FALL_A)
    eps = STIFFNESS_N * creep / (wheel_load_n * mu)
    return 2 * mu / np.pi * (K_A * eps / (1 + (K_A * eps) ** 2) + np.arctan(K_S * eps))


@njit(cache=True)
def peak_adhesion(speed_mps: float, mu0: float, wheel_load_n: float) -> float:
    best = 0.0
    creep = 1e-3
    while creep < 0.3:
        best = max(best, utilised_adhesion(creep, speed_mps, mu0, wheel_load_n))
        creep *= 1.1
    return best


PEAK_PER_MU0 = peak_adhesion(100 / 3.6, 0.06, 68.7e3) / 0.06


@njit(cache=True)
def rim_after(rim: float, speed: float, torque_nm: float, mu0: float, load_n: float, step_s: float):
    """Rim speed after a step (linearly implicit: the contact is stiff at small creep) and the mean brake force."""
    gain = RADIUS_M / INERTIA_KGM2 * step_s / 2
    force = 0.0
    for _ in range(2):
        sign = 1.0 if speed >= rim else -1.0
        reference = max(speed, rim, 0.1)
        creep = abs(speed - rim) / reference
        adhesion = utilised_adhesion(creep, reference, mu0, load_n / 2)
        slope = max(0.0, utilised_adhesion(creep + 1e-5, reference, mu0, load_n / 2) - adhesion)
        slope *= load_n / (1e-5 * reference)
        change = gain * (sign * load_n * adhesion * RADIUS_M - torque_nm) / (1 + gain * RADIUS_M * slope)
        change = max(change, -rim)
        rim += change
        force += 0.5 * (sign * load_n * adhesion - slope * change)
    return rim, force


@njit(cache=True)
def advance(coach, rims, torque_nm, mu0: float, gradient: float, step_s: float):
    """One step. coach: time, position, speed, slid (0/1), work of the brake forces, work of the peak adhesion (J)."""
    speed = coach[2]
    total = 0.0
    possible = 0.0
    swing = LOAD_SWING * np.sin(2 * np.pi * SWING_HZ * coach[0])
    for i in range(4):
        load = MASS_KG * GRAVITY_MPS2 / 4 * (LOAD_SHARE[i] + (swing if i < 2 else -swing))
        rims[i], force = rim_after(rims[i], speed, torque_nm[i], mu0, load, step_s)
        total += force
        possible += load * peak_adhesion(speed, mu0, load / 2)
        if speed - rims[i] > 0.03 * speed:
            coach[3] = 1.0
    coach[2] = speed - (total / MASS_KG + RESISTANCE_NPKG + GRAVITY_MPS2 * gradient) * step_s
    coach[1] += 0.5 * (speed + coach[2]) * step_s
    coach[0] += step_s
    if coach[3] > 0 and speed > 10 / 3.6:
        coach[4] += total * speed * step_s
        coach[5] += possible * speed * step_s


@njit(cache=True)
def count_edges(edges, teeth, time_s: float, step_s: float, before, rims):
    """edges (4, 4): angle in pitches, time of the newest edge, edges since the last reading, edge time read last."""
    for i in range(4):
        start = edges[i, 0]
        end = start + 0.5 * (before[i] + rims[i]) * step_s / (2 * np.pi * RADIUS_M) * TEETH
        for k in range(int(start) - 1, int(end) + 3):
            position = k + teeth[i, k % TEETH]
            if start < position <= end:
                edges[i, 1] = 1e-6 * np.rint(1e6 * (time_s + step_s * (position - start) / (end - start)))
                edges[i, 2] += 1
        edges[i, 0] = end


@njit(cache=True)
def read_speeds(speeds, edges, wheel_share, now_s: float):
    """Edges of the tick over the time they took; without one bounded by the silence, and zero after half a second."""
    for i in range(4):
        pitch = 2 * np.pi * RADIUS_M / TEETH * wheel_share[i]
        if edges[i, 2] > 0:
            speeds[i] = edges[i, 2] * pitch / (edges[i, 1] - edges[i, 3])
            edges[i, 3] = edges[i, 1]
            edges[i, 2] = 0
        else:
            silence = now_s - edges[i, 3]
            speeds[i] = min(speeds[i], pitch / max(silence, 1e-3)) if silence < 0.5 else 0.0


@dataclass
class Stop:
    """What came out; ticks: time, position, speed, 4 rims, reference, 4 cylinder pressures, 4 commands."""

    utilisation: float
    longest_lock_s: float
    reference_rms_mps: float
    distance_m: float
    air_nl: float
    ticks: np.ndarray


def stop_coach(
    controller,
    parameters: BrakeParameters,
    peak: Callable[[float], float],
    *,
    speed_kmh: float = 120.0,
    step_s: float = 0.0025,
    demand: float = 1.0,
    pitch_error: float = 0.007,
    wheel_share: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0),
    seed: int = 1,
    gradient: Callable[[float], float] = lambda _: 0.0,
) -> Stop:
    """Roll for one second, then brake to standstill (300 s at most); peak(position) is the adhesion asked for,
    gradient(position) the sine of the slope, positive uphill."""
    rng = np.random.default_rng(seed)
    brake = Brake(parameters, step_s)
    coach = np.array([0.0, 0.0, speed_kmh / 3.6, 0.0, 0.0, 0.0])
    rims = np.full(4, coach[2])
    turn = 2 * np.pi * np.arange(TEETH) / TEETH
    teeth = pitch_error * rng.standard_normal((4, TEETH)) + 0.02 * np.sin(turn + rng.uniform(0, 2 * np.pi, (4, 1)))
    edges = np.zeros((4, 4))
    edges[:, 0] = rng.uniform(1, TEETH, 4)
    share = np.asarray(wheel_share)
    speeds = rims * share
    valve = np.full(4, FILL, np.int8)
    answer = valve.copy()
    valid = np.ones(4, np.bool_)
    lock = np.zeros(4)
    longest = 0.0
    rows = []
    steps_per_tick = round(controller.period_s / step_s)
    controller.reset(0.0, 1)
    step = 0
    while coach[2] > 0.3 and coach[0] < 300:
        applied = demand if coach[0] >= 1.0 else 0.0
        if step % steps_per_tick == 0:
            valve = answer
            if step:
                read_speeds(speeds, edges, share, coach[0])
            output = controller.step(coach[0], speeds, valid, applied, 1, np.nan)
            answer = output.valve.copy()
            rows.append((*coach[:3], *rims, output.reference_speed_mps, *brake.cylinder_pressure_bar, *answer))
        torque = brake.step(applied, valve, rims / RADIUS_M, coach[2])
        before, time_s = rims.copy(), coach[0]
        advance(coach, rims, torque, peak(coach[1]) / PEAK_PER_MU0, gradient(coach[1]), step_s)
        count_edges(edges, teeth, time_s, step_s, before, rims)
        if coach[2] > 30 / 3.6:
            lock = np.where(rims < 0.05 * coach[2], lock + step_s, 0.0)
            longest = max(longest, lock.max())
        step += 1
    ticks = np.array(rows)
    sliding = (ticks[:, 2] > 10 / 3.6) & (ticks[:, 0] > 1.0)
    error = ticks[sliding, 7] - ticks[sliding, 2]
    utilisation = coach[4] / coach[5] if coach[5] > 0 else np.nan
    return Stop(utilisation, longest, float(np.sqrt(np.mean(error**2))), coach[1], brake.air_nl, ticks)


@pytest.fixture(scope="session")
def presets() -> dict[str, BrakeParameters]:
    """All brake presets by name."""
    return {
        name: BrakeParameters.model_validate(tomllib.loads(path.read_text())) for name, path in BRAKE_PRESETS.items()
    }


@pytest.fixture(scope="session")
def coach_brake(presets: dict[str, BrakeParameters]) -> BrakeParameters:
    """The preset of the 56 t coach."""
    return presets["lhb-discs-56t"]


@pytest.fixture(scope="session")
def slide_bench() -> Callable[..., Stop]:
    """The bench: stop_coach(controller, brake parameters, peak adhesion by position, ...) -> Stop."""
    return stop_coach
