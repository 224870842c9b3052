"""Figures of a stop against runs written down by formula, whose figures are known in closed form."""

import math
from typing import Any

import numpy as np
import pytest

from scenarios.truth import Truth
from scenarios.wsp_test.scorecard import (
    SLIP_BINS,
    ScoringParameters,
    application,
    brake_stretches,
    score_stop,
    slide_events_s,
    valve_operations,
)
from scenarios.wsp_test.spans import durations_s, longest_s, merged_spans_s, spans

SPEED_MPS, DECELERATION_MPS2, LOAD_N = 30.0, 0.75, 68_670.0
STOP_M = SPEED_MPS**2 / (2.0 * DECELERATION_MPS2)
SCORING = ScoringParameters()


def way_above_m(speed_kmh: float) -> float:
    """Way of the stop until its speed has fallen to this."""
    return STOP_M - (speed_kmh / 3.6) ** 2 / (2.0 * DECELERATION_MPS2)


def with_fields(changed: Any, truth: Truth, stream: str, **fields: Any) -> Truth:
    return changed(truth, **{stream: changed(getattr(truth, stream), **fields)})  # type: ignore[no-any-return]


def test_spans_and_their_durations() -> None:
    t_s = 0.1 * np.arange(10)
    holds = np.array([1, 1, 0, 0, 1, 0, 1, 1, 1, 1], bool)
    assert spans(holds).tolist() == [[0, 2], [4, 5], [6, 10]]
    # a row holds until the next one; the last row of the record lasts no time
    np.testing.assert_allclose(durations_s(t_s, holds), [0.2, 0.1, 0.3])
    assert longest_s(t_s, holds) == pytest.approx(0.3)
    assert longest_s(t_s, np.zeros(10, bool)) == 0.0
    assert merged_spans_s(t_s, holds, 0.15) == [pytest.approx((0.0, 0.2)), pytest.approx((0.4, 0.9))]
    assert len(merged_spans_s(t_s, holds, 0.05)) == 3


def test_stop_runs_from_demand_to_standstill(make_truth: Any) -> None:
    score = score_stop(make_truth(SPEED_MPS, DECELERATION_MPS2), 550.0, SCORING)
    assert score.distance_m == pytest.approx(STOP_M, abs=0.01)
    assert score.initial_speed_kmh == pytest.approx(108.0)
    assert score.shortest_distance_m == 550.0
    assert score.adhesion_utilisation == pytest.approx(0.8)
    assert score.air_nl == pytest.approx(100.0)
    assert score.drag_speed_change_kmh is None


def test_reservoir_and_discs_by_their_extremes(make_truth: Any, changed: Any) -> None:
    truth = make_truth()
    rows = len(truth.brake)
    disc_degc = np.linspace(20.0, 90.0, rows)[:, None] + np.array([0.0, 30.0, 0.0, 0.0])
    reservoir_bar = 5.0 + np.abs(np.linspace(-1.0, 1.0, rows))
    truth = with_fields(changed, truth, "brake", disc_temperature_degc=disc_degc, reservoir_pressure_bar=reservoir_bar)
    score = score_stop(truth, None, SCORING)
    assert score.hottest_disc_degc == pytest.approx(120.0)
    assert score.least_reservoir_bar == pytest.approx(5.0, abs=1e-3)


