"""The contact as the coach reads it: profiles and cones in one table over lateral displacement."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from tests.wheel_rail.rail_kinds import CONTACT as CONES
from wheel_rail import Contact, ContactParameters
from wheel_rail.contact import PENETRATION
from wheel_rail.contact_geometry import ContactGeometry
from wheel_rail.contact_search import CONICITY
from wheel_rail.contact_table import (
    FLANGE_SLOPE,
    NODES,
    PLACE_ALONG,
    RAIL_Y,
    RAIL_Z,
    ROLLING_RADIUS,
    SEMI_AXIS_A,
    SEMI_AXIS_B,
    SLOPE,
    STIFFNESS,
)
from wheel_rail.one_wheelset import wheelset_contact
from wheel_rail.recovery import CONDITION

RADIUS_M, LOAD_N = 0.46, 68_670.0
PENETRATION_M = 45e-6
"""Depth of overlap at which the table reads the profiles: Hertz' approach at this load, shared out over the patch."""
SHEAR_PA, POISSON, TRACK_NPM = 82e9, 0.28, 1e8
COMMON = {
    "shear_modulus_pa": SHEAR_PA, "poisson": POISSON, "track_stiffness_npm": TRACK_NPM, "damping_nspm": 3e4,
    "flange_stiffness_npm": 1e7, "creep_speed_mps": 0.2,
}  # fmt: skip
USUAL = {
    "wheel_profile": "s1002", "rail_profile": "uic60", "rail_inclination": 0.025, "gauge_m": 1.435,
    "back_to_back_m": 1.36,
}  # fmt: skip


def on_profiles(**changes: object) -> Contact:
    values = {"geometry": "profiles", "profiles": USUAL | changes, **COMMON}
    return Contact(ContactParameters.model_validate(values), RADIUS_M, LOAD_N)


@pytest.fixture(scope="module")
def profiles() -> Contact:
    return on_profiles()


@pytest.fixture(scope="module")
def geometry(profiles: Contact) -> ContactGeometry:
    assert profiles.parameters.profiles is not None
    return ContactGeometry(profiles.parameters.profiles.geometry, (RADIUS_M, RADIUS_M))


def penetration(contact: Contact, y_m: float, height_m: float, roll_rad: float) -> list[float]:
    """How deep left and right wheel stand in straight level rails, by the compiled contact."""
    frame = np.zeros(14)
    frame[[3, 7, 11]] = 1.0
    axle = [0.0, math.cos(roll_rad), math.sin(roll_rad)]
    condition = np.full(CONDITION, 0.1)
    _, _, report = wheelset_contact(
        [0.0, y_m, height_m], axle, [20.0, 0.0, 0.0], np.zeros(3), 20.0 / RADIUS_M, frame, contact.constants, condition
    )
    return list(report[:, PENETRATION])


def test_a_wheelset_let_down_just_touches_on_both_sides(profiles: Contact, geometry: ContactGeometry) -> None:
    """Anywhere in the table, between its nodes as well; 45 um is how deep a loaded wheel stands."""
    limit = float(profiles.constants["flange_clearance_m"])
    y_m = np.sort(np.random.default_rng(1).uniform(-limit, limit, 300))
    table = geometry.table(y_m, penetration_m=PENETRATION_M)
    depth = np.array(
        [penetration(profiles, *pose) for pose in zip(y_m, table.height_m[0], table.roll_rad[0], strict=True)]
    )
    print(f"largest gap or penetration {1e6 * np.abs(depth).max():.2g} um")
    assert np.abs(depth).max() < 0.5e-6


def test_a_rigid_wheelset_stands_as_high_within_what_the_load_presses_in(
    profiles: Contact, geometry: ContactGeometry
) -> None:
    limit = float(profiles.constants["flange_clearance_m"])
    y_m = np.linspace(-limit, limit, 61)
    table = geometry.table(y_m)
    depth = np.array(
        [penetration(profiles, *pose) for pose in zip(y_m, table.height_m[0], table.roll_rad[0], strict=True)]
    )
    assert np.abs(depth).max() < PENETRATION_M


def test_left_and_right_mirror_each_other(profiles: Contact) -> None:
    for contact in (profiles, CONES):
        left, right = contact.constants["table"]
        scale = np.abs(left).max(axis=0)
        assert np.abs(left - right[::-1]).max(axis=0) == pytest.approx(0.0, abs=1e-8 * scale.max())
        assert np.all(np.abs(left - right[::-1]) <= 1e-8 * scale)


def test_the_table_ends_where_the_flange_begins(profiles: Contact, geometry: ContactGeometry) -> None:
    constants = profiles.constants
    limit = float(constants["flange_clearance_m"])
    slopes = constants["table"][:, :, SLOPE]
    assert constants["first_m"] == -limit
    assert constants["first_m"] + (NODES - 1) / constants["nodes_per_m"] == pytest.approx(limit, rel=1e-12)
    assert slopes.max() <= FLANGE_SLOPE
    assert slopes.max() == pytest.approx(slopes[0, -1], rel=1e-9)  # the left wheel, displaced to the left
    a_bit_further = geometry.table(np.array([limit + 1e-4]), penetration_m=PENETRATION_M)
    assert a_bit_further.contacts[0, 0, 0, CONICITY] > FLANGE_SLOPE
    assert 0.004 < limit < 0.008  # new profiles at nominal gauge


