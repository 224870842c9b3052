"""Hunting: critical speeds, and whether runs agree on which side of them the coach is."""

import numpy as np
import pytest

from tests.vehicle.conftest import MakeBench
from vehicle import CoachParameters
from vehicle.hunting import growth_of, hunting_speed, hunting_speed_on_cones, profile_conicity, swing_after_kick, swings
from vehicle.linear import Linearisation, conical, polach_contact


def test_steeper_cones_hunt_earlier(parameters: CoachParameters) -> None:
    speeds = [hunting_speed_on_cones(parameters, conicity).speed_mps for conicity in (0.3, 0.4)]
    assert None not in speeds
    assert speeds == sorted(speeds, key=lambda speed: -(speed or 0.0))
    assert hunting_speed_on_cones(parameters, 0.02).speed_mps is None  # the bogies' wave is long and their mass far


def test_at_the_critical_speed_one_swing_neither_grows_nor_decays(parameters: CoachParameters) -> None:
    linearisation = Linearisation(conical(parameters, 0.3))
    found = hunting_speed(linearisation)
    assert found.speed_mps is not None
    first, *_ = swings(linearisation, found.speed_mps)
    assert abs(first.real) < 0.01
    assert found.conicity == pytest.approx(0.3)
    assert swings(linearisation, found.speed_mps - 1.0)[0].real < 0.0
    assert swings(linearisation, found.speed_mps + 1.0)[0].real > 0.0


def test_without_yaw_dampers_the_coach_hunts_earlier(parameters: CoachParameters) -> None:
    with_them = hunting_speed_on_cones(parameters, 0.3).speed_mps
    without = hunting_speed_on_cones(parameters.model_copy(update={"yaw_dampers": None}), 0.3).speed_mps
    assert with_them is not None
    assert without is not None
    assert without < 0.7 * with_them


def test_equivalent_conicity_of_profiles_and_cones(parameters: CoachParameters) -> None:
    """S1002 on UIC60 at 1:40, gauge 1435 mm, 3 mm: published 0.180 (the verification has it to 0.177)."""
    assert profile_conicity(parameters) == pytest.approx(0.18, abs=0.01)
    assert profile_conicity(conical(parameters, 0.07)) == 0.07


def test_growth_is_that_of_the_signal() -> None:
    t_s = np.linspace(0.0, 5.0, 2001)
    for rate in (-0.7, 0.4):
        wave = np.exp(rate * t_s)[:, None] * np.sin(40.0 * t_s[:, None] + np.array([0.0, 1.0]))
        assert growth_of(t_s, wave) == pytest.approx(rate, abs=0.02)


def test_runs_decay_below_the_critical_speed_and_grow_above(parameters: CoachParameters) -> None:
    """With Polach's law, profiles and all dampers, after a kick of a tenth of a milliradian."""
    found = hunting_speed(Linearisation(parameters, polach_contact(parameters)))
    assert found.speed_mps is not None
    ends = []
    for factor in (0.85, 1.15):
        t_s, swing = swing_after_kick(parameters, factor * found.speed_mps, heading_change_rad=1e-4, duration_s=4.0)
        ends.append(growth_of(t_s, swing))
        hertz = _frequency_hz(t_s, swing[:, 0])
    print(f"critical {found.speed_mps:.1f} m/s, growth {ends[0]:.2f} and {ends[1]:.2f} 1/s, {hertz:.1f} Hz")
    assert ends[0] < -0.3
    assert ends[1] > 0.3
    assert hertz == pytest.approx(found.frequency_hz, rel=0.15)


def _frequency_hz(t_s: np.ndarray, signal: np.ndarray) -> float:
    late = signal[len(signal) // 2 :]
    power = np.abs(np.fft.rfft(late - late.mean()))
    return float(np.fft.rfftfreq(len(late), t_s[1] - t_s[0])[np.argmax(power)])


def test_iterated_steps_are_those_of_the_program(make_bench: MakeBench) -> None:
    """On dry rail a braked run with Newton's iterations is the one with linearised steps, at small steps."""
    bench = make_bench(0.3, "dry")
    ends = []
    for newton in (False, True):
        rows, _ = bench.run(step_s=0.001, duration_s=2.0, speed_mps=20.0, brake=lambda t: 6000.0, newton=newton)
        ends.append((rows["position_m"][-1], rows["speed_mps"][-1]))
    assert ends[0][0] == pytest.approx(ends[1][0], abs=1e-3)
    assert ends[0][1] == pytest.approx(ends[1][1], abs=1e-3)
