"""Long lines of every kind of transition against closed forms and an independent integration."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import fresnel

from wheel_rail import Track, TrackParameters
from wheel_rail.alignment import curvature_radpm, heading_rad, roll_rad
from wheel_rail.track_frame import track_frame
from wheel_rail.transitions import TRANSITIONS

KINDS = tuple(TRANSITIONS)


def line(length_m: float, **values: object) -> TrackParameters:
    return TrackParameters.model_validate({"length_m": length_m, **values})


def frame_at(track: Track, s_m: float) -> np.ndarray:
    frame = np.empty(14)
    track_frame(s_m, track.origin_m, track.table, frame)
    return frame


def curve(start_m: float, radius_m: float, length_m: float, **values: object) -> dict:
    return {"start_m": start_m, "transition_m": 80.0, "radius_m": radius_m, "length_m": length_m, **values}


@pytest.mark.parametrize("kind", KINDS)
def test_transitions_rise_from_nothing_to_all(kind: str) -> None:
    shape = TRANSITIONS[kind]
    u = np.linspace(0.0, 1.0, 201)
    assert shape.share(np.array([0.0, 0.5, 1.0])) == pytest.approx([0.0, 0.5, 1.0])
    assert shape.share(u) + shape.share(1.0 - u) == pytest.approx(np.ones(201))
    slopes = np.diff(shape.share(u)) / np.diff(u)
    assert slopes.min() >= 0.0
    assert slopes.max() == pytest.approx(shape.steepest, rel=1e-3)
    for end in (0.3, 1.0):
        assert shape.turned(np.array(end)) == pytest.approx(quad(lambda x: float(shape.share(np.array(x))), 0, end)[0])


def test_clothoid_is_fresnels_integrals() -> None:
    radius, length = 300.0, 90.0
    track = Track(line(800.0, curves=[{**curve(100.0, radius, 50.0), "transition_m": length}]))
    size = np.sqrt(np.pi * radius * length)
    for along in (20.0, 55.0, 90.0):
        sine, cosine = fresnel(along / size)
        assert frame_at(track, 100.0 + along)[:2] == pytest.approx([100.0 + size * cosine, size * sine], abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_full_circle_closes(kind: str) -> None:
    radius = 200.0
    round_m = 2.0 * np.pi * radius
    track = Track(line(2000.0, curves=[curve(100.0, radius, round_m + 30.0, transition_kind=kind, cant_mm=60.0)]))
    once, again = frame_at(track, 190.0), frame_at(track, 190.0 + round_m)
    assert again[:12] == pytest.approx(once[:12], abs=2e-9)
    assert track.curvature_radpm(np.array([600.0]))[0] == pytest.approx(1.0 / radius)


@pytest.mark.parametrize("kind", KINDS)
def test_an_s_curve_is_symmetric_about_its_middle_and_ends_parallel(kind: str) -> None:
    curves = [curve(100.0, 500.0, 200.0, transition_kind=kind), curve(460.0, -500.0, 200.0, transition_kind=kind)]
    track = Track(line(1000.0, curves=curves))
    start, middle, end = (frame_at(track, s)[:6] for s in (100.0, 460.0, 820.0))
    assert end[:3] - middle[:3] == pytest.approx(middle[:3] - start[:3], abs=1e-9)
    assert end[3:] == pytest.approx(start[3:], abs=1e-11)


def test_entry_and_exit_have_lengths_of_their_own() -> None:
    given = {"start_m": 100.0, "end_m": 600.0, "radius_m": -400.0, "transition_in_m": 120.0, "transition_out_m": 60.0}
    parameters = line(1000.0, curves=[{**given, "cant_mm": -90.0, "cant_ramp_in_m": 150.0}])
    s = np.array([70.0, 100.0, 160.0, 220.0, 540.0, 570.0, 600.0, 800.0])
    assert 400.0 * curvature_radpm(parameters, s) == pytest.approx([0.0, 0.0, -0.5, -1.0, -1.0, -0.5, 0.0, 0.0])
    share = roll_rad(parameters, s) / np.arcsin(0.09 / 1.5)
    assert share == pytest.approx([0.0, 0.2, 0.6, 1.0, 1.0, 0.5, 0.0, 0.0])  # the longer ramp begins on the straight
    assert heading_rad(parameters, s)[-1] == pytest.approx(-(60.0 + 320.0 + 30.0) / 400.0)


def test_a_vertical_radius_rounds_as_the_length_that_follows_from_it() -> None:
    by_radius = Track(
        line(1000.0, gradients=[{"from_m": 500.0, "gradient_permille": 20.0, "vertical_radius_m": 5000.0}])
    )
    by_length = Track(line(1000.0, gradients=[{"from_m": 500.0, "gradient_permille": 20.0, "rounding_m": 100.0}]))
    assert by_radius.table == pytest.approx(by_length.table, abs=1e-12)
    # a parabola: half a length of rise at the mean of half the gradient
    assert frame_at(by_radius, 550.0)[2] == pytest.approx(0.5 * 100.0 * 0.02, rel=1e-3)


LONG = {
    "curves": [
        {
            "start_m": 300.0 + 1000.0 * k, "transition_in_m": 100.0, "transition_out_m": 60.0, "length_m": 300.0,
            "radius_m": (-1.0) ** (k // 2) * (500.0 + 20.0 * k), "transition_kind": KINDS[k % 3], "cant_mm": 80.0,
        }
        for k in range(59)
    ],
    "gradients": [
        {"from_m": 800.0 + 1500.0 * k, "gradient_permille": (-1.0) ** k * 15.0, "rounding_m": 100.0} for k in range(39)
    ],
}  # fmt: skip


def integrated(end_m: float) -> np.ndarray:
    """Positions (3, n) every metre, from curvature and gradient alone: Simpson's rule twice, in extended precision."""
    h = np.longdouble(1.0)
    n = round(end_m / float(h))
    s = h * np.arange(2 * n + 1) / 2  # ends and middles of the cells
    curvature, gradient = np.zeros_like(s), np.zeros_like(s)
    for c in LONG["curves"]:
        part = slice(round(2 * c["start_m"]), round(2 * c["start_m"]) + 921)
        shares = []
        for x in ((s[part] - c["start_m"]) / 100, (c["start_m"] + 460 - s[part]) / 60):
            x = np.clip(x, 0, 1)
            forms = {"clothoid": x, "bloss": 3 * x**2 - 2 * x**3, "cosine": np.sin(np.longdouble(np.pi) / 2 * x) ** 2}
            shares.append(forms[c["transition_kind"]])
        curvature[part] = np.minimum(*shares) / c["radius_m"]
    before = 0.0
    for g in LONG["gradients"]:
        after = g["gradient_permille"] / 1000.0
        gradient += (after - before) * np.clip((s - g["from_m"]) / 100 + 0.5, 0, 1)
        before = after
    ends = np.concatenate([[0], np.cumsum(h / 6 * (curvature[:-2:2] + 4 * curvature[1::2] + curvature[2::2]))])
    middles = ends[:-1] + h / 24 * (5 * curvature[:-2:2] + 8 * curvature[1::2] - curvature[2::2])
    heading = np.empty_like(s)
    heading[::2], heading[1::2] = ends, middles
    level = 1 / np.sqrt(1 + gradient**2)
    tangent = np.stack([np.cos(heading) * level, np.sin(heading) * level, gradient * level])
    return (h / 6 * (tangent[:, :-2:2] + 4 * tangent[:, 1::2] + tangent[:, 2::2])).cumsum(axis=1).astype(float)


