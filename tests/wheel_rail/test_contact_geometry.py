"""Contact geometry: analytic contacts and invariants. Benchmark A-2.2 is among the cases of the verification."""

import numpy as np
import pytest

from wheel_rail.contact_geometry import (
    ContactGeometry,
    ContactGeometryParameters,
    ContactTable,
    relative_curvatures_1pm,
)
from wheel_rail.contact_search import (
    AHEAD,
    ALONG,
    ANGLE,
    CONICITY,
    RADIUS,
    TRACK_Y,
    TRACK_Z,
    TURN,
)

GRID = np.arange(-240, 241) * 5e-5


def geometry(wheels: tuple[str, str] = ("s1002", "s1002"), **changes: object) -> ContactGeometry:
    values: dict[str, object] = {
        "wheel_profiles": wheels,
        "rail_profiles": ("uic60", "uic60"),
        "rail_inclination": 1 / 40,
        "gauge_m": 1.435,
        "back_to_back_m": 1.36,
    }
    return ContactGeometry(ContactGeometryParameters.model_validate(values | changes), (0.46, 0.46))


@pytest.fixture(scope="module")
def pair() -> ContactGeometry:
    return geometry()


@pytest.fixture(scope="module")
def rigid(pair: ContactGeometry) -> ContactTable:
    return pair.table(GRID)


@pytest.fixture(scope="module")
def soft(pair: ContactGeometry) -> ContactTable:
    return pair.table(GRID, penetration_m=4.5e-5)


def cone_on_arcs(conicity: float, head_radius_m: float) -> ContactGeometry:
    """Conical wheels on circular rail heads, whose contact is known in closed form."""
    pair = geometry()
    y = np.arange(-0.03, 0.03, 5e-5)
    cone = np.stack([0.75 + y, 0.46 - conicity * y, np.full_like(y, -conicity), np.zeros_like(y)], axis=1)
    drop = head_radius_m - np.sqrt(head_radius_m**2 - y**2)
    head = np.stack([0.75 + y, -drop, -y / (head_radius_m - drop), np.full_like(y, 1.0 / head_radius_m)], axis=1)
    pair.wheels, pair.rails = [cone, cone], [head, head]
    return pair


def test_cones_on_circular_heads_touch_where_geometry_says() -> None:
    conicity, head = 0.05, 0.3
    table = cone_on_arcs(conicity, head).table(np.linspace(-0.008, 0.008, 9))
    cone = np.arctan(conicity)
    for side, sign in ((0, 1.0), (1, -1.0)):
        contact, roll = table.contacts[0, :, side], sign * table.roll_rad[0]
        # the cone leans by its angle and the roll, and the head's normal leans with it
        assert contact[:, ANGLE] == pytest.approx(cone + roll, abs=1e-8)
        assert contact[:, TRACK_Y] == pytest.approx(0.75 - head * np.sin(cone + roll), abs=1e-8)
        assert contact[:, TRACK_Z] == pytest.approx(head * (np.cos(cone + roll) - 1.0), abs=1e-9)
        # back from the track to the axle
        dy, dz = contact[:, TRACK_Y] - sign * table.lateral_displacement_m, contact[:, TRACK_Z] - table.height_m[0]
        assert contact[:, ALONG] == pytest.approx(dy * np.cos(roll) + dz * np.sin(roll), abs=1e-9)
        assert contact[:, RADIUS] == pytest.approx(dy * np.sin(roll) - dz * np.cos(roll), abs=1e-9)
        assert contact[:, RADIUS] == pytest.approx(0.46 - conicity * (contact[:, ALONG] - 0.75), abs=1e-12)
    curvatures = relative_curvatures_1pm(table.contacts)
    assert curvatures[..., 1] == pytest.approx(1.0 / head, rel=1e-9)
    assert curvatures[..., 0] == pytest.approx(np.cos(cone) / table.contacts[..., RADIUS], rel=1e-9)


def test_a_yawed_cone_touches_ahead_of_the_axle_and_stands_lower() -> None:
    """In closed form: x of the locus, and to second order the loss of height c (along - r c) yaw^2/2."""
    conicity, yaw = 0.05, 0.02
    pair = cone_on_arcs(conicity, 0.3)
    straight = pair.table(np.zeros(1))
    turned = pair.table(np.zeros(1), np.array([yaw]))
    left = turned.contacts[0, 0, 0]
    sine = conicity * np.tan(yaw)
    expected = -left[ALONG] * np.sin(yaw) + left[RADIUS] * sine * np.cos(yaw)
    assert left[AHEAD] == pytest.approx(expected, rel=1e-9)
    assert turned.contacts[0, 0, 1, AHEAD] == pytest.approx(-expected, rel=1e-9)
    assert left[TURN] == pytest.approx(-np.arcsin(np.sin(yaw) * np.sqrt(1.0 + conicity**2)), rel=1e-9)
    # a turned axle reaches its rails further out, where cones are thinner
    lost = 0.5 * conicity * yaw**2 * (left[ALONG] - left[RADIUS] * conicity)
    assert straight.height_m[0, 0] - turned.height_m[0, 0] == pytest.approx(lost, rel=0.002)


