"""The magnetic track brake: friction of each bogie's magnets on the rails."""

import numpy as np
import pytest

from tests.vehicle.conftest import MakeBench
from vehicle import OBSERVATION, POWERS, Actuation, CoachState

FORCE_N = 30_000.0


def test_a_track_brake_decelerates_like_its_force_over_the_effective_mass(make_bench: MakeBench) -> None:
    """Two bogies of 30 kN on dry rail, wheels rolling freely; the energy balance has its work."""
    bench = make_bench(0.3, "dry")
    rows = np.zeros(1300, OBSERVATION)
    actuation = Actuation()
    count = 0

    def on_step(t_s: float, state: CoachState) -> Actuation:
        nonlocal count
        state.observe(t_s, rows, count)
        count += 1
        actuation.track_brake_force_n[:] = FORCE_N if t_s > 1.0 else 0.0
        return actuation

    bench.coach.run(0.005, 12.0, 200.0, 30.0, on_step, 0.01)
    seen = rows[:count]
    late = (seen["t_s"] > 6.0) & (seen["t_s"] < 11.0)
    resistance = -seen["power_w"][:, POWERS.index("resistance")] / seen["speed_mps"]
    expected = -(2.0 * FORCE_N + resistance[late].mean()) / bench.parameters.effective_mass_kg
    slope = np.polyfit(seen["t_s"][late], seen["speed_mps"][late], 1)[0]
    print(f"deceleration {-slope:.5f}, force over effective mass {-expected:.5f} m/s2")
    assert slope == pytest.approx(expected, rel=0.002)

    work = np.trapezoid(seen["power_w"], seen["t_s"], axis=0)
    assert work[POWERS.index("track_brake")] < -1e6
    assert seen["kinetic_energy_j"][-1] - seen["kinetic_energy_j"][0] == pytest.approx(work.sum(), rel=0.002)


def test_a_track_brake_presses_on_no_wheel_but_pitches_the_bogie(make_bench: MakeBench) -> None:
    """Its force acts at the rails: the leading wheelset of each bogie gains load, the trailing one loses as much."""
    bench = make_bench(0.3, "dry")
    rows = np.zeros(1300, OBSERVATION)
    actuation = Actuation()
    actuation.track_brake_force_n[:] = FORCE_N
    count = 0

    def on_step(t_s: float, state: CoachState) -> Actuation:
        nonlocal count
        state.observe(t_s, rows, count)
        count += 1
        return actuation

    bench.coach.run(0.005, 12.0, 200.0, 30.0, on_step, 0.01)
    load = rows[count - 200 : count]["normal_force_n"].reshape(-1, 4, 2).sum(axis=2).mean(axis=0)
    weight_n = bench.parameters.mass_kg * 9.81
    assert load.sum() == pytest.approx(weight_n, rel=1e-3)
    assert load[:2].sum() > load[2:].sum()  # the body leans on the front bogie
    assert load[0] > load[1]
    assert load[2] > load[3]
