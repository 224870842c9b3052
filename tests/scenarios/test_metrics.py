"""Metrics against runs written down by formula, whose figures are known in closed form."""

import math
from typing import Any

import numpy as np
import pytest

from estimators.interface import EstimateStream
from scenarios.metrics import (
    estimator_errors,
    estimator_metrics,
    metrics_tree,
    stop_metrics,
    wheelset_metrics,
)
from scenarios.truth import Truth
from sensors.readings import BaliseReadings

NO_BALISES = BaliseReadings(t_s=[], position_m=[])


def estimate_of(
    truth: Truth, stream_of: Any, speed_error_mps: Any, position_error_m: Any, period_s: float = 0.1
) -> Any:
    """An estimator that is off by the given amounts (functions of time)."""
    motion = truth.motion
    t_s = period_s * np.arange(math.floor(motion.t_s[-1] / period_s) + 1)
    return stream_of(
        EstimateStream,
        len(t_s),
        t_s=t_s,
        speed_mps=np.interp(t_s, motion.t_s, motion.speed_mps) + speed_error_mps(t_s),
        position_m=np.interp(t_s, motion.t_s, motion.position_m) + position_error_m(t_s),
        gradient_permille=np.nan,
    )


def test_stopping_distance_runs_from_demand_to_standstill(make_truth: Any) -> None:
    truth = make_truth(initial_speed_mps=30.0, deceleration_mps2=0.75)
    stop = stop_metrics(truth, 512.5)
    assert stop.distance_m == pytest.approx(30.0**2 / (2 * 0.75), abs=0.01)
    assert stop.shortest_distance_m == 512.5
    assert stop.air_nl == pytest.approx(100.0)


def test_stop_begins_with_the_last_application(make_truth: Any, changed: Any) -> None:
    truth = make_truth(brake_at_s=10.0)
    demand = truth.brake.demand.copy()
    demand[(truth.brake.t_s > 2.0) & (truth.brake.t_s < 4.0)] = 0.5  # an earlier application, released again
    stop = stop_metrics(changed(truth, brake=changed(truth.brake, demand=demand)), None)
    assert stop.distance_m == pytest.approx(600.0, abs=0.01)