def test_after_a_drag_brake_the_stop_begins_with_the_last_rise_of_demand(make_truth: Any, changed: Any) -> None:
    truth = make_truth(SPEED_MPS, DECELERATION_MPS2, brake_at_s=30.0)
    demand = truth.brake.demand.copy()
    dragging = (truth.brake.t_s > 10.0) & (truth.brake.t_s < 30.0 - 1e-6)
    demand[dragging] = 0.4
    pressure_bar = np.where(dragging, 1.2, np.where(demand > 0.0, 3.0, 0.0))
    truth = with_fields(changed, truth, "brake", demand=demand, distributor_pressure_bar=pressure_bar)
    span = application(truth)
    assert span is not None
    assert truth.motion.t_s[span[0]] == pytest.approx(30.0)
    score = score_stop(truth, None, SCORING)
    assert score.distance_m == pytest.approx(STOP_M, abs=0.01)
    assert score.drag_speed_change_kmh == pytest.approx(0.0, abs=1e-9)
    assert [stretch.demand for stretch in score.stretches] == [0.4, 1.0]
    faster = truth.motion.speed_mps + np.where(dragging, 0.05 * (truth.motion.t_s - 10.0), 0.0)
    score = score_stop(with_fields(changed, truth, "motion", speed_mps=faster), None, SCORING)
    assert score.drag_speed_change_kmh == pytest.approx(3.6, abs=0.01)


def test_sliding_distance_counts_above_5_percent_and_5_kmh(make_truth: Any) -> None:
    slips = np.array([0.10, 0.04, 0.06, 0.0])
    score = score_stop(make_truth(SPEED_MPS, DECELERATION_MPS2, slip=slips), None, SCORING)
    expected = way_above_m(5.0)
    for wheelset, wanted in zip(score.wheelsets, (expected, 0.0, expected, 0.0), strict=True):
        assert wheelset.sliding_distance_m == pytest.approx(wanted, abs=0.1)
    looser = score_stop(make_truth(slip=slips), None, ScoringParameters(slide_slip=0.03))
    assert looser.wheelsets[1].sliding_distance_m == pytest.approx(expected, abs=0.1)


def test_slip_error_counts_where_the_wheel_slides_or_its_brake_is_held_down(make_truth: Any, changed: Any) -> None:
    truth = make_truth(slip=np.array([0.10, 0.04, 0.04, 0.01]))
    truth = with_fields(changed, truth, "wheelsets", peak_slip=np.full((len(truth.motion), 4), 0.02))
    full = truth.brake.distributor_pressure_bar
    pressure_bar = np.stack([full, full - 0.5, full - 0.1, full - 0.5], axis=1)
    truth = with_fields(changed, truth, "brake", cylinder_pressure_bar=pressure_bar)
    errors = [wheelset.slip_error for wheelset in score_stop(truth, None, SCORING).wheelsets]
    # sliding; held down; neither; held down and slower than the peak asks for
    assert errors[0] == pytest.approx(0.08)
    assert errors[1] == pytest.approx(0.02)
    assert errors[2] is None
    assert errors[3] == pytest.approx(0.01)


def test_longest_lock_is_without_a_break_and_above_30_kmh(make_truth: Any, changed: Any) -> None:
    truth = make_truth(SPEED_MPS, DECELERATION_MPS2)
    t_s = truth.motion.t_s
    rim = truth.wheelsets.rim_speed_mps.copy()
    below_30_kmh_s = 10.0 + (SPEED_MPS - 8.0) / DECELERATION_MPS2
    for begin_s, end_s in ((15.0, 15.3), (15.4, 16.1), (below_30_kmh_s, below_30_kmh_s + 3.0)):
        rim[(t_s >= begin_s - 1e-6) & (t_s < end_s - 1e-6), 2] = 0.0
    wheelsets = score_stop(with_fields(changed, truth, "wheelsets", rim_speed_mps=rim), None, SCORING).wheelsets
    assert wheelsets[2].longest_lock_s == pytest.approx(0.7)
    assert wheelsets[2].locked_s == pytest.approx(1.0)
    assert wheelsets[0].longest_lock_s == 0.0


