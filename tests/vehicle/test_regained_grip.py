"""A wheelset that has slid far beyond the peak regains its grip without ringing from step to step."""

import numpy as np
import pytest

from tests.vehicle.conftest import MakeBench
from vehicle import OBSERVATION, Actuation, CoachState

SLIDING_NM, ROLLING_NM = 30_000.0, 700.0  # per wheelset: beyond the adhesion of dry rail, and far below it


@pytest.mark.parametrize("speed_mps", [15.0, 4.0])
def test_regained_grip_does_not_ring(make_bench: MakeBench, speed_mps: float) -> None:
    """Brakes that are too strong for dry rail for a moment, then weak: soon the rails carry what the brakes ask for.

    With the tangents of saturated creep alone the force goes on jumping between both ends of the curve, by 97 kN.
    """
    bench = make_bench(0.3, "dry")
    rows = np.zeros(900, OBSERVATION)
    actuation = Actuation()
    count = 0

    def on_step(t_s: float, state: CoachState) -> Actuation:
        nonlocal count
        state.observe(t_s, rows, count)
        count += 1
        actuation.brake_torque_nm[:] = SLIDING_NM if 0.5 < t_s < 0.65 else ROLLING_NM
        return actuation

    bench.rail.state[:] = 0.0
    bench.coach.run(0.005, 4.0, 200.0, speed_mps, on_step, 0.005)
    seen = rows[:count]
    force = seen["longitudinal_force_n"].reshape(-1, 4, 2).sum(axis=2)
    slid = (seen["wheelset_speed_mps"] - seen["rim_speed_mps"]).max(axis=0)
    assert (slid > 0.1).all()
    after = seen["t_s"] > 1.5
    jumps = np.abs(np.diff(force[after], axis=0)).max()
    print(f"largest slip {slid.max():.2f} m/s; force jumps by up to {jumps:.0f} N in a step afterwards")
    assert jumps < 500.0
    assert np.abs(force[after].mean(axis=0) + ROLLING_NM / 0.46).max() < 200.0
