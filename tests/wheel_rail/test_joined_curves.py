"""Compound and reverse curves: curves that join the one before, against closed forms and independent integration."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.special import fresnel

from wheel_rail import Track, TrackParameters
from wheel_rail.alignment import curvature_radpm, heading_rad, roll_rad
from wheel_rail.track_frame import track_frame
from wheel_rail.track_parameters import Curve
from wheel_rail.transitions import TRANSITIONS

KINDS = tuple(TRANSITIONS)
FORMS = {  # written apart from the program's own
    "clothoid": lambda x: x,
    "bloss": lambda x: 3.0 * x**2 - 2.0 * x**3,
    "cosine": lambda x: np.sin(0.5 * np.pi * x) ** 2,
}


def line(length_m: float, curves: list[dict]) -> TrackParameters:
    return TrackParameters.model_validate({"length_m": length_m, "curves": curves})


def frame_at(track: Track, s_m: float) -> np.ndarray:
    frame = np.empty(14)
    track_frame(s_m, track.origin_m, track.table, frame)
    return frame


def chain(start_m: float, *parts: tuple[float, float, float], out_m: float, kind: str = "clothoid") -> list[dict]:
    """Curves joined to each other: of every part the length of its first transition, its radius, and its arc."""
    curves, at = [], start_m
    for k, (entry, radius, arc) in enumerate(parts):
        curves.append(
            {"start_m": at, "transition_in_m": entry, "radius_m": radius, "length_m": arc, "transition_kind": kind}
        )
        if k:
            curves[-1]["joins_previous"] = True
        at += entry + arc
    curves[-1]["transition_out_m"] = out_m
    return curves


def integrated(curves: list[dict], end_m: float) -> np.ndarray:
    """Heading, x and y at the end, by an eighth-order method over the line's curvature, piece by piece."""
    pieces: list[tuple[float, float, float, str]] = [(curves[0]["start_m"], 0.0, 0.0, "clothoid")]
    bend = 0.0
    for k, c in enumerate(curves):
        own = 1.0 / c["radius_m"]
        pieces += [(c["transition_in_m"], bend, own, c["transition_kind"]), (c["length_m"], own, own, "clothoid")]
        bend = own
        if "transition_out_m" in c:
            pieces.append((c["transition_out_m"], own, 0.0, c["transition_kind"]))
            bend = 0.0
            until = curves[k + 1]["start_m"] if k + 1 < len(curves) else end_m
            pieces.append((until - sum(piece[0] for piece in pieces), 0.0, 0.0, "clothoid"))
    state = np.zeros(3)
    for length, *piece in pieces:
        if length > 0.0:
            span, way = (0.0, length), (length, *piece)
            state = solve_ivp(_slope, span, state, "DOP853", rtol=1e-13, atol=1e-13, max_step=5.0, args=way).y[:, -1]
    return state


def _slope(x: float, state: np.ndarray, length: float, before: float, after: float, kind: str) -> list[float]:
    return [before + (after - before) * FORMS[kind](x / length), np.cos(state[0]), np.sin(state[0])]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("second_m", [300.0, 1500.0, -450.0])
def test_heading_and_end_are_those_of_an_independent_integration(kind: str, second_m: float) -> None:
    curves = chain(100.3, (80.0, 600.0, 150.0), (60.0, second_m, 120.2), (90.0, 800.0, 0.0), out_m=70.0, kind=kind)
    curves[1]["transition_kind"] = "cosine"  # the joint is of the kind of the curve that joins
    end = curves[-1]["start_m"] + 90.0 + 70.0 + 33.0
    parameters = line(end + 40.0, curves)
    heading, x, y = integrated(curves, end)
    found = frame_at(Track(parameters), end)
    error = np.abs(found[:2] - [x, y]).max(), abs(heading_rad(parameters, np.array([end]))[0] - heading)
    print(f"ends at {found[:2]} m, off by {error[0]:.1e} m and {error[1]:.1e} rad")
    assert error[0] < 1e-10
    assert error[1] < 1e-12
    turned = 40.0 / 600.0 + 150.0 / 600.0 + 30.0 * (1.0 / 600.0 + 1.0 / second_m) + 120.2 / second_m
    turned += 45.0 * (1.0 / second_m + 1.0 / 800.0) + 35.0 / 800.0
    assert heading_rad(parameters, np.array([end]))[0] == pytest.approx(turned, rel=1e-12)


