"""The compiled suspension against a twin of the coach from Exudyn's own bodies and connectors."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.vehicle.connector_twin import Twin, places
from vehicle import CoachParameters
from vehicle.forces import GRAVITY, GYROSCOPIC, SUSPENSION, forces_by_class
from vehicle.layout import masses
from vehicle.linear import clean_rail, polach_contact
from vehicle.rotations import commit_attitudes
from vehicle.start import start_state
from wheel_rail import Track, TrackParameters

BODIES, PLACE_M = 7, 100.0
SUPPORT_NPM, SUPPORT_NSPM, SUPPORT_HALF_M = 2e7, 2e4, 0.75


@dataclass
class Compiled:
    """The compiled coach in the coordinates of the twin; its wheels stand on the twin's springs, not on rails."""

    parameters: CoachParameters

    def __post_init__(self) -> None:
        contact = polach_contact(self.parameters)
        self.track = Track(TrackParameters(length_m=200.0))
        self.rail = clean_rail(200.0, contact)
        self.record, self.q, self.v = start_state(self.parameters, contact, self.track, self.rail, PLACE_M, 0.0)
        self.centres = places(self.parameters) + np.array([PLACE_M, 0.0, 0.0])
        self.mass = masses(self.record[0])[:42]

    def put(self, q: np.ndarray, v: np.ndarray) -> None:
        coach = self.record[0]
        for i, (place, own) in enumerate(zip(q.reshape(7, 6), v.reshape(7, 6), strict=True)):
            self.q[6 * i : 6 * i + 3] = self.centres[i] + place[:3]
            coach["attitude"][:, i] = Rotation.from_rotvec(place[3:]).as_quat(scalar_first=True)
            coach["turned"][:, i] = self.q[6 * i + 3 : 6 * i + 6]
            self.v[6 * i : 6 * i + 6] = own

    def forces(self) -> np.ndarray:
        coach = self.record[0]
        forces_by_class(self.q, self.v, coach, self.track.table, self.rail)
        return np.asarray(coach["force"][[GRAVITY, SUSPENSION, GYROSCOPIC]].sum(axis=0)[:42])

    def supported(self) -> np.ndarray:
        """With the springs below the axle ends that `Twin` has."""
        f = self.forces()
        coach = self.record[0]
        for i in range(3, 7):
            at = slice(6 * i, 6 * i + 3)
            rotation = coach["rotation"][:, :, i]
            for side in (SUPPORT_HALF_M, -SUPPORT_HALF_M):
                arm = rotation @ np.array([0.0, side, 0.0])
                stretch = self.q[at] + arm - self.centres[i] - np.array([0.0, side, 0.0])
                rate = self.v[at] + np.cross(rotation @ self.v[6 * i + 3 : 6 * i + 6], arm)
                force = -SUPPORT_NPM * stretch - SUPPORT_NSPM * rate
                force[2] += self.parameters.static_wheel_load_n
                f[at] += force
                f[6 * i + 3 : 6 * i + 6] += rotation.T @ np.cross(arm, force)
        return f

    def swing(self, step_s: float, duration_s: float) -> None:
        """Runge and Kutta's fourth order; turns are taken up after each step."""
        for _ in range(round(duration_s / step_s)):
            q, v = self.q[:42].copy(), self.v[:42].copy()
            slopes = []
            for ahead in (0.0, 0.5, 0.5, 1.0):
                if slopes:
                    self.q[:42] = q + ahead * step_s * slopes[-1][0]
                    self.v[:42] = v + ahead * step_s * slopes[-1][1]
                slopes.append((self.v[:42].copy(), self.supported() / self.mass))
            for k, (array, start) in enumerate(((self.q, q), (self.v, v))):
                one, two, three, four = (slope[k] for slope in slopes)
                array[:42] = start + step_s / 6.0 * (one + 2.0 * two + 2.0 * three + four)
            commit_attitudes(self.q, self.record[0])


@pytest.fixture(scope="module")
def compiled(parameters: CoachParameters) -> Compiled:
    return Compiled(parameters)


def state(seed: int, size: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Random places, turns and velocities (42,): centimetres and degrees, where stops and blow-offs are at work."""
    rng = np.random.default_rng(seed)
    most = size * np.repeat([0.03, 0.02, 0.02, *[0.005] * 4], 6)
    return rng.uniform(-most, most), rng.uniform(-20.0 * most, 20.0 * most)


def test_forces_agree_at_random_states(parameters: CoachParameters, compiled: Compiled) -> None:
    """Forces and moments of all bodies, to rounding: far better than a two-thousandth."""
    twin = Twin(parameters)
    worst = 0.0
    for seed in range(20):
        q, v = state(seed)
        compiled.put(q, v)
        here, there = compiled.forces(), twin.forces(q, v)
        moment = np.arange(42) % 6 > 2
        for kind in (moment, ~moment):
            worst = max(worst, float(np.abs(here - there)[kind].max() / np.abs(there)[kind].max()))
    print(f"largest difference {worst:.1e} of the largest force or moment")
    assert worst < 1e-9


def test_nonlinear_characteristics_are_at_work(parameters: CoachParameters, compiled: Compiled) -> None:
    """The states of the comparison reach beyond the linear range: dampers past their blow-off, lateral stops closed."""
    coach = compiled.record[0]
    closed = blown = 0
    for seed in range(20):
        q, v = state(seed)
        compiled.put(q, v)
        free_m, blow_off_mps = (
            parameters.characteristics[name].over[1]
            for name in (*parameters.secondary.named(1, "stop"), *parameters.secondary.named(2, "damper"))
        )
        lateral = abs(q[1] - q[7]) > free_m
        fast = abs(v[2] - v[8]) > blow_off_mps
        closed, blown = closed + lateral, blown + fast
    assert coach["force"].any()
    assert closed >= 3
    assert blown >= 10


def test_free_swings_agree(parameters: CoachParameters, compiled: Compiled) -> None:
    """0.3 s after a push, on springs in the place of rails: places, turns and velocities of all bodies."""
    twin = Twin(parameters, SUPPORT_NPM, SUPPORT_NSPM)
    q, v = state(3, 0.5)
    q[18:] = 0.0
    v[18:] = 0.0
    compiled.put(q, v)
    compiled.swing(2e-3, 0.3)
    end_q, end_v = twin.run(q, v, 2e-3, 0.3)
    here = compiled.q[:42].reshape(7, 6)[:, :3] - compiled.centres
    there = end_q.reshape(7, 6)[:, :3]
    moved = np.abs(there - q.reshape(7, 6)[:, :3]).max()
    print(f"bodies moved by up to {moved:.3f} m; places differ by {np.abs(here - there).max():.1e} m")
    assert moved > 0.01
    assert np.abs(here - there).max() < 1e-5 * moved
    turns = Rotation.from_quat(compiled.record[0]["attitude"][:, :7].T, scalar_first=True).as_rotvec()
    assert np.abs(turns - end_q.reshape(7, 6)[:, 3:]).max() < 1e-6
    assert np.abs(compiled.v[:42] - end_v).max() < 1e-4 * np.abs(end_v).max()
