"""Curves: their sum, their sides, and dry friction in a moving coach."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.vehicle.conftest import MakeBench, coach_of
from tests.vehicle.test_forces import at_rest
from vehicle import POWERS
from vehicle.characteristics import Characteristic, summed
from vehicle.forces import SUSPENSION, forces_by_class

FRICTION = {"source": "test", "speed_mps": [0.0, 0.02, 1.0], "force_n": [0.0, 2_500.0, 2_500.0]}
RUBBING = coach_of(primary__vertical_friction="wedge", characteristics__wedge=FRICTION)


def value(halves: tuple[np.ndarray, np.ndarray], x: float) -> float:
    """The plain reading of a curve: straight lines, the last one continued."""
    at, force = halves[0 if x >= 0.0 else 1]
    k = min(max(int(np.searchsorted(at, abs(x))), 1), len(at) - 1)
    slope = (force[k] - force[k - 1]) / (at[k] - at[k - 1])
    return float(np.copysign(force[k - 1] + slope * (abs(x) - at[k - 1]), x))


@st.composite
def curves(draw: st.DrawFn) -> Characteristic:
    steps = st.lists(st.tuples(st.floats(1e-3, 0.1), st.floats(0.0, 1e4)), min_size=1, max_size=6)

    def side() -> tuple[list[float], list[float]]:
        x, force = zip(*draw(steps), strict=True)
        return list(np.cumsum(x)), list(np.cumsum(force))

    right = side()
    left = side() if draw(st.booleans()) else ([], [])
    return Characteristic(
        source="test",
        deflection_m=[-x for x in reversed(left[0])] + [0.0, *right[0]],
        force_n=[-f for f in reversed(left[1])] + [0.0, *right[1]],
    )


@given(st.lists(curves(), min_size=1, max_size=3), st.floats(-1.0, 1.0))
def test_a_sum_of_curves_is_the_sum_of_their_forces(given_curves: list[Characteristic], x: float) -> None:
    expected = sum(value(curve.halves(), x) for curve in given_curves)
    assert value(summed(given_curves), x) == pytest.approx(expected, rel=1e-9, abs=1e-6)


def test_a_stop_may_differ_in_compression_and_rebound(make_bench: MakeBench) -> None:
    """Body moved by 55 mm up or down: linear spring and the stop of that side, on four springs."""
    stop = {"source": "test", "deflection_m": [-0.05, -0.03, 0.0, 0.04, 0.05], "force_n": [-8e3, 0.0, 0.0, 0.0, 3e3]}
    bench = make_bench(given=coach_of(characteristics={**all_curves(), "secondary-vertical-stop": stop}))
    for moved_m, stop_n in ((-0.055, 3e3 * 1.5), (0.055, -8e3 * 1.25)):  # down is compression
        record, q, v = at_rest(bench, 0.0)
        q[2] += moved_m
        forces_by_class(q, v, record[0], bench.track.table, bench.rail)
        weight_n = bench.parameters.body.mass_kg * 9.81
        expected = weight_n - 4.0 * 340_000.0 * moved_m + 4.0 * stop_n
        assert record[0]["force"][SUSPENSION, 2] == pytest.approx(expected, rel=1e-6)


def all_curves() -> dict[str, object]:
    return {name: curve.model_dump(exclude_none=True) for name, curve in coach_of().characteristics.items()}


def test_lateral_stop_of_a_bogie_acts_at_its_height(make_bench: MakeBench) -> None:
    """Manchester's at 0.65 m: 45 mm off, 6,870 N a bogie beside the four springs, and its moment about the body."""
    bench = make_bench(given=coach_of("manchester-1"))
    record, q, v = at_rest(bench, 0.0)
    q[1] += 0.045
    forces_by_class(q, v, record[0], bench.track.table, bench.rail)
    force = record[0]["force"][SUSPENSION]
    springs = 4.0 * 160_000.0 * 0.045
    assert force[1] == pytest.approx(-springs - 2.0 * 6_870.0, rel=1e-6)
    # levers below the centre at 1.8 m; the springs' weight acts 45 mm to the right of it
    moment = -(springs * (1.8 - 0.8275) + 2.0 * 6_870.0 * (1.8 - 0.65)) - 32_000.0 * 9.81 * 0.045
    assert force[3] == pytest.approx(moment, rel=1e-6)


def test_dry_friction_takes_energy_and_does_not_chatter(make_bench: MakeBench) -> None:
    """A coach that brakes on the straight: friction dampers stick, slide and stick again."""
    accelerations = []
    for step_s in (0.005, 0.001):
        bench = make_bench(given=RUBBING)
        rows, _ = bench.run(
            step_s=step_s, duration_s=12.0, speed_mps=20.0, brake=lambda t: 6300.0 if int(t) % 4 < 2 else 0.0
        )
        assert np.trapezoid(rows["power_w"][:, POWERS.index("suspension")], rows["t_s"]) < 0.0
        work = np.trapezoid(rows["power_w"], rows["t_s"], axis=0)
        gained = rows["kinetic_energy_j"][-1] - rows["kinetic_energy_j"][0]
        assert gained == pytest.approx(work.sum(), abs=0.005 * np.abs(work).sum())
        load = rows["normal_force_n"][rows["t_s"] > 1.0]
        jumps = np.abs(np.diff(load, axis=0)).max()
        print(f"step {step_s}: wheel load jumps by up to {jumps:.0f} N in 5 ms")
        assert jumps < 2_500.0
        accelerations.append(rows["normal_force_n"][:, 0])
    difference = np.abs(accelerations[0] - accelerations[1])
    print(f"load of a wheel at 5 and 1 ms: rms difference {np.sqrt((difference**2).mean()):.0f} N")
    assert np.sqrt((difference**2).mean()) < 200.0
