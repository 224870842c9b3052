"""The suspension's forces in lanes, against the same law written out element by element."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.vehicle.conftest import MakeBench, coach_of
from vehicle import COACH_PRESETS
from vehicle.forces import SUSPENSION, forces_by_class
from vehicle.layout import first_coordinate
from vehicle.pairs import SLOT
from vehicle.start import start_state
from wheel_rail.lanes import LANES


def on_curve(coach: np.void, number: int, x: float) -> float:
    if number < 0:
        return 0.0
    side = 0 if x >= 0.0 else 1
    points = coach["curve_points"][number, side]
    at, force = coach["curve_x"][number, side, :points], coach["curve_force"][number, side, :points]
    beyond = max(abs(x) - at[-1], 0.0) * coach["curve_slope"][number, side, points - 1]
    return float(np.copysign(np.interp(abs(x), at, force) + beyond, x))


def element_forces(coach: np.void, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Sum over the elements, each with its own points, arms and rotations."""
    f = np.zeros_like(q)
    axes, at = {}, {}
    for body in range(coach["bodies"]):
        at[body] = first_coordinate(body)
        turn = Rotation.from_rotvec(q[at[body] + 3 : at[body] + 6])
        axes[body] = (Rotation.from_quat(coach["attitude"][:, body], scalar_first=True) * turn).as_matrix()
    for e in range(coach["elements"]):
        u, w = int(coach["upper"][e]), int(coach["lower"][e])
        pu, pw = slice(at[u], at[u] + 3), slice(at[w], at[w] + 3)
        tu, tw = slice(at[u] + 3, at[u] + 6), slice(at[w] + 3, at[w] + 6)
        arm = axes[w] @ coach["lower_point"][e]
        reach = q[pw] + arm - q[pu]
        turning_u, turning_w = axes[u] @ v[tu], axes[w] @ v[tw]
        rate = v[pw] + np.cross(turning_w, arm) - v[pu] - np.cross(turning_u, reach)
        deflection, speed = axes[u].T @ reach - coach["upper_point"][e], axes[u].T @ rate
        own = coach["stiffness"][e] * deflection + coach["damping"][e] * speed
        for axis in range(3):
            own[axis] += on_curve(coach, coach["stop"][e, axis], deflection[axis])
            own[axis] += on_curve(coach, coach["damper"][e, axis], speed[axis])
        own[2] += coach["preload"][e]
        force = axes[u] @ own
        between = axes[u].T @ axes[w]
        small = 0.5 * np.array(
            [between[2, 1] - between[1, 2], between[0, 2] - between[2, 0], between[1, 0] - between[0, 1]]
        )
        resists = coach["rotational_stiffness"][e] * small
        resists += coach["rotational_damping"][e] * (axes[u].T @ (turning_w - turning_u))
        f[pu] += force
        f[pw] -= force
        f[tu] += axes[u].T @ np.cross(reach, force) + resists
        f[tw] -= axes[w].T @ np.cross(arm, force) + axes[w].T @ axes[u] @ resists
    return f


@pytest.mark.parametrize("boxes", ["lumped", "explicit"])
@pytest.mark.parametrize("name", sorted(COACH_PRESETS))
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_forces_are_those_of_the_elements(make_bench: MakeBench, name: str, boxes: str, seed: int) -> None:
    """Deflections into the stops and speeds beyond the blow-offs, either way."""
    bench = make_bench(given=coach_of(name, axle_boxes=boxes))
    record, q, v = start_state(bench.parameters, bench.contact, bench.track, bench.rail, 100.0, 20.0)
    rng = np.random.default_rng(seed)
    q, v = q + rng.normal(0.0, 0.02, len(q)), v + rng.normal(0.0, 0.3, len(v))
    forces_by_class(q, v, record[0], bench.track.table, bench.rail)
    found, expected = record[0]["force"][SUSPENSION, : len(q)], element_forces(record[0], q, v)
    assert np.abs(found - expected).max() < 1e-11 * np.abs(expected).max()


def test_one_sided_curves_are_read_on_either_side(make_bench: MakeBench) -> None:
    """A stop that is near on one side only."""
    source = {"source": "test"}
    curve = {**source, "deflection_m": [-0.03, -0.02, 0.0, 0.001], "force_n": [-5e4, 0.0, 0.0, 2e4]}
    stop = {"height_m": 1.0, "stop": "one-sided"}
    parameters = coach_of("malvezzi-2014", **{"characteristics__one-sided": curve, "lateral_stop": stop})
    bench = make_bench(given=parameters)
    record, q, v = start_state(bench.parameters, bench.contact, bench.track, bench.rail, 100.0, 20.0)
    for aside in (-0.04, -0.01, 0.0, 0.002, 0.05):
        moved = q.copy()
        moved[1] += aside
        forces_by_class(moved, v, record[0], bench.track.table, bench.rail)
        expected = element_forces(record[0], moved, v)
        assert record[0]["force"][SUSPENSION, 1] == pytest.approx(expected[1], rel=1e-11, abs=1e-4), aside


@pytest.mark.parametrize("boxes", ["lumped", "explicit"])
@pytest.mark.parametrize("name", sorted(COACH_PRESETS))
def test_every_element_has_one_lane(make_bench: MakeBench, name: str, boxes: str) -> None:
    bench = make_bench(given=coach_of(name, axle_boxes=boxes))
    coach = start_state(bench.parameters, bench.contact, bench.track, bench.rail, 100.0, 20.0)[0][0]
    slots = coach["pair_slots"][: coach["batches"]]
    assert (slots[:, 1] >= slots[:, 0]).all()
    assert (slots[1:, 0] == slots[:-1, 1]).all()
    seated = coach["slot"][: slots[-1, 1]].transpose(0, 2, 1).reshape(-1, SLOT)
    rows = [
        np.concatenate([coach[field][e] for field in ("lower_point", "upper_point", "stiffness", "damping")])
        for e in range(coach["elements"]) if coach["pushes"][e]
    ]  # fmt: skip
    for row in rows:
        alike = sum(np.array_equal(row, other) for other in rows)
        assert np.count_nonzero((seated[:, :-1] == row).all(axis=1)) == alike
    assert len(rows) <= LANES * slots[-1, 1]
