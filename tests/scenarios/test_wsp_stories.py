"""The scenarios of the textbook pictures of wheel slide protection tell their stories, and who brakes best."""

import numpy as np
import pytest

from scenarios.cosimulation.simulation import simulate
from scenarios.metrics import stop_metrics
from scenarios.scenario_file import load_scenario
from scenarios.truth import Truth
from wsp import VENT


def run(name: str, *settings: str) -> Truth:
    return simulate(load_scenario(name, settings), lambda *_: None, lambda: False)


def test_typical_low_adhesion_holds_15_percent_of_slip() -> None:
    truth = run("typical-low-adhesion", "simulation.longest_s=65")
    speed = truth.motion.speed_mps
    rows = truth.motion.t_s > 48.0
    slip = truth.wheelsets.slip[rows]
    assert np.median(slip) == pytest.approx(0.15, abs=0.02)
    assert 0.11 < slip.mean() < 0.17
    # brief excursions of single axles: one comes up to the train's speed while the others go on sliding
    up = slip < 0.03
    assert 0.03 < up.any(axis=1).mean() < 0.6
    assert (up.sum(axis=1) <= 2).mean() > 0.98
    assert np.abs(truth.brake.reference_speed_mps - speed)[rows].max() < 1.0
    assert truth.wheelsets.rim_speed_mps[rows].min() > 0.3 * speed[rows].min()


def test_without_release_all_axles_lock_unseen() -> None:
    """At about 25 s; the reference has gone down with them, more than 25 m/s below the train."""
    truth = run("all-axles-locked", "simulation.longest_s=32")
    locked = (truth.wheelsets.rim_speed_mps < 0.05 * truth.motion.speed_mps[:, None]).all(axis=1)
    locked_s = truth.motion.t_s[np.flatnonzero(locked)[0]]
    assert locked_s == pytest.approx(25.0, abs=1.0)
    assert locked[truth.motion.t_s > locked_s].all()
    error = truth.brake.reference_speed_mps - truth.motion.speed_mps
    assert error[-1] < -25.0
    assert error[truth.motion.t_s < 10.0].min() > -0.1
    braked = truth.motion.t_s > 12.0
    worst_slip = (truth.brake.reference_speed_mps[:, None] - truth.wheelsets.rim_speed_mps)[braked].max()
    assert worst_slip < 0.1 * truth.motion.speed_mps[0]  # what the controller sees


def test_releases_correct_the_reference() -> None:
    truth = run("axle-release", "simulation.longest_s=70")
    brake, t_s = truth.brake, truth.motion.t_s
    error = brake.reference_speed_mps - truth.motion.speed_mps
    empty = (brake.cylinder_pressure_bar < 0.02) & (brake.valve > 0) & (t_s > 13.0)[:, None]
    starts = [
        (t_s[k], axle)
        for axle in range(4)
        for k in np.flatnonzero(np.diff(empty[:, axle].astype(int)) > 0)
        if empty[k + 1 : k + 40, axle].all()
    ]
    starts.sort()
    print("releases:", [(round(float(t), 1), axle + 1) for t, axle in starts])
    axles = [axle for _, axle in starts]
    assert axles[:4] == [0, 1, 2, 3]
    for t, axle in starts[:4]:
        before = error[np.searchsorted(t_s, t - 0.5)]
        after = error[(t_s > t) & (t_s < t + 5.0)].max()
        assert before < -1.0
        assert after > -0.4
        assert (brake.valve[np.searchsorted(t_s, t - 0.05), axle]) == VENT
    assert not (truth.wheelsets.rim_speed_mps < 0.05 * truth.motion.speed_mps[:, None]).any()


RAILS = {
    "low": ('adhesion.stretches=[{from_m=0.0, surface="low", peak_adhesion=0.05}]',),
    "recovering": ('adhesion.stretches=[{from_m=0.0, recovery="low-recovering", peak_adhesion=0.05}]',),
    "patches": (
        'adhesion.stretches=[{from_m=0.0, surface="low", peak_adhesion=0.08}]',
        'adhesion.patches=[{surface="low", peak_adhesion=0.05, from_m=300.0, to_m=2000.0, spacing_m=120.0, '
        "length_m=60.0}]",
    ),
}


@pytest.mark.parametrize("rail", RAILS)
def test_adaptive_brakes_better_than_the_rule_table(rail: str) -> None:
    """From 100 km/h, unbraked for a second before: a shorter stop with less air."""
    settings = (
        "simulation.initial_speed_kmh=100",
        "simulation.initial_position_m=250",
        "track.curves=[]",
        'driver.phases=[{from_m=0.0, action="coast"}, {from_m=300.0, action="brake", demand=1.0}]',
        *RAILS[rail],
    )
    stops = {}
    for name in ("rule-table", "adaptive"):
        truth = run("low-adhesion-stop", *settings, f"wsp.controller={name}")
        stops[name] = stop_metrics(truth, None)
        locked = truth.wheelsets.rim_speed_mps < 0.05 * truth.motion.speed_mps[:, None]
        assert not locked[truth.motion.speed_mps > 30 / 3.6].any()
    distance = {name: stop.distance_m for name, stop in stops.items()}
    air = {name: stop.air_nl for name, stop in stops.items()}
    print(rail, distance, air)
    assert distance["adaptive"] is not None
    assert distance["rule-table"] is not None
    assert distance["adaptive"] < distance["rule-table"]
    assert air["adaptive"] < 0.7 * air["rule-table"]
