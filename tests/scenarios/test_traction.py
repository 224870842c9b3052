"""Traction in the run: anti-skid at a start on slippery rail, its limits, and its memory."""

import numpy as np
import pytest
from pydantic import ValidationError

from scenarios.cosimulation.simulation import simulate
from scenarios.cosimulation.traction import Traction, TractionParameters
from scenarios.scenario_file import load_scenario
from scenarios.truth import Truth


def run(*settings: str) -> Truth:
    return simulate(load_scenario("slippery-start", settings), lambda *_: None, lambda: False)


def test_anti_skid_uses_the_rail_where_spinning_wheels_do_not() -> None:
    """Two driven wheelsets ask for thrice the adhesion: with control they use nearly all of it, without they spin."""
    ways = {}
    for anti_skid in ("true", "false"):
        truth = run(f"traction.anti_skid={anti_skid}", "simulation.longest_s=25")
        wheelsets, started = truth.wheelsets, truth.motion.t_s > 4.0
        load = wheelsets.normal_force_n.reshape(-1, 4, 2).sum(axis=2)[:, :2]
        offered = (wheelsets.peak_adhesion[:, :2] * load).sum(axis=1)[started]
        used = wheelsets.longitudinal_force_n[:, :4].sum(axis=1)[started]
        way = truth.motion.position_m[started]
        share = np.trapezoid(used, way) / np.trapezoid(offered, way)
        spin = (wheelsets.rim_speed_mps - wheelsets.speed_mps)[:, :2].max()
        print(f"anti-skid {anti_skid}: uses {share:.3f} of the adhesion, wheels up to {spin:.1f} m/s too fast")
        ways[anti_skid] = (share, spin, truth.motion.position_m[-1])
    assert ways["true"][0] > 0.9
    assert ways["true"][1] < 1.5
    assert ways["false"][1] > 20.0
    assert ways["true"][2] > 1.15 * ways["false"][2]


def test_traction_after_coasting_downhill_is_there_at_once() -> None:
    """What the anti-skid learnt before says nothing of a faster train: it begins anew."""
    truth = run(
        'adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]',
        "simulation.initial_speed_kmh=40",
        "track.gradients=[{from_m=100.0, gradient_permille=-25.0, rounding_m=50.0}]",
        'driver.phases=[{from_m=0.0, action="hold", speed_kmh=42.0}, {from_m=120.0, action="coast"}, '
        '{from_m=700.0, action="hold", speed_kmh=120.0}]',
        "track.length_m=3000",
        "simulation.longest_s=60",
    )
    begins = float(np.interp(700.0, truth.motion.position_m, truth.motion.t_s))
    later = (truth.motion.t_s > begins + 4.0) & (truth.motion.t_s < begins + 6.0)
    asked_nm = 60_000.0 * 0.46 / 2.0
    assert truth.wheelsets.drive_torque_nm[later, :2].min() > 0.95 * asked_nm
    assert (truth.wheelsets.drive_torque_nm[:, 2:] == 0.0).all()


def test_power_limits_the_force_of_a_fast_train() -> None:
    truth = run(
        'adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]',
        "simulation.initial_speed_kmh=100",
        'driver.phases=[{from_m=0.0, action="hold", speed_kmh=140.0}]',
        "traction.largest_power_kw=500",
        "simulation.longest_s=12",
    )
    power_w = truth.wheelsets.drive_torque_nm.sum(axis=1) * truth.wheelsets.rim_speed_mps.mean(axis=1) / 0.46
    assert power_w[-200:] == pytest.approx(500e3, rel=0.01)


def test_a_wheelset_is_driven_once() -> None:
    with pytest.raises(ValidationError, match="each wheelset once"):
        TractionParameters(driven_wheelsets=(1, 2, 2))


ALL_VALID = np.ones(4, np.bool_)


def test_force_becomes_torque_within_power_and_rim_speed() -> None:
    """F r/n each; P r/(n v) where that is less; nothing beyond the overspeed."""
    parameters = TractionParameters(
        driven_wheelsets=(1, 3, 4), largest_power_kw=300.0, largest_rim_speed_kmh=108.0, anti_skid=False
    )
    traction = Traction(parameters, 0.46, 0.01)
    traction.step(20_000.0, np.array([-5.0, 10.0, 25.0, 31.0]), ALL_VALID)
    assert traction.torque_nm == pytest.approx([20_000.0 * 0.46 / 3, 0.0, 300e3 / 25.0 * 0.46 / 3, 0.0])


def test_a_spinning_wheel_is_answered_a_tick_later_and_forgotten_at_rest() -> None:
    """The tick that shows a wheel far too fast still has the torque of before; after coasting all is given at once."""
    traction = Traction(TractionParameters(), 0.46, 0.01)
    fair_nm = 10_000.0 * 0.46 / 4
    even, spinning = np.full(4, 10.0), np.array([10.0, 14.0, 10.0, 10.0])
    for _ in range(30):
        traction.step(10_000.0, even, ALL_VALID)
    assert traction.torque_nm == pytest.approx(np.full(4, fair_nm))
    traction.step(10_000.0, spinning, ALL_VALID)
    assert traction.torque_nm == pytest.approx(np.full(4, fair_nm))
    traction.step(10_000.0, spinning, ALL_VALID)
    assert traction.torque_nm[1] < 0.9 * fair_nm
    assert traction.torque_nm[[0, 2, 3]] == pytest.approx(fair_nm)
    for _ in range(3):
        traction.step(0.0, even, ALL_VALID)
    assert not traction.torque_nm.any()
    for _ in range(2):
        traction.step(10_000.0, even + 5.0, ALL_VALID)
    fresh = Traction(TractionParameters(), 0.46, 0.01)
    for _ in range(2):
        fresh.step(10_000.0, even + 5.0, ALL_VALID)
    assert np.array_equal(traction.torque_nm, fresh.torque_nm)


def test_a_force_that_is_not_finite_is_refused() -> None:
    with pytest.raises(ValueError, match="force_n = nan"):
        Traction(TractionParameters(), 0.46, 0.01).step(np.nan, np.full(4, 10.0), ALL_VALID)
