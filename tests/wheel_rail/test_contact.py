"""One conical wheelset on the track: statics, rolling, friction limit, energy."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.wheel_rail.rail_kinds import CONTACT
from tests.wheel_rail.test_track import TRACK, frame_at
from wheel_rail.contact import LONGITUDINAL, NORMAL, PENETRATION, SLIDE_POWER
from wheel_rail.contact_table import STIFFNESS
from wheel_rail.one_wheelset import wheelset_contact
from wheel_rail.recovery import CONDITION, DEGRADED, ENERGY, FALLING_A, MU0, RECOVERED, TAU

DRY = np.zeros(CONDITION)
DRY[DEGRADED:RECOVERED] = 0.55, 0.4, 0.6, 1.0, 0.4
CONSTANTS = CONTACT.constants


def contact(
    side: int, *, s_m: float = 100.0, lateral_m: float = 0.0, sink_m: float = 7e-4, yaw: float = 0.0, roll: float = 0.0,
    speed: float = 20.0, spin: float = 20.0 / 0.46, condition: np.ndarray = DRY,
    growth: tuple[float, float] = (0.0, 0.0),
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Normal and creep force (7,), the wheel's report, and the wheelset's generalised velocity."""
    frame = frame_at(TRACK, s_m)
    t, n, b = frame[3:6], frame[6:9], frame[9:12]
    axle = n - yaw * t + roll * b
    axle /= np.linalg.norm(axle)
    position = frame[:3] + lateral_m * n + (0.46 - sink_m) * b
    both = wheelset_contact(position, axle, speed * t, np.zeros(3), spin, frame, CONSTANTS, condition, growth)
    normal, creep, report = (wheels[0 if side > 0 else 1] for wheels in both)
    return normal, creep, report, np.concatenate([speed * t, np.zeros(3), [spin]])


def test_centred_wheels_carry_the_spring_force_inwards_by_the_cone() -> None:
    left, _, report, _ = contact(1)
    right, _, _, _ = contact(-1)
    cosine = 1.0 / math.sqrt(1.0 + 0.05**2)
    stiffness = CONSTANTS["table"][0, 0, STIFFNESS]
    assert 0.9e8 < stiffness < 1e8  # Hertz in series with a track of 1e8 N/m
    assert report[NORMAL] == pytest.approx(stiffness * 7e-4 * cosine, rel=1e-9)
    assert left[2] == pytest.approx(report[NORMAL] * cosine, rel=1e-9)
    assert left[1] == pytest.approx(-0.05 * left[2], rel=1e-9)
    assert right[1] == pytest.approx(-left[1], rel=1e-9)


def test_displacement_to_the_left_makes_the_left_wheel_larger() -> None:
    """Pure rolling needs omega (r0 + conicity y) = v: at that spin the left wheel transmits nothing along the rail."""
    y = 0.004
    _, creep, report, _ = contact(1, lateral_m=y, spin=20.0 / (0.46 + 0.05 * y))
    assert report[LONGITUDINAL] == pytest.approx(0.0, abs=2.0)
    _, _, right, _ = contact(-1, lateral_m=y, spin=20.0 / (0.46 + 0.05 * y))
    assert right[LONGITUDINAL] < -1000.0  # the smaller wheel's rim is too slow: the rail pulls it back
    assert creep[6] == pytest.approx(0.0, abs=2.0)


def test_braked_wheel_is_pulled_back_and_turned_on() -> None:
    _, creep, report, _ = contact(1, spin=19.0 / 0.46)
    assert report[LONGITUDINAL] < 0.0
    assert creep[6] == pytest.approx(-0.46 * report[LONGITUDINAL], rel=1e-6)


def test_wheel_in_the_air_has_no_force() -> None:
    normal, creep, report, _ = contact(1, sink_m=-1e-3)
    assert not normal.any()
    assert not creep.any()
    assert report[NORMAL] == 0.0


