"""Explicit axle boxes against the lumped coach: low frequencies, static loads, a dry stop and a curve."""

import numpy as np
import pytest

from tests.vehicle.conftest import Bench, MakeBench, coach_of
from tests.vehicle.test_forces import forces_of_a_coach_at_rest, largest_error_of_the_jacobian
from vehicle import POWERS, CoachParameters
from vehicle.layout import first_coordinate
from vehicle.modes import Mode, undamped_modes
from wheel_rail.contact import NORMAL

FULL_BRAKE_NM = 6300.0
CURVE = {"start_m": 100.0, "transition_m": 100.0, "length_m": 600.0, "radius_m": 800.0, "cant_mm": 100.0}
LUMPED, EXPLICIT = coach_of(), coach_of(axle_boxes="explicit")


@pytest.fixture(scope="module")
def both(make_bench: MakeBench) -> tuple[Bench, Bench]:
    return make_bench(given=LUMPED, curves=[CURVE]), make_bench(given=EXPLICIT, curves=[CURVE])


def frequency_hz(modes: list[Mode], *motions: tuple[int, float]) -> float:
    """Of the mode that moves most like this: coordinates and their directions."""
    return max(modes, key=lambda mode: abs(sum(sign * mode.shape[k] for k, sign in motions))).frequency_hz


# bodies 0, 1, 2 begin at 0, 6, 12: y, z, roll, pitch, yaw are the second and the following coordinates
LOW = {
    "body bounce": [(2, 1.0)],
    "body pitch": [(4, 1.0)],
    "body yaw": [(5, 1.0)],
    "bogie bounce": [(8, 1.0), (14, 1.0)],
    "bogie bounce, out of phase": [(8, 1.0), (14, -1.0)],
    "bogie pitch": [(10, 1.0), (16, 1.0)],
}


def test_low_natural_frequencies_are_those_of_the_lumped_coach() -> None:
    lumped, explicit = undamped_modes(LUMPED), undamped_modes(EXPLICIT)
    found = {name: [frequency_hz(modes, *motions) for modes in (lumped, explicit)] for name, motions in LOW.items()}
    for k in range(5):  # lower and upper sway, yaw, bounce, pitch: everything below the bogies' modes
        found[f"mode {k + 1}"] = [modes[k].frequency_hz for modes in (lumped, explicit)]
    for name, (one, two) in found.items():
        print(f"{name}: {one:.4f} and {two:.4f} Hz, {100 * (two / one - 1):+.2f} %")
    assert all(two == pytest.approx(one, rel=0.02) for one, two in found.values())


@pytest.mark.parametrize("coach", [EXPLICIT, coach_of("manchester-1", axle_boxes="explicit")])
def test_nothing_moves_at_rest(make_bench: MakeBench, coach: CoachParameters) -> None:
    """Every body is carried where it stands, and each wheel bears an eighth."""
    record, _, _ = forces_of_a_coach_at_rest(make_bench(given=coach))
    assert record["report"][NORMAL] == pytest.approx(np.full(8, coach.static_wheel_load_n), rel=2e-3)
    for i in range(15):
        at = first_coordinate(i)
        without_creep = record["force"][[0, 1, 2], at + 2].sum()
        assert abs(without_creep) < 1e-6 * record["mass"][i] * 9.81


def test_jacobian_of_explicit_boxes_is_the_derivative_of_the_force(make_bench: MakeBench) -> None:
    assert largest_error_of_the_jacobian(make_bench(given=EXPLICIT), slip=0.3) < 0.1


def test_a_dry_stop_is_the_same(both: tuple[Bench, Bench]) -> None:
    """On the straight before and through the curve, at the usual step."""
    rows = [
        bench.run(duration_s=30.0, speed_mps=15.0, brake=lambda t: FULL_BRAKE_NM,
                  until=lambda state: state.speed_mps < 0.05)[0]
        for bench in both
    ]  # fmt: skip
    distance = [r["position_m"][-1] - r["position_m"][0] for r in rows]
    print("stops:", distance)
    assert distance[1] == pytest.approx(distance[0], rel=1e-3)
    loads = [r["normal_force_n"][400:1000].mean(axis=0) for r in rows]
    assert loads[1] == pytest.approx(loads[0], rel=0.01)


def through_a_curve(bench: Bench) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Mean wheel loads and lateral places in a canted curve, drag of its creep forces, and the speed at the end."""
    rows, _ = bench.run(duration_s=14.0, speed_mps=30.0, position_m=60.0)
    inside = rows[(rows["position_m"] > 350.0) & (rows["position_m"] < 480.0)]
    work = np.trapezoid(rows["power_w"], rows["t_s"], axis=0)
    gained = rows["kinetic_energy_j"][-1] - rows["kinetic_energy_j"][0]
    assert gained == pytest.approx(work.sum(), abs=0.01 * np.abs(work).sum())
    load, place_m = inside["normal_force_n"].mean(axis=0), inside["lateral_displacement_m"].mean(axis=0)
    return load, place_m, work[POWERS.index("creep")], rows["speed_mps"][-1]


def test_boxes_without_arms_make_no_difference_in_a_curve(make_bench: MakeBench) -> None:
    """The bearing is stiff and the springs act where they do in the lumped form."""
    found = [
        through_a_curve(make_bench(given=coach_of("manchester-1", axle_boxes=form), curves=[CURVE]))
        for form in ("lumped", "explicit")
    ]
    (load, place, creep, speed), (load_2, place_2, creep_2, speed_2) = found
    print("loads", load_2 / load - 1.0, "mm off", 1e3 * (place_2 - place), "drag", creep_2 / creep)
    assert load_2 == pytest.approx(load, rel=0.005)
    assert place_2 == pytest.approx(place, abs=2e-4)
    assert creep_2 == pytest.approx(creep, rel=0.05)
    assert speed_2 == pytest.approx(speed, rel=2e-4)


def test_arms_steer_the_wheelsets_a_little_in_a_curve(both: tuple[Bench, Bench]) -> None:
    """Their bushings guide the boxes from beside the axle, so that a lateral force turns the wheelset: lumped, that is
    lost. Loads are the same all the same, and the trailing wheelset runs within 1.5 mm."""
    (load, place, creep, speed), (load_2, place_2, creep_2, speed_2) = map(through_a_curve, both)
    print("loads", load_2 / load - 1.0, "mm off", 1e3 * (place_2 - place), "drag", creep_2 / creep)
    assert load_2 == pytest.approx(load, rel=0.02)
    assert place_2[[0, 2]] == pytest.approx(place[[0, 2]], abs=3e-4)
    assert place_2 == pytest.approx(place, abs=1.5e-3)
    assert speed_2 == pytest.approx(speed, rel=5e-4)
