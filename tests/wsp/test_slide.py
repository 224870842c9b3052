"""The rule table at work on the slide bench: how much of the adhesion it uses, on several rails."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from wsp import CONTROLLERS, BrakeParameters


def build(name: str) -> Any:
    return CONTROLLERS[name](CONTROLLERS[name].Parameters())


def even(peak: float) -> Callable[[float], float]:
    return lambda _: peak


RAILS: dict[str, tuple[Callable[[float], float], dict[str, Any]]] = {
    "0.05": (even(0.05), {}),
    "0.06": (even(0.06), {"seed": 2}),
    "0.07": (even(0.07), {"step_s": 0.005}),
    "0.08": (even(0.08), {"seed": 3}),
    "0.06 from 200 km/h": (even(0.06), {"speed_kmh": 200.0, "step_s": 0.005}),
    "waves": (lambda x: 0.07 + 0.01 * np.sin(2 * np.pi * x / 150), {}),
    "drop from 0.15 to 0.05": (lambda x: 0.15 if x < 250 else 0.05, {}),
    "patches": (lambda x: 0.05 if (x // 60) % 2 else 0.08, {}),
    "rough tachometers": (even(0.06), {"pitch_error": 0.02}),
    "worn wheels": (even(0.06), {"wheel_share": (1.01, 0.99, 1.0, 0.995)}),
    "0.03": (even(0.03), {"step_s": 0.005}),
    "0.03 at half demand": (even(0.03), {"demand": 0.5, "step_s": 0.005}),
}


@pytest.mark.parametrize("rail", RAILS)
def test_adhesion_is_used_and_no_axle_locks(
    rail: str, coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    peak, conditions = RAILS[rail]
    stop = slide_bench(build("rule-table"), coach_brake, peak, **conditions)
    commands = stop.ticks[:, 12:16]
    changes = np.count_nonzero(np.diff(commands, axis=0))
    print(
        f"{rail}: utilisation {stop.utilisation:.3f}, longest lock {stop.longest_lock_s:.2f} s, reference rms "
        f"{stop.reference_rms_mps:.2f} m/s, {stop.distance_m:.0f} m, {stop.air_nl:.0f} Nl, {changes} valve changes"
    )
    assert stop.utilisation >= 0.80
    assert stop.longest_lock_s <= 0.4
    assert stop.reference_rms_mps < 0.5


def test_without_protection_the_axles_lock(coach_brake: BrakeParameters, slide_bench: Callable[..., Any]) -> None:
    stop = slide_bench(build("none"), coach_brake, even(0.06), step_s=0.005)
    assert stop.longest_lock_s > 10.0
    assert stop.utilisation < 0.6


@pytest.mark.parametrize(("speed_kmh", "pitch_error"), [(120.0, 0.007), (200.0, 0.007), (120.0, 0.014)])
def test_dry_rail_is_no_business_of_the_wsp(
    speed_kmh: float, pitch_error: float, coach_brake: BrakeParameters, slide_bench: Callable[..., Any]
) -> None:
    """The stop is as long as without it, and no valve moves above 10 km/h."""
    run = {"speed_kmh": speed_kmh, "pitch_error": pitch_error, "step_s": 0.005}
    stop = slide_bench(build("rule-table"), coach_brake, even(0.3), **run)
    without = slide_bench(build("none"), coach_brake, even(0.3), **run)
    assert not stop.ticks[stop.ticks[:, 2] > 10 / 3.6, 12:16].any()
    assert stop.distance_m == pytest.approx(without.distance_m, rel=2e-3)


def test_the_bench_stops_like_its_brake_force(coach_brake: BrakeParameters, slide_bench: Callable[..., Any]) -> None:
    """Between 90 and 20 km/h on dry rail: force over effective mass, plus the resistance."""
    stop = slide_bench(build("none"), coach_brake, even(0.3), step_s=0.005)
    rows = stop.ticks[(stop.ticks[:, 2] < 25.0) & (stop.ticks[:, 2] > 5.6)]
    found = (rows[0, 2] - rows[-1, 2]) / (rows[-1, 0] - rows[0, 0])
    # the friction at the mean speed of that stretch, 55 km/h, pads sliding at 8.2 m/s
    friction = 0.35 * (1.024 - 0.024 * (55 / 3.6 * 0.247 / 0.46) / 12.0)
    torque = 2 * friction * 2.17 * 0.0507 * 3.35e5 * 0.247
    expected = (4 * torque / 0.46 + 0.0125 * 56_000) / (56_000 + 4 * 110 / 0.46**2)
    assert found == pytest.approx(expected, rel=0.003)