@pytest.mark.parametrize("second_m", [350.0, -500.0])
def test_the_clothoid_between_two_circles_is_a_piece_of_one_spiral(second_m: float) -> None:
    """A^2 = L / (1/R2 - 1/R1); its piece from curvature 1/R1 to 1/R2 in Fresnel's integrals."""
    first_m, length = 900.0, 75.0
    curves = chain(50.0, (100.0, first_m, 130.0), (length, second_m, 60.0), out_m=60.0)
    track, begin = Track(line(600.0, curves)), 280.0
    square = length / (1.0 / second_m - 1.0 / first_m)  # negative where curvature falls: the mirror image
    size, side = np.sqrt(np.pi * abs(square)), np.sign(square)

    def spiral(curvature: float) -> tuple[complex, float]:
        along = curvature * square
        sine, cosine = fresnel(along / size)
        return size * complex(cosine, side * sine), 0.5 * along**2 / square

    (from_place, from_angle), (to_place, to_angle) = spiral(1.0 / first_m), spiral(1.0 / second_m)
    a, b = frame_at(track, begin), frame_at(track, begin + length)
    heading = np.arctan2(a[4], a[3])
    moved = (to_place - from_place) * np.exp(1j * (heading - from_angle))
    assert complex(b[0] - a[0], b[1] - a[1]) == pytest.approx(moved, abs=1e-8)
    assert np.arctan2(b[4], b[3]) - heading == pytest.approx(to_angle - from_angle, abs=1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_joining_the_same_radius_and_cant_is_one_long_curve(kind: str) -> None:
    joined = chain(80.0, (90.0, -700.0, 100.0), (50.0, -700.0, 70.0), (30.0, -700.0, 10.0), out_m=60.0, kind=kind)
    joined = [{**c, "cant_mm": -110.0} for c in joined]
    whole = chain(80.0, (90.0, -700.0, 260.0), out_m=60.0, kind=kind)
    whole = [{**c, "cant_mm": -110.0} for c in whole]
    assert Track(line(700.0, joined)).table == pytest.approx(Track(line(700.0, whole)).table, abs=1e-11, rel=1e-13)


def test_a_reverse_curve_is_two_curves_whose_clothoids_meet() -> None:
    """One clothoid through zero is the second half of one and the first of the other; so are straight cant ramps."""
    joined = chain(80.0, (90.0, 400.0, 100.0), (150.0, -400.0, 70.0), out_m=60.0)
    joined = [{**c, "cant_mm": cant} for c, cant in zip(joined, (120.0, -120.0), strict=True)]
    apart = chain(80.0, (90.0, 400.0, 100.0), out_m=75.0) + chain(345.0, (75.0, -400.0, 70.0), out_m=60.0)
    apart = [{**c, "cant_mm": cant} for c, cant in zip(apart, (120.0, -120.0), strict=True)]
    assert Track(line(700.0, joined)).table == pytest.approx(Track(line(700.0, apart)).table, abs=1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_curvature_and_cant_pass_through_zero_together_in_a_reverse_curve(kind: str) -> None:
    curves = chain(80.0, (90.0, 400.0, 100.0), (150.0, -800.0, 70.0), out_m=60.0, kind=kind)
    curves = [{**c, "cant_mm": cant} for c, cant in zip(curves, (120.0, -60.0), strict=True)]
    parameters = line(700.0, curves)
    s = np.linspace(270.0, 420.0, 301)
    share = FORMS[kind]((s - 270.0) / 150.0)
    assert curvature_radpm(parameters, s) == pytest.approx(1.0 / 400.0 - share * (1.0 / 400.0 + 1.0 / 800.0), abs=1e-16)
    first, second = -np.arcsin(0.12 / 1.5), np.arcsin(0.06 / 1.5)
    assert roll_rad(parameters, s) == pytest.approx(first + share * (second - first), abs=1e-15)


def test_a_cant_ramp_of_its_own_length_reaches_back_into_the_circle_before() -> None:
    curves = chain(80.0, (60.0, 500.0, 160.0), (50.0, 350.0, 100.0), out_m=80.0)
    curves[0]["cant_mm"], curves[1]["cant_mm"], curves[1]["cant_ramp_in_m"] = 60.0, 150.0, 100.0
    cant = Track(line(700.0, curves)).cant_mm(np.array([200.0, 275.0, 300.0, 325.0, 360.0, 490.0]))
    # linear in roll, whose sine the cant is
    assert cant == pytest.approx([60.0, 82.5, 105.0, 127.5, 150.0, 75.0], abs=0.1)
    assert cant[[0, 4]] == pytest.approx([60.0, 150.0], abs=1e-9)
    curves[1]["cant_ramp_in_m"] = 25.0  # a shorter one begins within the transition
    cant = Track(line(700.0, curves)).cant_mm(np.array([310.0, 323.0, 340.0, 352.0]))
    assert cant == pytest.approx([60.0, 60.0, 114.0, 150.0], abs=0.1)


def alone(c: Curve, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Curvature, roll and heading of a curve that stands alone, straight from its keys, and what it turns by."""
    shape = TRANSITIONS[c.transition_kind]

    def share(rise_m: float, fall_m: float) -> np.ndarray:
        up, down = (s - c.circle_start_m) / rise_m + 1.0, (c.circle_end_m - s) / fall_m + 1.0
        return shape.share(np.clip(np.minimum(up, down), 0.0, 1.0))

    into = shape.turned(np.clip((s - c.start_m) / c.entry_m, 0.0, 1.0))
    arc = np.clip(s, c.circle_start_m, c.circle_end_m) - c.circle_start_m
    out = 0.5 - shape.turned(np.clip((c.last_m - s) / c.exit_m, 0.0, 1.0))
    total = (c.circle_end_m - c.circle_start_m + 0.5 * (c.entry_m + c.exit_m)) / c.radius_m
    turned = (c.entry_m * into + arc + c.exit_m * out) / c.radius_m
    return share(c.entry_m, c.exit_m) / c.radius_m, share(c.ramp_in_m, c.ramp_out_m) * c.full_roll_rad, turned, total


def test_curves_that_stand_alone_are_as_they_were_to_the_last_bit() -> None:
    """Joining must not touch lines without it: what one curve alone gives, and headings added up in their order."""
    rng = np.random.default_rng(3)
    for _ in range(40):
        at, curves = 120.0, []
        for _ in range(4):
            rise, fall, arc = rng.uniform(50.0, 150.0, 3)
            size = {"end_m": at + rise + arc + fall} if rng.random() < 0.5 else {"length_m": arc}
            curves.append(
                {"start_m": at, "transition_in_m": rise, "transition_out_m": fall, "radius_m": rng.uniform(-900, -90),
                 "transition_kind": KINDS[rng.integers(3)], "cant_mm": rng.uniform(-60, 60),
                 "cant_ramp_out_m": 1.2 * fall, **size}
            )  # fmt: skip
            at += rise + arc + fall + rng.uniform(60.0, 200.0)
        parameters = line(at + 10.0, curves)
        s = np.union1d(np.arange(0.0, at), rng.uniform(0.0, at, 500))
        curvature, roll, heading, before = np.zeros_like(s), np.zeros_like(s), np.zeros_like(s), 0.0
        for c in parameters.curves:
            bend, lean, turned, total = alone(c, s)
            bent, canted, beyond = (s >= c.start_m) & (s < c.last_m), s >= c.reach_m[0], s >= c.start_m
            curvature[bent] = bend[bent]
            roll[canted] = lean[canted]
            heading[beyond] = before + turned[beyond]
            before += total
            heading[s >= c.last_m] = before
        assert np.array_equal(curvature_radpm(parameters, s), curvature)
        assert np.array_equal(roll_rad(parameters, s), roll)
        assert np.array_equal(heading_rad(parameters, s), heading)


def test_sixty_kilometres_of_joined_curves_are_one_period_sixty_times_over() -> None:
    period = chain(50.0, (80.0, 500.0, 120.0), (60.0, 300.0, 90.0), (110.0, -350.0, 150.0), (40.0, -900.0, 60.0),
                   out_m=70.0)  # fmt: skip
    kinds = ("bloss", "clothoid", "cosine", "bloss")
    period = [{**c, "transition_kind": kind, "cant_mm": 40.0} for c, kind in zip(period, kinds, strict=True)]
    heading, x, y = integrated(period, 1000.0)
    curves = [{**c, "start_m": c["start_m"] + 1000.0 * k} for k in range(60) for c in period]
    parameters = line(60_000.0, curves)
    steps = complex(x, y) * np.exp(1j * heading * np.arange(60))
    track = Track(parameters)
    found = np.array([frame_at(track, 1000.0 * (k + 1)) for k in range(60)])
    off = np.abs(found[:, 0] + 1j * found[:, 1] - np.cumsum(steps)).max()
    turned = np.abs(heading_rad(parameters, 1000.0 * np.arange(1.0, 61.0)) - heading * np.arange(1, 61)).max()
    print(f"off by {off:.1e} m and {turned:.1e} rad at most over 60 km, 240 curves")
    assert off < 2e-8
    assert turned < 1e-12


lengths = st.floats(40.0, 200.0)
parts = st.tuples(
    st.booleans(), lengths, lengths, st.floats(1.0, 300.0), st.sampled_from(KINDS), st.floats(150.0, 3000.0),
    st.sampled_from([-1.0, 1.0]), st.floats(-60.0, 60.0),
)  # fmt: skip


@settings(max_examples=40)
@given(st.lists(parts, min_size=1, max_size=8))
def test_any_line_is_continuous_and_turns_by_what_its_curves_add_up_to(stretches: list[tuple]) -> None:
    curves, at, turned, bend, steepest, twist = [], 50.0, 0.0, 0.0, 0.0, 0.0
    levels = [0.0]
    for k, (joins, entry, _, arc, kind, radius, side, cant) in enumerate(stretches):
        joins = joins and k > 0
        if k and not joins:  # the one before runs out
            fall = curves[-1]["transition_out_m"] = stretches[k - 1][2]
            shape = TRANSITIONS[curves[-1]["transition_kind"]].steepest
            steepest = max(steepest, abs(bend) * shape / fall)
            twist = max(twist, 60.0 * shape / fall)
            at, turned, bend = at + fall + 10.0, turned + 0.5 * fall * bend, 0.0
        curves.append(
            {"start_m": at, "transition_in_m": entry, "length_m": arc, "radius_m": side * radius, "cant_mm": cant,
             "transition_kind": kind, "joins_previous": joins}
        )  # fmt: skip
        own = side / radius
        steepest = max(steepest, abs(own - bend) * TRANSITIONS[kind].steepest / entry)
        twist = max(twist, 120.0 * TRANSITIONS[kind].steepest / entry)
        turned += 0.5 * entry * (bend + own) + arc * own
        at, bend = at + entry + arc, own
        levels.append(own)
    curves[-1]["transition_out_m"] = stretches[-1][2]
    steepest = max(steepest, abs(bend) * TRANSITIONS[kind].steepest / stretches[-1][2])
    twist = max(twist, 60.0 * TRANSITIONS[kind].steepest / stretches[-1][2])
    at, turned = at + stretches[-1][2], turned + 0.5 * stretches[-1][2] * bend
    parameters = line(at + 60.0, curves)
    end = frame_at(Track(parameters), at + 55.0)
    assert end[3:6] == pytest.approx([np.cos(turned), np.sin(turned), 0.0], abs=1e-8)
    s = np.linspace(0.0, at + 1.0, 8000)
    step = s[1] - s[0]
    curvature, heading = curvature_radpm(parameters, s), heading_rad(parameters, s)
    assert heading[-1] == pytest.approx(turned, abs=1e-12)
    assert np.abs(np.diff(curvature)).max() <= steepest * step * (1.0 + 1e-9) + 1e-15  # no jump anywhere
    assert min(levels) - 1e-15 <= curvature.min()
    assert curvature.max() <= max(levels) + 1e-15
    # the heading is the integral of the curvature: trapezia, off by the curvature's slope at kinks
    trapezia = 0.5 * step * (curvature[1:] + curvature[:-1])
    assert np.diff(heading) == pytest.approx(trapezia, abs=0.25 * steepest * step**2 + 1e-14)
    cant = 1500.0 * np.sin(-roll_rad(parameters, s))
    assert np.abs(np.diff(cant)).max() <= twist * step * (1.0 + 1e-3) + 1e-9
    for before, after in pairwise(parameters.curves):
        place = np.array([before.circle_end_m - 0.5, after.circle_start_m + 0.5])
        if after.joins_previous:
            assert curvature_radpm(parameters, place) == pytest.approx([1 / before.radius_m, 1 / after.radius_m])