def test_flat_risk_is_load_times_way_while_locked(make_truth: Any, changed: Any) -> None:
    truth = make_truth(SPEED_MPS, DECELERATION_MPS2, slip=np.array([1.0, 0.1, 0.1, 0.1]))
    load_n = truth.wheelsets.normal_force_n.copy()
    load_n[:, 1] = 2.0 * LOAD_N
    risk = score_stop(with_fields(changed, truth, "wheelsets", normal_force_n=load_n), None, SCORING).wheelsets
    expected = LOAD_N * way_above_m(5.0) / 1e6
    assert risk[0].flat_risk_mnm == pytest.approx((expected, 2.0 * expected), rel=1e-3)
    assert risk[1].flat_risk_mnm == (0.0, 0.0)


def test_friction_energy_goes_to_the_wheels_as_their_forces(make_truth: Any, changed: Any) -> None:
    truth = make_truth(SPEED_MPS, DECELERATION_MPS2, slip=0.1)
    wheel_n = 0.8 * 0.08 * LOAD_N
    total_kj = 2.0 * wheel_n * 0.1 * STOP_M / 1000.0
    score = score_stop(truth, None, SCORING)
    for wheelset in score.wheelsets:
        assert wheelset.friction_energy_kj == pytest.approx((0.5 * total_kj, 0.5 * total_kj), rel=1e-3)
    force_n = truth.wheelsets.longitudinal_force_n.copy()
    force_n[:, 2] *= 3.0
    score = score_stop(with_fields(changed, truth, "wheelsets", longitudinal_force_n=force_n), None, SCORING)
    assert score.wheelsets[1].friction_energy_kj == pytest.approx((0.75 * total_kj, 0.25 * total_kj), rel=1e-3)


def test_valve_operations_count_what_is_energised() -> None:
    fill, hold, vent = 0, 1, 2
    assert valve_operations(np.full(5, fill, np.int8)) == 0
    assert valve_operations(np.array([fill, hold, hold, fill], np.int8)) == 1
    # hold twice: at first by itself, then together with vent; vent twice
    sequence = [fill, hold, hold, vent, hold, fill, vent, fill]
    assert valve_operations(np.array(sequence, np.int8)) == 4


def test_longest_time_without_filling_and_of_venting(make_truth: Any, changed: Any) -> None:
    truth = make_truth()
    t_s = truth.brake.t_s
    valve = np.zeros((len(t_s), 4), np.int8)
    valve[(t_s >= 12.0 - 1e-6) & (t_s < 15.5 - 1e-6), 1] = 1
    valve[(t_s >= 13.0 - 1e-6) & (t_s < 14.2 - 1e-6), 1] = 2
    valve[(t_s >= 2.0) & (t_s < 9.0), 3] = 2  # without brake demand
    command = valve.copy()
    command[(t_s >= 12.0 - 1e-6) & (t_s < 18.0 - 1e-6), 1] = 2
    fired = np.zeros((len(t_s), 4), np.int8)
    fired[(t_s >= 15.5 - 1e-6) & (t_s < 18.0 - 1e-6), 1] = 1  # the safety timer takes the axle from the controller
    truth = with_fields(changed, truth, "brake", valve=valve, valve_command=command, safety_timer_fired=fired)
    wheelsets = score_stop(truth, None, SCORING).wheelsets
    assert wheelsets[1].longest_unfilled_s == pytest.approx(3.5)
    assert wheelsets[1].longest_unfilled_command_s == pytest.approx(6.0)
    assert wheelsets[1].safety_timer_s == pytest.approx(2.5)
    assert wheelsets[0].safety_timer_s == 0.0
    assert wheelsets[1].longest_vent_s == pytest.approx(1.2)
    assert wheelsets[3].longest_unfilled_s == 0.0


