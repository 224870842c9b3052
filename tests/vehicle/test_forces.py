"""The compiled force routine: statics, conservation laws and its Jacobian."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.vehicle.conftest import Bench, MakeBench
from vehicle.forces import GRAVITY, SUSPENSION, coach_force, forces_by_class
from vehicle.jacobian import coach_jacobian
from vehicle.layout import BODIES, SPIN
from vehicle.pairs import arrange_pairs
from vehicle.start import start_state
from wheel_rail.contact import NORMAL
from wheel_rail.contact_table import NODES, SLOPE


def at_rest(bench: Bench, speed_mps: float = 20.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Record, q and v of the coach standing in its suspension on level straight track, rolling."""
    return start_state(bench.parameters, bench.contact, bench.track, bench.rail, 100.0, speed_mps)


def test_static_wheel_loads(make_bench: MakeBench) -> None:
    """56 t on eight wheels: 68.67 kN each, and no body is pushed up or down."""
    bench = make_bench()
    coach, _, _ = forces_of_a_coach_at_rest(bench)
    slope = bench.contact.constants["table"][0, NODES // 2, SLOPE]
    vertical = coach["report"][NORMAL].reshape(4, 2) / np.sqrt(1.0 + slope**2)
    assert vertical == pytest.approx(np.full((4, 2), 68_670.0), rel=1e-6)
    for i in range(BODIES):
        weight = -coach["force"][GRAVITY, 6 * i + 2]
        without_creep = coach["force"][[GRAVITY, SUSPENSION, 2], 6 * i + 2].sum()
        assert abs(without_creep) < 1e-6 * weight


def disturbed(seed: int, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    q, v = q.copy(), v.copy()
    for i in range(BODIES):
        size = 0.02 if i < 3 else 1e-4
        q[6 * i : 6 * i + 6] += rng.uniform(-size, size, 6)
        v[6 * i : 6 * i + 6] += rng.uniform(-20 * size, 20 * size, 6)
    return q, v


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_suspension_conserves_momentum_and_angular_momentum(make_bench: MakeBench, seed: int) -> None:
    """Internal forces and their moments about the origin sum to zero in any state."""
    bench = make_bench()
    record, q, v = at_rest(bench)
    q, v = disturbed(seed, q, v)
    coach = record[0]
    forces_by_class(q, v, coach, bench.track.table, bench.rail)
    f = coach["force"][SUSPENSION]
    force, moment, size = np.zeros(3), np.zeros(3), 0.0
    for i in range(BODIES):
        at = 6 * i
        force += f[at : at + 3]
        in_world = coach["rotation"][:, :, i] @ f[at + 3 : at + 6]
        moment += np.cross(q[at : at + 3] - (100.0, 0.0, 0.0), f[at : at + 3]) + in_world
        size += np.abs(f[at : at + 3]).sum()
    assert np.abs(force).max() < 1e-10 * size
    assert np.abs(moment).max() < 1e-9 * size


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_springs_without_dampers_are_conservative(make_bench: MakeBench, seed: int) -> None:
    """Around a closed path in coordinate space the springs do no work (up to the quadrature's error)."""
    bench = make_bench()
    record, q, v = at_rest(bench, 0.0)
    coach = record[0]
    coach["damping"] = 0.0
    coach["rotational_damping"] = 0.0
    coach["damper"] = -1
    coach["rotational_stiffness"] = 0.0  # taken from half-angles, conservative only to second order
    arrange_pairs(coach)
    rng = np.random.default_rng(seed)
    one, two = (np.concatenate([rng.uniform(-0.005, 0.005, 18), np.zeros(28)]) for _ in range(2))
    # translations only: the generalised forces are then the gradient of the energy without further terms
    for i in range(3):
        one[6 * i + 3 : 6 * i + 6] = two[6 * i + 3 : 6 * i + 6] = 0.0
    work, size = 0.0, 0.0
    angles = np.linspace(0.0, 2.0 * np.pi, 201)
    for a in 0.5 * (angles[1:] + angles[:-1]):
        forces_by_class(q + one * np.cos(a) + two * np.sin(a), v, coach, bench.track.table, bench.rail)
        step = (-one * np.sin(a) + two * np.cos(a)) * (angles[1] - angles[0])
        work += coach["force"][SUSPENSION][: len(step)] @ step
        size += abs(coach["force"][SUSPENSION][: len(step)] @ step)
    assert abs(work) < 1e-6 * size


def forces_of_a_coach_at_rest(bench: Bench) -> tuple[np.void, np.ndarray, np.ndarray]:
    """The coach with its forces worked out in the state in which it starts, and that state."""
    record, q, v = at_rest(bench)
    forces_by_class(q, v, record[0], bench.track.table, bench.rail)
    return record[0], q, v


def largest_error_of_the_jacobian(bench: Bench, slip: float) -> float:
    """Against central differences of the whole force along the same directions, over the geometric mean of the
    diagonal elements; a bad share of the largest element fails at once."""
    record, q, v = at_rest(bench)
    v[SPIN : SPIN + 4] *= 1.0 - slip
    q[19] += 1e-3  # the first wheelset off centre
    record[0]["capacity"] = 1e4 if slip == 1.0 else 0.0
    factor_q, factor_v = 1.0, 400.0
    n = len(q)
    jacobian = np.empty((n, n))
    arguments = (record, bench.track.table, bench.rail)
    coach_force(q, v, np.empty(n), *arguments)
    coach_jacobian(q, v, factor_q, factor_v, record, jacobian)
    differences = np.empty_like(jacobian)
    step = 2e-8
    for j in range(n):
        columns = []
        for sign in (1.0, -1.0):
            moved_q, moved_v, f = q.copy(), v.copy(), np.empty(n)
            moved_q[j] += sign * step * factor_q
            moved_v[j] += sign * step * factor_v
            coach_force(moved_q, moved_v, f, *arguments)
            columns.append(f)
        differences[:, j] = -(columns[0] - columns[1]) / (2.0 * step)
    scale = np.sqrt(np.outer(np.abs(np.diag(differences)), np.abs(np.diag(differences)))) + 1e6
    assert np.abs(jacobian - differences).max() / np.abs(differences).max() < 0.02
    return float((np.abs(jacobian - differences) / scale).max())


@pytest.mark.parametrize(("slip", "tolerance"), [(0.0, 0.2), (0.01, 0.1), (0.3, 0.1), (1.0, 0.1)])
def test_jacobian_is_the_derivative_of_the_force(make_bench: MakeBench, slip: float, tolerance: float) -> None:
    """What is left out (see `vehicle.jacobian`) is below a tenth; of a rolling wheel, to whose small creepages spin and
    the difference of C11 and C22 matter most, below a fifth.
    """
    assert largest_error_of_the_jacobian(make_bench(), slip) < tolerance
