"""Presets and their refusal of nonsense; bounce modes. The published figures are cases of the verification."""

import tomllib

import pytest
from pydantic import ValidationError

from vehicle import COACH_PRESETS, CoachParameters
from vehicle.modes import bounce_frequencies_hz


@pytest.mark.parametrize("name", sorted(COACH_PRESETS))
def test_presets_are_valid(name: str) -> None:
    with COACH_PRESETS[name].open("rb") as file:
        CoachParameters.model_validate(tomllib.load(file))


def test_bounce_is_that_of_springs_in_series(parameters: CoachParameters) -> None:
    """Two masses on two springs, the independent formulation: body over secondary over bogies over primary."""
    k1, k2 = 8 * parameters.primary.stiffness_npm[2], 4 * parameters.secondary.stiffness_npm[2]
    m1, m2 = 2 * parameters.bogie.mass_kg, parameters.body.mass_kg
    half_sum = 0.5 * (k2 / m2 + (k1 + k2) / m1)
    root = (half_sum**2 - k1 * k2 / (m1 * m2)) ** 0.5
    expected = [((half_sum - root) ** 0.5) / 6.283185, ((half_sum + root) ** 0.5) / 6.283185]
    assert bounce_frequencies_hz(parameters) == pytest.approx(expected, rel=0.01)


BAD = [
    (("body", "mass_kg"), -1.0, "greater than 0"),
    (("body", "mass_kg"), float("nan"), "finite"),
    (("wheelbase_m",), 0.5, "must exceed wheelset.wheel_diameter_m"),
    (("bogie_distance_m",), 3.0, "overlap"),
    (("wheelset", "wheel_diameter_m"), 0.05, "greater than or equal to 0.3"),
    (("primary", "stiffness_npm"), [1e6, 1e6], "Field required"),
    (("primary", "vertical_damper"), {"x": [0.0, 1.0], "force_n": [0.0, 1.0, 2.0]}, "equally many"),
    (("primary", "vertical_damper"), {"x": [0.0, 1.0, 0.5], "force_n": [0.0, 1.0, 2.0]}, "increase"),
    (("primary", "vertical_damper"), {"x": [0.1, 1.0], "force_n": [0.0, 1.0]}, "start at 0"),
    (("body", "mass_lb"), 3.0, "Extra inputs"),
]


@pytest.mark.parametrize(("path", "value", "message"), BAD)
def test_bad_coaches_are_refused(path: tuple[str, ...], value: object, message: str) -> None:
    with COACH_PRESETS["malvezzi-2014"].open("rb") as file:
        tree = tomllib.load(file)
    table = tree
    for key in path[:-1]:
        table = table[key]
    table[path[-1]] = value
    with pytest.raises(ValidationError, match=message):
        CoachParameters.model_validate(tree)
