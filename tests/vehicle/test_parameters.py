"""Presets and their refusal of nonsense; bounce modes. The published figures are cases of the verification."""

import copy
import tomllib
from typing import Any

import pytest
from pydantic import ValidationError

from tests.vehicle.conftest import coach_of
from vehicle import COACH_PRESETS, CoachParameters
from vehicle.elements import ELEMENTS, GRAVITY_MPS2
from vehicle.layout import coach_record, masses
from vehicle.modes import bounce_frequencies_hz
from wheel_rail import Contact


def tree_of(name: str = "malvezzi-2014") -> dict[str, Any]:
    with COACH_PRESETS[name].open("rb") as file:
        return tomllib.load(file)


def record_of(coach: CoachParameters) -> Any:
    contact = Contact(coach.contact, 0.5 * coach.wheelset.wheel_diameter_m, coach.static_wheel_load_n)
    return coach_record(coach, contact)[0]


@pytest.mark.parametrize("boxes", ["lumped", "explicit"])
@pytest.mark.parametrize("name", sorted(COACH_PRESETS))
def test_every_preset_makes_a_coach_in_both_forms(name: str, boxes: str) -> None:
    """Masses add up to the coach's, and every spring carries what stands on it."""
    coach = coach_of(name, axle_boxes=boxes)
    record = record_of(coach)
    assert record["elements"] <= ELEMENTS
    assert record["mass"].sum() == pytest.approx(coach.mass_kg)
    assert (masses(record) > 0.0).all()
    carried = dict.fromkeys(range(record["bodies"]), 0.0)
    for e in range(record["elements"]):
        carried[int(record["upper"][e])] += record["preload"][e]
        carried[int(record["lower"][e])] -= record["preload"][e]
    for body in range(record["bodies"]):
        if not 3 <= body < 7:
            assert carried[body] == pytest.approx(record["mass"][body] * GRAVITY_MPS2), body


def test_inertias_of_wheelset_and_boxes_add_up_in_both_forms() -> None:
    lumped, explicit = (record_of(coach_of(axle_boxes=form)) for form in ("lumped", "explicit"))
    boxes = explicit["inertia"][7:9].sum(axis=0)
    boxes[[0, 2]] += 2.0 * 100.0 * 1.0**2  # Steiner's part of two boxes of 100 kg, 1 m off
    assert explicit["inertia"][3] + boxes == pytest.approx(lumped["inertia"][3])


def test_bounce_is_that_of_springs_in_series(parameters: CoachParameters) -> None:
    """Two masses on two springs, the independent formulation: body over secondary over bogies over primary.

    The primary stiffness of a box: its coil spring, and the turning of its arm over 0.7 m against 20.4 kNm/rad.
    """
    arm = 1.0 / (1.0 / 4e6 + 0.7**2 / 20_400.0)
    k1, k2 = 8 * (790_000.0 + arm), 4 * parameters.secondary.stiffness_npm[2]
    m1, m2 = 2 * parameters.bogie.mass_kg, parameters.body.mass_kg
    half_sum = 0.5 * (k2 / m2 + (k1 + k2) / m1)
    root = (half_sum**2 - k1 * k2 / (m1 * m2)) ** 0.5
    expected = [((half_sum - root) ** 0.5) / 6.283185, ((half_sum + root) ** 0.5) / 6.283185]
    assert bounce_frequencies_hz(parameters) == pytest.approx(expected, rel=0.01)