def test_both_bodies_touch_and_share_the_normal(pair: ContactGeometry, rigid: ContactTable) -> None:
    """At every row of the table: no overlap anywhere, contact at the stated place, slopes of wheel and rail agree."""
    for i in range(0, GRID.size, 7):
        y, roll, height = GRID[i], rigid.roll_rad[0, i], rigid.height_m[0, i]
        for side, sign in ((0, 1.0), (1, -1.0)):
            wheel, rail = pair.wheels[side], pair.rails[side]
            c, s = np.cos(sign * roll), np.sin(sign * roll)
            wy = sign * y + wheel[:, 0] * c + wheel[:, 1] * s
            wz = height + wheel[:, 0] * s - wheel[:, 1] * c
            gap = np.interp(wy, rail[:, 0], rail[:, 1], left=-1.0, right=-1.0) - wz
            # straight lines between nodes cut the corner radius of 13 mm by 4e-8 m
            assert np.max(gap) == pytest.approx(0.0, abs=2e-7)
            contact = rigid.contacts[0, i, side]
            assert np.arctan(contact[CONICITY]) == pytest.approx(contact[ANGLE] - sign * roll, abs=1e-4)


def test_mirrored_displacement_mirrors_the_contact(rigid: ContactTable, soft: ContactTable) -> None:
    for table in (rigid, soft):
        assert table.contacts[0, ::-1, 0] == pytest.approx(table.contacts[0, :, 1], abs=1e-4)
        assert table.roll_rad[0, ::-1] == pytest.approx(-table.roll_rad[0], abs=1e-8)


def test_the_flange_is_reached(rigid: ContactTable) -> None:
    """The play of S1002 in 1435 mm is about 6 mm; there the contact climbs from the tread to the 70 degree face."""
    angle = np.degrees(rigid.contacts[0, :, 0, ANGLE])
    assert np.max(angle[GRID < 0.005]) < 10.0
    assert np.max(angle) == pytest.approx(70.1, abs=0.3)
    assert GRID[np.argmax(angle > 45.0)] == pytest.approx(0.0063, abs=0.0002)


def test_jumps_are_reported_once_each_and_symmetric(rigid: ContactTable, soft: ContactTable) -> None:
    left = [j for j in rigid.jumps if j.side == "left"]
    right = [j for j in rigid.jumps if j.side == "right"]
    assert len(left) == 3
    for a, b in zip(left, reversed(right), strict=True):
        assert a.lateral_displacement_m == pytest.approx(-b.lateral_displacement_m, abs=1e-7)
        assert (a.from_m, a.to_m) == pytest.approx((b.to_m, b.from_m), abs=1e-5)
    moves = np.abs(np.diff(rigid.contacts[0, :, 0, ALONG]))
    for jump in left:
        at = int(np.searchsorted(GRID, jump.lateral_displacement_m)) - 1
        assert moves[at] > 0.9 * abs(jump.to_m - jump.from_m) > 9e-4
    assert soft.jumps == ()


def test_the_soft_contact_is_the_derivative_of_the_height(pair: ContactGeometry) -> None:
    """Work along the table: pushing by dy needs sum of N tan(angle) dy, which lifts the wheelset by as much energy.

    With equal loads on level arms: height' = (tan(left) - tan(right))/2 up to the small rolling of the load.
    """
    fine = np.linspace(-0.004, 0.004, 3201)
    table = pair.table(fine, penetration_m=4.5e-5, level=True)
    slope = np.tan(table.contacts[0, :, :, ANGLE])
    work = 0.5 * (slope[:, 0] - slope[:, 1])
    lifted = np.gradient(table.height_m[0], fine)
    assert np.max(np.abs(work - lifted)[1:-1]) < 2e-5


def test_less_penetration_comes_to_the_rigid_contact(pair: ContactGeometry) -> None:
    calm = np.array([0.0015, 0.003, 0.0075, -0.0015, -0.003, -0.0075])[np.argsort([3, 4, 5, 2, 1, 0])]
    hard = pair.table(calm)
    errors = [
        float(np.max(np.abs(pair.table(calm, penetration_m=p).wheel_position_m - hard.wheel_position_m)))
        for p in (1.2e-5, 3e-6, 1e-6)
    ]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 5e-5


def test_unequal_wheels_run_off_centre() -> None:
    """1 mm of difference in radius rolls the wheelset by 1 mm over the contact spacing."""
    p = ContactGeometryParameters(
        wheel_profiles=("s1002", "s1002"),
        rail_profiles=("uic60", "uic60"),
        rail_inclination=1 / 20,
        gauge_m=1.435,
        back_to_back_m=1.36,
    )
    table = ContactGeometry(p, (0.4605, 0.4595)).table(np.zeros(1))
    assert table.rolling_radius_difference_m[0, 0] == pytest.approx(0.001, abs=1e-4)
    assert table.roll_rad[0, 0] == pytest.approx(0.001 / 1.5, rel=0.1)


def test_bad_arguments_are_named(pair: ContactGeometry) -> None:
    for bad in (np.array([0.0, 0.0]), np.array([np.nan]), np.array([0.2])):
        with pytest.raises(ValueError, match="lateral_displacement_m"):
            pair.table(bad)
    with pytest.raises(ValueError, match="yaw_rad"):
        pair.table(np.zeros(1), np.array([1.0]))
    with pytest.raises(ValueError, match="penetration_m"):
        pair.table(np.zeros(1), penetration_m=-1e-6)
    with pytest.raises(ValueError, match=r"60\.000 mm"):
        pair.table(np.array([0.06]))
    with pytest.raises(ValueError, match="wheel_radii_m"):
        ContactGeometry(
            ContactGeometryParameters(
                wheel_profiles=("s1002", "s1002"),
                rail_profiles=("uic60", "uic60"),
                rail_inclination=0.025,
                gauge_m=1.435,
                back_to_back_m=1.36,
            ),
            (46.0, 0.46),
        )