def test_a_constant_displacement_runs_through_a_curve_without_normal_power() -> None:
    """On cant ramp, in curve and transition the normal force of a wheel that follows its rail does no work."""
    for s_m in (350.0, 600.0, 750.0):
        for side in (1, -1):
            normal, _, _, _ = contact(side, s_m=s_m)
            frame = frame_at(TRACK, s_m)
            # velocity of a wheelset that follows the track: it turns with the track's frame
            step = 1e-4
            ahead = frame_at(TRACK, s_m + step)
            turn = np.cross(frame[3:12].reshape(3, 3), ahead[3:12].reshape(3, 3)).sum(axis=0) / (2.0 * step) * 20.0
            velocity = 20.0 * frame[3:6] + (0.46 - 7e-4) * np.cross(turn, frame[9:12])
            power = normal[:3] @ velocity + normal[3:6] @ turn
            assert abs(power) < 2e-6 * np.linalg.norm(normal[:3]) * 20.0


@settings(max_examples=300, deadline=None)
@given(
    st.sampled_from([1, -1]), st.floats(0.0, 2400.0), st.floats(-0.006, 0.006), st.floats(1e-5, 2e-3),
    st.floats(-0.01, 0.01), st.floats(0.0, 60.0), st.floats(-140.0, 140.0),
    st.sampled_from([0.0, 1.9e-4, 5e-4]), st.floats(0.0, 1e6),
)  # fmt: skip
def test_force_within_friction_and_never_driving(
    side: int, s_m: float, lateral_m: float, sink_m: float, yaw: float, speed: float, spin: float,
    tau_mpj: float, energy_jpm: float,
) -> None:  # fmt: skip
    """On rail that recovers (or does not), whatever was left on it: between nothing and the better curve's mu0 N."""
    condition = DRY.copy()
    condition[RECOVERED:TAU] = DRY[DEGRADED:RECOVERED]
    condition[DEGRADED + MU0] *= 0.2 if tau_mpj > 0.0 else 1.0
    condition[[DEGRADED + FALLING_A, RECOVERED + FALLING_A]] = 1.0  # friction that does not fall: the limit is mu0 N
    condition[TAU], condition[ENERGY] = tau_mpj, energy_jpm
    normal, creep, report, velocity = contact(
        side, s_m=s_m, lateral_m=lateral_m, sink_m=sink_m, yaw=yaw, speed=speed, spin=spin, condition=condition
    )
    if report[NORMAL] == 0.0:
        return
    assert np.linalg.norm(creep[:3]) <= condition[RECOVERED + MU0] * report[NORMAL] * (1.0 + 1e-9)
    # what the creep force takes from the wheelset is what the contact dissipates
    assert creep @ velocity == pytest.approx(-report[SLIDE_POWER], rel=1e-6, abs=1.0)
    # the normal force does not turn the wheel
    axle_torque = normal[6]
    assert axle_torque == 0.0


def test_a_swollen_wheel_presses_more_and_is_turned_back_by_what_it_lifts() -> None:
    """0.1 mm more radius is 0.1 mm more depth; a radius that grows by r' a radian takes N r' of torque."""
    plain, _, report, _ = contact(1)
    grown, _, swollen, _ = contact(1, growth=(1e-4, 0.0))
    cosine = 1.0 / np.sqrt(1.0 + 0.05**2)
    assert swollen[PENETRATION] - report[PENETRATION] == pytest.approx(1e-4 * cosine, rel=1e-6)
    assert plain[6] == grown[6] == 0.0
    turning, _, growing, _ = contact(1, growth=(0.0, 5e-4))
    assert turning[6] == pytest.approx(-growing[NORMAL] * 5e-4 * cosine, rel=1e-9)
    # it grows with the turning, 20/0.46 rad/s, and so the damper pushes
    more = CONTACT.parameters.damping_nspm * 5e-4 * cosine * 20.0 / 0.46
    assert growing[NORMAL] - report[NORMAL] == pytest.approx(more, rel=1e-9)