def test_a_run_that_does_not_stop_has_no_stopping_distance(make_truth: Any, changed: Any) -> None:
    whole = make_truth()
    rows = slice(0, len(whole.motion) // 2)
    truth = changed(
        whole,
        motion=whole.motion.rows(rows),
        wheelsets=whole.wheelsets.rows(rows),
        brake=whole.brake.rows(rows),
        solve=changed(whole.solve, ended="time"),
    )
    stop = stop_metrics(truth, 500.0)
    assert (stop.distance_m, stop.shortest_distance_m, stop.adhesion_utilisation) == (None, None, None)
    assert stop.air_nl > 0.0


def test_coasting_to_a_halt_without_demand_is_no_stop(make_truth: Any, changed: Any) -> None:
    truth = make_truth()
    unbraked = changed(truth, brake=changed(truth.brake, demand=np.zeros(len(truth.brake))))
    assert stop_metrics(unbraked, 1.0).distance_m is None


@pytest.mark.parametrize("used_share", [0.3, 0.8, 1.0])
def test_adhesion_utilisation_is_the_share_used(make_truth: Any, used_share: float) -> None:
    assert stop_metrics(make_truth(used_share=used_share), None).adhesion_utilisation == pytest.approx(used_share)


def test_adhesion_utilisation_weighs_by_distance_between_first_slide_and_10_kmh(make_truth: Any, changed: Any) -> None:
    """Half the adhesion over the first 100 m after the first slide, all of it afterwards, garbage outside the span."""
    truth = make_truth(initial_speed_mps=30.0, deceleration_mps2=0.75, brake_at_s=10.0)
    motion, wheelsets = truth.motion, truth.wheelsets
    begin_m, end_m = 300.0 + 50.0, 300.0 + (30.0**2 - (10.0 / 3.6) ** 2) / 1.5
    slip = np.where(motion.position_m >= begin_m, 0.1, 0.029)[:, None]
    share = np.where(motion.position_m < begin_m + 100.0, 0.5, 1.0)
    share[(motion.position_m < begin_m) | (motion.position_m > end_m + 0.2)] = 40.0
    force = -(share * 0.08 * 68_670.0)[:, None]
    changed_wheelsets = changed(
        wheelsets,
        slip=np.broadcast_to(slip, wheelsets.slip.shape),
        longitudinal_force_n=np.broadcast_to(force, wheelsets.longitudinal_force_n.shape),
    )
    expected = 1.0 - 0.5 * 100.0 / (end_m - begin_m)
    found = stop_metrics(changed(truth, wheelsets=changed_wheelsets), None).adhesion_utilisation
    assert found == pytest.approx(expected, abs=2e-3)


def test_without_a_slide_there_is_no_utilisation(make_truth: Any) -> None:
    assert stop_metrics(make_truth(slip=0.02), None).adhesion_utilisation is None


def test_largest_slip_ignores_what_happens_below_10_kmh(make_truth: Any, changed: Any) -> None:
    truth = make_truth(slip=[0.05, 0.1, 0.2, 0.3])
    slow = truth.wheelsets.speed_mps < 9.9 / 3.6
    wheelsets = changed(truth.wheelsets, slip=np.where(slow, 1.0, truth.wheelsets.slip))
    found = [wheelset.largest_slip for wheelset in wheelset_metrics(truth.motion, wheelsets)]
    assert found == pytest.approx([0.05, 0.1, 0.2, 0.3])


def test_locked_time_counts_a_rim_below_5_percent_while_above_30_kmh(make_truth: Any) -> None:
    deceleration = 0.75
    truth = make_truth(initial_speed_mps=30.0, deceleration_mps2=deceleration, slip=[1.0, 0.951, 0.949, 0.0])
    found = [wheelset.locked_s for wheelset in wheelset_metrics(truth.motion, truth.wheelsets)]
    above_30_s = (30.0 - 30.0 / 3.6) / deceleration
    assert found == pytest.approx([above_30_s, above_30_s, 0.0, 0.0], abs=0.011)


def test_friction_energy_is_sliding_speed_times_force(make_truth: Any) -> None:
    truth = make_truth(initial_speed_mps=30.0, deceleration_mps2=0.75, used_share=0.8, slip=[0.1, 0.2, 0.0, 0.4])
    force_n = 2 * 0.8 * 0.08 * 68_670.0
    found = [wheelset.friction_energy_kj for wheelset in wheelset_metrics(truth.motion, truth.wheelsets)]
    assert found == pytest.approx([force_n * slip * 600.0 / 1000.0 for slip in (0.1, 0.2, 0.0, 0.4)], rel=1e-3)


def test_constant_errors_come_out_as_they_are(make_truth: Any, stream_of: Any) -> None:
    truth = make_truth()
    estimate = estimate_of(truth, stream_of, lambda t: 0.0 * t - 0.5, lambda t: 0.0 * t - 3.0)
    figures = estimator_metrics(estimator_errors(truth.motion, NO_BALISES, estimate))
    assert figures.speed_rms_kmh == pytest.approx(1.8)
    assert figures.speed_max_kmh == pytest.approx(1.8)
    assert figures.distance_error_m == pytest.approx(3.0)
    assert figures.outside_etcs_share == 0.0
    assert figures.outside_etcs_distance_share == 0.0
    assert figures.gradient_rms_permille is None


def test_etcs_share_of_speed_follows_the_true_speed(make_truth: Any, stream_of: Any) -> None:
    """A constant error of 3 km/h is inside the limit above 77 km/h and outside below."""
    deceleration, speed_mps, brake_at_s = 0.5, 120.0 / 3.6, 20.0
    truth = make_truth(initial_speed_mps=speed_mps, deceleration_mps2=deceleration, brake_at_s=brake_at_s)
    estimate = estimate_of(truth, stream_of, lambda t: 0.0 * t + 3.0 / 3.6, lambda t: 0.0 * t)
    stop_s = brake_at_s + speed_mps / deceleration
    outside_s = 77.0 / 3.6 / deceleration
    figures = estimator_metrics(estimator_errors(truth.motion, NO_BALISES, estimate))
    assert figures.outside_etcs_share == pytest.approx(outside_s / stop_s, abs=0.2 / stop_s)


def test_etcs_share_of_distance_starts_anew_at_each_balise(make_truth: Any, stream_of: Any) -> None:
    """8 m of error are outside for the first 60 m after a reference: from the start and from one balise."""
    truth = make_truth(initial_speed_mps=30.0, brake_at_s=20.0, deceleration_mps2=0.75)
    balises = BaliseReadings(t_s=[10.0], position_m=[300.0])
    estimate = estimate_of(truth, stream_of, lambda t: 0.0 * t, lambda t: 0.0 * t + 8.0)
    figures = estimator_metrics(estimator_errors(truth.motion, balises, estimate))
    assert figures.outside_etcs_distance_share == pytest.approx(2 * 60.0 / 30.0 / 60.0, abs=0.2 / 60.0)


def test_errors_count_from_first_to_last_motion_only(make_truth: Any, stream_of: Any) -> None:
    truth = make_truth(initial_speed_mps=30.0, brake_at_s=10.0, deceleration_mps2=0.75)  # stands from 50 s on
    estimate = estimate_of(truth, stream_of, lambda t: np.where(t > 50.05, 9.0, 0.0), lambda t: 0.0 * t)
    assert estimator_metrics(estimator_errors(truth.motion, NO_BALISES, estimate)).speed_max_kmh == pytest.approx(0.0)


def test_an_estimator_with_its_own_period_is_held_between_its_ticks(make_truth: Any, stream_of: Any) -> None:
    """At 1 Hz the held answer lags by 0..0.9 s while braking: the error grows to 0.9 s times the deceleration."""
    truth = make_truth(initial_speed_mps=30.0, brake_at_s=10.0, deceleration_mps2=0.75)
    estimate = estimate_of(truth, stream_of, lambda t: 0.0 * t, lambda t: 0.0 * t, period_s=1.0)
    figures = estimator_metrics(estimator_errors(truth.motion, NO_BALISES, estimate))
    assert figures.speed_max_kmh == pytest.approx(3.6 * 0.9 * 0.75, rel=1e-6)


def test_an_estimator_without_speed_has_null_figures(make_truth: Any, stream_of: Any, changed: Any) -> None:
    truth = make_truth()
    silent = estimate_of(truth, stream_of, lambda t: np.nan * t, lambda t: np.nan * t)
    tilted = changed(silent, gradient_permille=np.full(len(silent), 2.5))
    figures = estimator_metrics(estimator_errors(truth.motion, NO_BALISES, tilted))
    assert figures.speed_rms_kmh is None
    assert figures.outside_etcs_share is None
    assert figures.gradient_rms_permille == pytest.approx(2.5)


def test_silence_counts_as_outside_where_an_estimator_sometimes_answers(make_truth: Any, stream_of: Any) -> None:
    truth = make_truth(initial_speed_mps=30.0, brake_at_s=10.0, deceleration_mps2=0.75)  # moves for 50 s
    estimate = estimate_of(truth, stream_of, lambda t: np.where(t < 10.0, np.nan, 0.0), lambda t: 0.0 * t)
    figures = estimator_metrics(estimator_errors(truth.motion, NO_BALISES, estimate))
    assert figures.outside_etcs_share == pytest.approx(10.0 / 50.0, abs=0.004)


def test_metrics_tree_has_the_promised_keys(make_truth: Any, stream_of: Any) -> None:
    truth = make_truth()
    estimate = estimate_of(truth, stream_of, lambda t: 0.0 * t, lambda t: 0.0 * t)
    tree = metrics_tree(
        truth.solve,
        stop_metrics(truth, 500.0),
        wheelset_metrics(truth.motion, truth.wheelsets),
        {"scmt": estimator_metrics(estimator_errors(truth.motion, NO_BALISES, estimate))},
    )
    assert set(tree["solve"]) == {"simulated_s", "wall_s", "realtime_factor", "step_s"}
    assert set(tree["stop"]) == {"distance_m", "shortest_distance_m", "adhesion_utilisation", "air_nl"}
    assert [set(wheelset) for wheelset in tree["wheelsets"]] == [{"largest_slip", "locked_s", "friction_energy_kj"}] * 4
    assert {
        "speed_rms_kmh",
        "speed_max_kmh",
        "distance_error_m",
        "outside_etcs_share",
        "outside_etcs_distance_share",
    } <= set(tree["estimators"]["scmt"])