def test_sixty_kilometres_agree_with_an_independent_integration() -> None:
    track = Track(line(60_000.0, **LONG))
    found = np.array([frame_at(track, s)[:3] for s in np.arange(1.0, 60_000.5)]).T
    error = np.abs(found - integrated(60_000.0)).max(axis=1)
    print(f"the line ends at {found[:, -1]} m and is nowhere off by more than {error} m")
    assert error.max() < 1e-7
    s = np.random.default_rng(1).uniform(0.0, 60_000.0, 500)
    h = 0.125
    for place in s:  # s is arc length: four-point derivative of the place by s
        a, b, c, d = (frame_at(track, place + k * h)[:3] for k in (-2, -1, 1, 2))
        assert np.linalg.norm((8.0 * (c - b) - (d - a)) / (12.0 * h)) == pytest.approx(1.0, abs=2e-8)


def test_the_frame_bends_without_jumps() -> None:
    """Second derivatives change over the nodes' spacing, though curvature kinks and vertical curvature jumps."""
    values = {
        "curves": [curve(120.3, 300.0, 100.0, cant_mm=120.0)],
        "gradients": [{"from_m": 500.7, "gradient_permille": -20.0, "rounding_m": 60.0}],
    }
    track = Track(line(700.0, **values))
    h = 0.02
    frames = np.array([frame_at(track, s) for s in np.arange(100.0, 600.0, h)])
    bend = np.diff(frames[:, :3], 2, axis=0) / h**2
    twist = np.diff(frames[:, 12]) / h
    sharpest = 0.02 / 60.0  # the jump of the vertical curvature in the design
    print(f"largest changes within {h} m: {np.abs(np.diff(bend, axis=0)).max():.1e} of {sharpest:.1e} 1/m, "
          f"{np.abs(np.diff(twist)).max():.1e} rad/m2")  # fmt: skip
    assert np.abs(np.diff(bend, axis=0)).max() < 0.05 * sharpest
    assert np.abs(np.diff(twist)).max() < 0.05 * 0.12 / 1.5 / 80.0


lengths = st.floats(20.0, 300.0)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(
        st.tuples(lengths, lengths, st.floats(0.0, 400.0), st.floats(0.0, 200.0), st.sampled_from(KINDS),
                  st.floats(150.0, 3000.0), st.sampled_from([-1.0, 1.0]), st.floats(-40.0, 60.0)),
        min_size=1, max_size=8,
    )
)  # fmt: skip
def test_any_line_turns_by_what_its_curves_add_up_to(stretches: list[tuple]) -> None:
    curves, at, turned = [], 50.0, 0.0
    for rise, fall, length, gap, kind, radius, side, cant in stretches:
        curves.append(
            {"start_m": at, "transition_in_m": rise, "transition_out_m": fall, "length_m": length,
             "radius_m": side * radius, "transition_kind": kind, "cant_mm": cant}
        )  # fmt: skip
        at += rise + length + fall + gap
        turned += side * (0.5 * rise + length + 0.5 * fall) / radius
    parameters = line(at + 60.0, curves=curves)
    track = Track(parameters)
    end = frame_at(track, at + 55.0)
    assert end[3:6] == pytest.approx([np.cos(turned), np.sin(turned), 0.0], abs=1e-8)
    s = np.linspace(0.0, at, 4000)
    largest = max(1.0 / c["radius_m"] if c["radius_m"] > 0 else -1.0 / c["radius_m"] for c in curves)
    assert np.abs(curvature_radpm(parameters, s)).max() <= largest * (1.0 + 1e-12)
    assert np.abs(track.cant_mm(s)).max() <= max(abs(c["cant_mm"]) for c in curves) + 1e-9
    heading = heading_rad(parameters, s)
    slopes = np.diff(heading) / np.diff(s)
    assert np.abs(slopes).max() <= largest * (1.0 + 1e-9)