def test_reference_error_while_braking_above_5_kmh(make_truth: Any, changed: Any) -> None:
    score = score_stop(make_truth(SPEED_MPS, DECELERATION_MPS2, slip=0.1), None, SCORING)
    last_mps = 5.0 / 3.6
    # the reference is 10 % low; root mean square of a speed that falls evenly from one to the other
    rms_mps = 0.1 * math.sqrt((SPEED_MPS**2 + SPEED_MPS * last_mps + last_mps**2) / 3.0)
    assert score.reference_error_rms_kmh == pytest.approx(3.6 * rms_mps, rel=1e-3)
    assert score.reference_error_worst_kmh == pytest.approx(10.8, rel=1e-3)
    truth = make_truth()
    blind = with_fields(changed, truth, "brake", reference_speed_mps=np.full(len(truth.brake), np.nan))
    assert score_stop(blind, None, SCORING).reference_error_rms_kmh is None


def test_slide_events_merge_over_short_gaps(make_truth: Any, changed: Any) -> None:
    truth = make_truth(slip=0.0)
    t_s = truth.motion.t_s
    slip = np.zeros((len(t_s), 4))
    for axle, begin_s, end_s in ((0, 12.0, 13.0), (3, 13.8, 14.5), (1, 17.0, 18.0)):
        slip[(t_s >= begin_s - 1e-6) & (t_s < end_s - 1e-6), axle] = 0.2
    truth = with_fields(changed, truth, "wheelsets", slip=slip)
    assert slide_events_s(truth, SCORING) == [pytest.approx((12.0, 14.5)), pytest.approx((17.0, 18.0))]
    score = score_stop(truth, None, SCORING)
    assert (score.slide_events, score.sliding_s) == (2, pytest.approx(3.5))


def test_brake_stretch_begins_with_the_brake_built_up(make_truth: Any) -> None:
    (stretch,) = brake_stretches(make_truth(SPEED_MPS, DECELERATION_MPS2, used_share=0.5), SCORING)
    # the distributor rises by 1 bar/s to 3 bar; 2 % below that it counts as settled. It ends at 10 km/h
    assert stretch.begin_s == pytest.approx(12.94, abs=0.011)
    assert stretch.begin_s + stretch.duration_s == pytest.approx(10.0 + (SPEED_MPS - 10.0 / 3.6) / 0.75, abs=0.011)
    assert stretch.braking_ratio == pytest.approx(0.5 * 0.08)
    assert stretch.demand == 1.0


def test_a_reservoir_that_runs_low_does_not_shorten_the_stretch(make_truth: Any, changed: Any) -> None:
    truth = make_truth(SPEED_MPS, DECELERATION_MPS2)
    (sound,) = brake_stretches(truth, SCORING)
    falling_bar = truth.brake.distributor_pressure_bar - 0.03 * np.clip(truth.brake.t_s - 20.0, 0.0, None)
    truth = with_fields(changed, truth, "brake", distributor_pressure_bar=falling_bar)
    assert brake_stretches(truth, SCORING) == (sound,)


def test_slip_histogram_holds_the_time_above_10_kmh(make_truth: Any) -> None:
    score = score_stop(
        make_truth(SPEED_MPS, DECELERATION_MPS2, slip=np.array([0.12, 1.0, -0.02, 0.005])), None, SCORING
    )
    time_s = (SPEED_MPS - 10.0 / 3.6) / DECELERATION_MPS2
    for wheelset, place in zip(score.wheelsets, (5, 10, 0, 1), strict=True):
        expected = np.zeros(len(SLIP_BINS) - 1)
        expected[place] = time_s
        np.testing.assert_allclose(wheelset.slip_histogram_s, expected, atol=0.011)


def test_without_standstill_there_is_no_distance(make_truth: Any, changed: Any) -> None:
    whole = make_truth()
    rows = slice(0, len(whole.motion) // 2)
    truth = changed(
        whole,
        motion=whole.motion.rows(rows),
        wheelsets=whole.wheelsets.rows(rows),
        brake=whole.brake.rows(rows),
        solve=changed(whole.solve, ended="time"),
    )
    score = score_stop(truth, None, SCORING)
    assert (score.ended, score.distance_m, score.adhesion_utilisation) == ("time", None, None)
    assert score.wheelsets[0].sliding_distance_m > 0.0