def test_a_displaced_wheelset_rolls_up_on_the_side_to_which_it_moves(profiles: Contact) -> None:
    left = profiles.constants["table"][0]
    assert left[-1, ROLLING_RADIUS] > left[NODES // 2, ROLLING_RADIUS] > left[0, ROLLING_RADIUS]
    assert left[NODES // 2, ROLLING_RADIUS] == pytest.approx(RADIUS_M, abs=1e-4)


def test_cones_are_linear() -> None:
    constants = CONES.constants
    y_m = CONES.displacement_m
    for table, sign in zip(constants["table"], (1.0, -1.0), strict=True):
        assert table[:, ROLLING_RADIUS] == pytest.approx(RADIUS_M + 0.05 * sign * y_m, rel=1e-15)
        assert np.all(table[:, SLOPE] == 0.05)
        assert table[:, PLACE_ALONG] == pytest.approx(table[:, RAIL_Y] - sign * y_m, rel=1e-15)
        assert np.all(table[:, RAIL_Z] == 0.0)
        assert np.ptp(table[:, STIFFNESS]) == 0.0


def hertz(load_n: float, radius_1_m: float, radius_2_m: float) -> tuple[float, float, float]:
    """Larger and smaller semi-axis and approach of crossed cylinders of steel: K. L. Johnson, Contact Mechanics, 4.2.

    With A < B half the relative curvatures: B/A = ((a/b)^2 E(e) - K(e))/(K(e) - E(e)), p0 = 3 P/(2 pi a b),
    A = p0/E* b/(e^2 a^2) (K - E), approach = p0/E* b K.
    """
    low, high = sorted((0.5 / radius_1_m, 0.5 / radius_2_m))
    modulus = SHEAR_PA / (1.0 - POISSON)

    def miss(m: float) -> float:
        k, e = ellipk(m), ellipe(m)
        return float((e / (1.0 - m) - k) / (k - e) - high / low)

    m = brentq(miss, 1e-9, 0.999)
    k, e = ellipk(m), ellipe(m)
    ratio = math.sqrt(1.0 - m)  # b/a
    # A a^3 = 3 P/(2 pi E*) (K - E)/e^2
    a = (1.5 * load_n / (math.pi * modulus) * (k - e) / m / low) ** (1.0 / 3.0)
    return a, ratio * a, 1.5 * load_n / (math.pi * a * modulus) * k


def test_normal_stiffness_is_hertz_in_series_with_the_track() -> None:
    row = CONES.at_load(LOAD_N).constants["table"][0, 0]
    a, b, approach = hertz(LOAD_N, RADIUS_M, 0.3)
    # the wheel is the flatter one: the ellipse is longer along the rail
    assert (row[SEMI_AXIS_A], row[SEMI_AXIS_B]) == pytest.approx((a, b), rel=1e-6)
    # approach grows with load^(2/3)
    assert 1.0 / row[STIFFNESS] == pytest.approx(approach / (1.5 * LOAD_N) + 1.0 / TRACK_NPM, rel=1e-6)


def test_a_stiffer_track_leaves_the_contacts_own_stiffness(profiles: Contact) -> None:
    values = {"geometry": "profiles", "profiles": USUAL, **COMMON, "track_stiffness_npm": 1e9}
    stiff = Contact(ContactParameters.model_validate(values), RADIUS_M, LOAD_N).constants["table"][..., STIFFNESS]
    soft = profiles.constants["table"][..., STIFFNESS]
    assert 1.0 / soft - 1.0 / stiff == pytest.approx(np.full(soft.shape, 1.0 / TRACK_NPM - 1e-9), rel=1e-9)


def test_the_nominal_load_sets_the_ellipse_and_nothing_of_the_shape(profiles: Contact) -> None:
    heavy = profiles.at_load(2.0 * LOAD_N).constants["table"]
    usual = profiles.constants["table"]
    assert np.array_equal(heavy[..., :SEMI_AXIS_A], usual[..., :SEMI_AXIS_A])
    assert heavy[..., SEMI_AXIS_A] / usual[..., SEMI_AXIS_A] == pytest.approx(
        np.full(usual.shape[:2], 2.0 ** (1.0 / 3.0)), rel=1e-9
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"gauge_m": 1.6}, r"contact.profiles.gauge_m = 1.6: .*end of its profile"),
        ({"gauge_m": 1.47}, r"contact.profiles.gauge_m = 1.47: .*the flange does not meet the rail"),
        ({"gauge_m": 1.425}, r"contact.profiles.gauge_m = 1.425: .*the flange does not meet the rail"),
        ({"back_to_back_m": 1.3}, r"contact.profiles.gauge_m = 1.435: with back_to_back_m = 1.3, "),
        ({"wheel_profile": "s1003"}, r"contact.profiles.wheel_profile = s1003: .*one of s1002, en15302-a, or a file"),
        ({"rail_profile": "gone.txt"}, r"contact.profiles.rail_profile = gone.txt: .*cannot be read as a profile"),
    ],
)
def test_what_does_not_fit_is_refused_with_the_key(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        _ = on_profiles(**changes).constants
