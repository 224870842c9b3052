"""Bad values in the sections of wheel and rail: one clear fault each, with file and key, and never a traceback."""

from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenarios.errors import BadInput, Fault
from scenarios.scenario_file import load_scenario

RECOVERING = {"from_m": 0.0, "recovery": "low-recovering", "peak_adhesion": 0.07}
SLIPPERY = {"from_m": 0.0, "surface": "low", "peak_adhesion": 0.07}
PATCHES = {"length_m": 10.0, "from_m": 100.0, "to_m": 200.0, "spacing_m": 50.0, "surface": "low"}
BASE: dict[str, Any] = {
    "scenario": {"extends": "low-adhesion-stop"},
    "coach": {"contact": {"geometry": "conical", "profiles": {}, "conical": {}}},
    "adhesion": {
        "stretches": [RECOVERING, {**SLIPPERY, "from_m": 500.0}],
        "patches": [PATCHES],
        "memory": {"distance_m": 1e-5},
    },
    "creep_law": {"name": "modified-fastsim", "parameters": {}},
    "sanding": {"sanders": [{"wheelset": 1}], "effect": {}},
}
CONTACT_NUMBERS = (
    "shear_modulus_pa", "poisson", "track_stiffness_npm", "damping_nspm", "flange_stiffness_npm", "creep_speed_mps",
    "profiles.rail_inclination", "profiles.gauge_m", "profiles.back_to_back_m",
    "conical.conicity", "conical.rail_head_radius_m", "conical.flange_clearance_m",
)  # fmt: skip
NUMBERS = [
    *(f"coach.contact.{key}" for key in CONTACT_NUMBERS),
    *(f"adhesion.stretches.0.{key}" for key in ("from_m", "peak_adhesion", "spread", "correlation_length_m",
                                               "rails_correlation")),
    *(f"adhesion.patches.0.{key}" for key in ("length_m", "from_m", "to_m", "spacing_m", "peak_adhesion")),
    "adhesion.memory.distance_m",
    *(f"creep_law.parameters.{key}" for key in ("nx", "ny", "k0", "alpha_inf", "beta")),
    *(f"sanding.sanders.0.{key}" for key in ("wheelset", "offset_m", "rate_gps", "delay_s")),
    *(f"sanding.effect.{key}" for key in ("sanded_adhesion", "effective_gpm", "left_share")),
]  # fmt: skip
NAMES = [
    "coach.contact.geometry", "coach.contact.profiles.wheel_profile", "coach.contact.profiles.rail_profile",
    "adhesion.stretches.0.surface", "adhesion.stretches.0.recovery", "adhesion.stretches.0.speed_law",
    "adhesion.stretches.0.file", "adhesion.patches.0.rails", "adhesion.rail_state_file", "creep_law.name",
]  # fmt: skip
TABLES_OR_ARRAYS = [
    "coach.contact", "coach.contact.conical", "coach.contact.profiles", "adhesion", "adhesion.stretches",
    "adhesion.stretches.0", "adhesion.patches", "adhesion.patches.0", "adhesion.memory", "creep_law",
    "creep_law.parameters", "sanding", "sanding.sanders", "sanding.sanders.0", "sanding.effect",
]  # fmt: skip
# no length, rate, share or modulus lies below -10
NO_NUMBER = st.one_of(
    st.floats(-1e300, -10.5), st.sampled_from([float("nan"), float("inf"), -float("inf")]), st.booleans(),
    st.text(max_size=4), st.just([]), st.dates(),
)  # fmt: skip
NO_NAME = st.one_of(st.integers(-9, 9), st.floats(0.0, 1.0), st.booleans(), st.just([1]), st.dates())
NO_TABLE = st.one_of(st.integers(-9, 9), st.booleans(), st.text(max_size=4), st.dates())
BAD = st.one_of(
    st.tuples(st.sampled_from(NUMBERS), NO_NUMBER),
    st.tuples(st.sampled_from(NAMES), NO_NAME),
    st.tuples(st.sampled_from(TABLES_OR_ARRAYS), NO_TABLE),
)


def with_value(dotted: str, value: Any) -> dict[str, Any]:
    """BASE with another value at the key."""

    def put(tree: Any, path: list[str]) -> Any:
        if not path:
            return value
        head, *rest = path
        if isinstance(tree, list):
            return [put(entry, rest) if str(k) == head else entry for k, entry in enumerate(tree)]
        return {**tree, head: put(tree.get(head, {}), rest)}

    tree: dict[str, Any] = put(BASE, dotted.split("."))
    return tree


def only_fault(folder: Path, tree: dict[str, Any]) -> Fault:
    path = folder / "my.toml"
    path.write_text(tomli_w.dumps(tree), encoding="utf-8")
    with pytest.raises(BadInput) as caught:
        load_scenario(path)
    (fault,) = caught.value.faults
    assert fault.source == str(path)
    assert "\n" not in str(fault)
    return fault


def test_what_the_bad_values_stand_in_is_good(tmp_path: Path) -> None:
    path = tmp_path / "my.toml"
    path.write_text(tomli_w.dumps(BASE), encoding="utf-8")
    assert len(load_scenario(path).adhesion.stretches) == 2


@settings(deadline=None, max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(BAD)
def test_a_bad_value_is_one_fault_with_its_key(tmp_path: Path, bad: tuple[str, Any]) -> None:
    key, value = bad
    fault = only_fault(tmp_path, with_value(key, value))
    assert f"my.toml: {key}" in str(fault)


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(TABLES_OR_ARRAYS), st.text("abcxyz_", min_size=1, max_size=8))
def test_an_unknown_key_is_one_fault_with_the_known_ones(tmp_path: Path, table: str, name: str) -> None:
    where = f"{table}.0" if table in ("adhesion.stretches", "adhesion.patches", "sanding.sanders") else table
    key = f"{where}.x{name}"
    fault = only_fault(tmp_path, with_value(key, 1.0))
    assert f"my.toml: {key}: unknown key; " in str(fault)
    assert "known here: " in str(fault)