BAD: list[tuple[dict[str, Any], str]] = [
    ({"body.mass_kg": -1.0}, "greater than 0"),
    ({"body.mass_kg": float("nan")}, "finite"),
    ({"body.mass_lb": 3.0}, "Extra inputs"),
    ({"wheelbase_m": 0.5}, "must exceed wheelset.wheel_diameter_m"),
    ({"bogie_distance_m": 3.0}, "overlap"),
    ({"wheelset.wheel_diameter_m": 0.05}, "greater than or equal to 0.3"),
    ({"primary.stiffness_npm": [1e6, 1e6]}, "Field required"),
    ({"characteristics.yaw-damper.force_n": [0.0, 1.0]}, "force_n: has 2 points, speed_mps has 3"),
    ({"characteristics.yaw-damper.speed_mps": [0.0, 1.0, 0.5]}, r"speed_mps = \[0.0, 1.0, 0.5\]: must increase"),
    ({"characteristics.yaw-damper.speed_mps": [0.1, 0.5, 1.0]}, "must start at 0"),
    ({"characteristics.yaw-damper.force_n": [0.0, 9.0, 1.0]}, "force_n = .*: must not fall"),
    ({"characteristics.yaw-damper.deflection_m": [0.0, 0.1, 0.2]}, "give it or speed_mps"),
    ({"characteristics.yaw-damper.source": ""}, "at least 1 character"),
    ({"yaw_dampers.damper": "yaw-dampr"}, "yaw_dampers.damper = 'yaw-dampr': no such characteristic; there are prim"),
    ({"secondary.lateral_stop": "yaw-damper"}, "secondary.lateral_stop = 'yaw-damper': must be .* over deflection_m"),
    ({"primary.rotational_stiffness_nmprad": [0, 0, 0], "axle_box.swing_arm": None}, "pitch of the axle boxes .* held"),
    ({"axle_box.swing_arm.damping_nspm": [15e3, 2e3, 0]}, "swing_arm.damping_nspm .* pitch of .* would not be damped"),
    ({"axle_box.swing_arm.damping_nspm": [15e3, 0, 4e3]}, "primary.damping_nspm .* lateral swaying of wheelsets"),
    (
        {"secondary.lateral_damper": None},
        "secondary.damping_nspm .* lateral axis.*: sway and yaw of the body would not",
    ),
    (
        {"secondary.vertical_damper": None},
        "secondary.damping_nspm .*: bounce and pitch of the body would not be damped",
    ),
    ({"traction_rod": None, "secondary.stiffness_npm": [0, 124e3, 340e3]}, "traction_rod.stiffness_npm: is missing"),
    ({"axle_box.mass_kg": 750.0}, "axle_box.mass_kg = 750.0: two boxes weigh as much as wheelset.mass_kg = 1500"),
    ({"axle_box.mass_kg": 460.0}, "axle_box.yaw_inertia_kgm2 = 8.0: two boxes at .* which holds them"),
    ({"axle_box.swing_arm.length_m": 1.3}, "swing_arm.length_m = 1.3: must be below half of wheelbase_m"),
    ({"axle_box.bearing": None, "axle_boxes": "explicit"}, "axle_box.bearing: is missing"),
    ({"axle_boxes": "both"}, "'lumped' or 'explicit'"),
    ({"load": "crushed"}, "load = 'crushed': no such load; there are empty, seated, crush"),
    ({"loads.crush.height_m": 2.4}, "loads.crush.height_m = 2.4: the payload would reach 3.55 m, above saloon.roof"),
    ({"loads.crush.height_m": 1.2}, "loads.crush.height_m = 1.2: lies below saloon.floor_height_m = 1.25"),
    ({"loads.crush.mass_kg": -5.0}, "greater than 0"),
    ({"saloon": None}, "loads.seated.inertia_kgm2: is missing"),
    ({"loads.crush.inertia_kgm2": [1e3, -1e3, 1e3]}, "loads.crush.inertia_kgm2 = .*: must be greater than 0"),
    ({"loads.empty": {"mass_kg": 1.0, "height_m": 1.9}}, "loads.empty: every coach has this load"),
    ({"wheels.diameter_m": [0.92] * 7}, "Field required"),
    ({"wheels.diameter_m": [0.92] * 7 + [0.8]}, r"wheels.diameter_m.7 = 0.8: must be within 10 %"),
    ({"wheels.out_of_roundness": [{"wheel": "5L", "order": 1, "amplitude_m": 1e-3}]}, "'1L', '1R'"),
    ({"wheels.out_of_roundness": [{"wheel": "1L", "order": 1, "amplitude_m": 1e-4}] * 9}, "1L has more than 8"),
]


@pytest.mark.parametrize(("changes", "message"), BAD)
def test_bad_coaches_are_refused(changes: dict[str, Any], message: str) -> None:
    tree = copy.deepcopy(tree_of())
    for path, value in changes.items():
        table = tree
        *tables, key = path.split(".")
        for name in tables:
            table = table.setdefault(name, {})
        if value is None:
            del table[key]
        else:
            table[key] = value
    with pytest.raises(ValidationError, match=message):
        CoachParameters.model_validate(tree)


def test_primary_vertical_damping_is_wanted_where_no_arm_has_any() -> None:
    tree = tree_of("manchester-1")
    tree["primary"]["damping_nspm"] = [15e3, 2e3, 0.0]
    with pytest.raises(ValidationError, match="bounce and pitch of the bogies would not be damped"):
        CoachParameters.model_validate(tree)
    tree["primary"]["vertical_friction"] = "leaf"
    tree["characteristics"]["leaf"] = {"speed_mps": [0.0, 0.02, 1.0], "force_n": [0.0, 2e3, 2e3], "source": "test"}
    CoachParameters.model_validate(tree)
