"""Scenario files: what is read, what is refused and with which words, and what is written back."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenarios.errors import BadInput
from scenarios.names import TABLES
from scenarios.scenario_file import dump_scenario, load_scenario

BUILT_IN = "low-adhesion-stop"

Write = Callable[[str], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """A file my.toml with the given text."""

    def written(text: str) -> Path:
        path = tmp_path / "my.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return written


def extending(text: str) -> str:
    return f'[scenario]\nextends = "{BUILT_IN}"\n{text}'


def refusal(source: str | Path, *settings: str) -> str:
    with pytest.raises(BadInput) as caught:
        load_scenario(source, settings)
    return str(caught.value)


@pytest.mark.parametrize("name", sorted(TABLES["scenario"]()))
def test_built_in_scenarios_are_valid_and_survive_being_written(name: str, tmp_path: Path) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    path = tmp_path / "resolved.toml"
    path.write_text(dump_scenario(scenario), encoding="utf-8")
    again = load_scenario(path)
    assert again == scenario.model_copy(update={"presets": {}})
    assert dump_scenario(again) == path.read_text(encoding="utf-8")


def test_a_file_may_hold_only_what_differs(write: Write) -> None:
    base = load_scenario(BUILT_IN)
    path = write(extending("[simulation]\ninitial_speed_kmh = 160\n[coach.body]\nmass_kg = 41000.0\n"))
    scenario = load_scenario(path)
    assert scenario.name == "my"
    assert scenario.simulation.initial_speed_kmh == 160.0
    assert scenario.coach.body.mass_kg == 41_000.0
    assert scenario.coach.body.height_m == base.coach.body.height_m
    assert scenario.track == base.track


def test_extends_goes_through_files_relative_to_each(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "root.toml").write_text(extending("[balises]\nspacing_m = 500.0\nfirst_m = 700.0\n"))
    (tmp_path / "deep" / "leaf.toml").write_text('[scenario]\nextends = "../root.toml"\n[balises]\nfirst_m = 800.0\n')
    scenario = load_scenario(tmp_path / "deep" / "leaf.toml")
    assert (scenario.balises.spacing_m, scenario.balises.first_m) == (500.0, 800.0)
    assert scenario.name == "leaf"


def test_extends_in_a_circle_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text('[scenario]\nextends = "b.toml"\n')
    (tmp_path / "b.toml").write_text('[scenario]\nextends = "a.toml"\n')
    assert "circle" in refusal(tmp_path / "a.toml")


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ('extends = "test-path"\n[brake]\nfull_service_pressure_bar = 3.8\n', "extends"),
        ('extends = "test-path"\n[scenario]\ntitle = "t"\n', "extends"),
        ('[brake]\nextends = "test-path"\n', "brake.extends"),
    ],
)
def test_extends_in_the_wrong_place_is_the_one_fault_that_is_told(text: str, key: str, write: Write) -> None:
    path = write(text)
    assert refusal(path) == f"{path}: {key} = 'test-path': belongs in the table [scenario]"
    child = path.with_name("child.toml")
    child.write_text('[scenario]\nextends = "my.toml"\n', encoding="utf-8")
    assert refusal(child) == refusal(path)


def test_settings_lie_over_the_file_in_order() -> None:
    scenario = load_scenario(
        BUILT_IN,
        ["simulation.step_s=0.001", "simulation.step_s=0.0025", "scenario.title=just text", "scenario.name='quoted'"],
    )
    assert scenario.simulation.step_s == 0.0025
    assert scenario.scenario.title == "just text"
    assert scenario.name == "quoted"


def test_seed_sets_both_seeds_and_each_alone_one() -> None:
    both = load_scenario(BUILT_IN, ["scenario.seed=7"]).scenario
    assert (both.world_seed, both.sensor_seed) == (7, 7)
    one = load_scenario(BUILT_IN, ["scenario.seed=7", "scenario.sensor_seed=8"]).scenario
    assert (one.world_seed, one.sensor_seed) == (7, 8)


def test_digits_address_the_entries_of_an_array() -> None:
    base = load_scenario(BUILT_IN)
    scenario = load_scenario(BUILT_IN, ["adhesion.stretches.1.peak_adhesion=0.05"])
    assert scenario.adhesion.stretches[1].peak_adhesion == 0.05
    assert scenario.adhesion.stretches[1].spread == base.adhesion.stretches[1].spread
    assert scenario.adhesion.stretches[0] == base.adhesion.stretches[0]
    assert "there are 2 entries" in refusal(BUILT_IN, "adhesion.stretches.2.peak_adhesion=0.05")


@pytest.mark.parametrize("step_s", [0.005, 0.0025, 0.002, 0.001, 0.0005])
def test_every_step_records_at_100_hz_unless_told_otherwise(step_s: float) -> None:
    assert load_scenario(BUILT_IN, [f"simulation.step_s={step_s}"]).simulation.record_period_s == 0.01
    given = load_scenario(BUILT_IN, [f"simulation.step_s={step_s}", f"simulation.record_period_s={step_s}"])
    assert given.simulation.record_period_s == step_s


def test_another_controller_leaves_the_parameters_of_the_first_behind(write: Write) -> None:
    path = write(extending("[wsp.parameters]\ncut_off_mps = 2.0\n"))
    assert load_scenario(path).wsp.parameters.cut_off_mps == 2.0  # type: ignore[attr-defined]
    unprotected = load_scenario(path, ["wsp.controller=none"])
    assert unprotected.wsp.controller == "none"
    assert not hasattr(unprotected.wsp.parameters, "cut_off_mps")


def test_another_preset_leaves_changes_to_the_first_behind(write: Write) -> None:
    path = write(extending("[imu]\nrate_hz = 50.0\n"))
    assert load_scenario(path).imu.rate_hz == 50.0
    other = load_scenario(path, ["imu.preset=bmi055"])
    assert other.imu == load_scenario(BUILT_IN, ["imu.preset=bmi055"]).imu
    assert other.presets["imu"] == "bmi055"


def test_a_preset_of_the_users_own_counts_from_the_files_folder(tmp_path: Path, write: Write) -> None:
    own = (TABLES["brake preset"]()["lhb-discs-56t"]).read_text(encoding="utf-8")
    (tmp_path / "my-brake.toml").write_text(re.sub(r"pad_friction *= *[\d.]+", "pad_friction = 0.31", own))
    path = write(extending('[brake]\npreset = "my-brake.toml"\n'))
    assert load_scenario(path).brake.pad_friction == 0.31


def test_an_estimator_can_be_left_out_with_its_parameters_still_there(write: Write) -> None:
    path = write(extending('[estimators]\nnames = ["scmt"]\n[estimators.ins-odo]\n'))
    scenario = load_scenario(path)
    assert list(scenario.make_estimators()) == ["scmt"]
    assert "ins-odo" not in dump_scenario(scenario)


USER_CLASS = '''
from pydantic import BaseModel


class Mine:
    """Fills whatever happens."""

    class Parameters(BaseModel, extra="forbid"):
        gain: float = 1.5

    period_s = 0.01

    def __init__(self, parameters):
        self.parameters = parameters

    def reset(self, t_s, direction):
        pass

    def step(self, *inputs):
        return None


not_a_class = 3
'''


def test_a_class_of_the_users_own_from_a_file_beside_the_scenario(tmp_path: Path, write: Write) -> None:
    (tmp_path / "own.py").write_text(USER_CLASS)
    path = write(extending('[wsp]\ncontroller = "own.py:Mine"\n[wsp.parameters]\ngain = 2\n'))
    scenario = load_scenario(path)
    assert scenario.wsp.parameters.gain == 2.0  # type: ignore[attr-defined]
    assert type(scenario.make_controller()).__name__ == "Mine"
    (tmp_path / "elsewhere").mkdir()
    resolved = tmp_path / "elsewhere" / "resolved.toml"
    resolved.write_text(dump_scenario(scenario))
    assert load_scenario(resolved).wsp.parameters.gain == 2.0  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("own.py:Mime", "'Mime' not found, best match is Mine"),
        ("own.py:not_a_class", "'not_a_class' not found"),
        ("gone.py:Mine", "there is no file"),
        ("broken.py:Mine", "ZeroDivisionError"),
        ("bare.py:Mine", "pydantic model called Parameters"),
    ],
)
def test_a_class_of_the_users_own_that_does_not_fit(tmp_path: Path, write: Write, name: str, words: str) -> None:
    (tmp_path / "own.py").write_text(USER_CLASS)
    (tmp_path / "broken.py").write_text("1 / 0\n")
    (tmp_path / "bare.py").write_text("class Mine:\n    pass\n")
    assert words in refusal(write(extending(f'[wsp]\ncontroller = "{name}"\n')))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[simulation]\ninitial_speed_mph = 75\n", ["simulation.initial_speed_mph", "'initial_speed_kmh'"]),
        ("[[driver.phases]]\nfrom_m = 0.0\naction = 'hold'\nspeed_mph = 50.0\n", ["phases.0.speed_mph", "'speed_kmh'"]),
        ("[coach.body]\nmass_t = 40.8\n", ["coach.body.mass_t", "unknown key", "'mass_kg'"]),
        ("[coach.body]\nmass_kg = -40.8\n", ["coach.body.mass_kg = -40.8", "greater than 0"]),
        ("[coach.body]\nmass_kg = nan\n", ["coach.body.mass_kg = NaN", "finite"]),
        ("[coach.body]\nmass_kg = inf\n", ["coach.body.mass_kg", "finite"]),
        ("[coach.body]\nmass_kg = '40800'\n", ["coach.body.mass_kg", "number"]),
        ("[coach.body]\nmass_kg = true\n", ["coach.body.mass_kg", "number"]),
        ("[coach.body]\nmass_kg = 2024-01-01\n", ["coach.body.mass_kg", "date"]),
        ("[coach]\nbody = 3\n", ["coach.body"]),
        ("[[adhesion.stretches]]\nfrom_m = 0.0\nsurface = 'dry'\npeak_adhesion = 1.2\n",
         ["adhesion.stretches.0.peak_adhesion = 1.2", "less than or equal to 1"]),
        ("[[adhesion.stretches]]\nfrom_m = 0.0\nsurface = 'slimy'\npeak_adhesion = 0.1\n", ["surface", "'very-low'"]),
        ("[wsp]\ncontroller = 'rule-tabel'\n", ["wsp.controller", "'rule-tabel' not found, best match is rule-table"]),
        ("[wsp]\ncontroller = 7\n", ["wsp.controller", "must be the name of a controller"]),
        ("[wsp.parameters]\ncut_off_kmh = 3.0\n", ["wsp.parameters.cut_off_kmh", "'cut_off_mps'"]),
        ("[estimators]\nnames = ['smct']\n", ["estimators.names", "'smct' not found, best match is scmt"]),
        ("[estimators]\nnames = ['scmt', 'scmt']\n", ["estimators.names", "different"]),
        ("[estimators.kalman]\n", ["estimators.kalman", "not found"]),
        ("[coach]\npreset = 'malvezi-2014'\n", ["coach.preset", "best match is malvezzi-2014"]),
        ("[coach]\npreset = 5\n", ["coach.preset", "must be the name"]),
        ("[coach]\npreset = 'gone.toml'\n", ["gone.toml", "there is no such file"]),
        ("[simulation]\nstep_s = 0.004\n", ["simulation.step_s = 0.004", "0.005, 0.0025"]),
        ("[simulation]\nrecord_period_s = 0.004\n", ["record_period_s = 0.004", "whole multiple"]),
        ("[simulation]\ninitial_position_m = 7000.0\n", ["initial_position_m = 7000.0", "on the track"]),
        ("[imu]\nrate_hz = 70.0\n", ["rate_hz = 70.0", "fraction"]),
        ("[balise]\nspacing_m = 1.0\n", ["balise", "did you mean 'balises'"]),
        ("[track.curve]\n", ["track.curve", "'curves'"]),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_with_file_key_and_remedy(write: Write, text: str, words: list[str]) -> None:
    path = write(extending(text))
    found = refusal(path)
    for word in words:
        assert word in found
    assert "\n" not in found, "one fault, one line"
    assert str(path) in found or "gone.toml" in found


def test_bad_name_of_the_run_folder(write: Write) -> None:
    for name in ("../escape", "", ".hidden", "a/b", "a b", "x" * 101):
        assert "scenario.name" in refusal(write(f'[scenario]\nextends = "{BUILT_IN}"\nname = "{name}"\n'))


def test_all_faults_are_told_at_once(write: Write) -> None:
    path = write(
        extending(
            "[coach.body]\nmass_kg = -1.0\nmas_kg = 1.0\n[simulation]\nstep_s = 0.1\n"
            "[wsp]\ncontroller = 'nil'\n[estimators]\nnames = ['x']\n[balises]\naccuracy_m = nan\n"
        )
    )
    found = refusal(path, "track.length_m=-3", "brake.preset=nothing")
    for key in (
        "coach.body.mass_kg",
        "coach.body.mas_kg",
        "simulation.step_s",
        "wsp.controller",
        "estimators.names",
        "balises.accuracy_m",
        "track.length_m",
        "brake.preset",
    ):
        assert key in found
    assert len(found.splitlines()) == 8
    assert "--set: track.length_m" in found


def test_a_file_without_a_section_says_what_is_missing(write: Write) -> None:
    found = refusal(write("[scenario]\nname = 'bare'\n"))
    for key in ("simulation.step_s", "coach.body", "track.length_m", "wsp.controller"):
        assert key in found


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("step_s=0.001", "begin with its section"),
        ("simulation.step_s", "section.key=value"),
        ("simulation step_s=1", "is not a key"),
        ("=1", "is not a key"),
        ("simulation.step_s=", "simulation.step_s"),
        ("simulation.step_s=0.001\nlongest_s=2", "simulation.step_s"),
        ("wsp.controller=", "wsp.controller"),
        ("scenario.extends=other", "belongs in a file"),
        ("simulation=3", "begin with its section"),
        ("adhesion.stretches.x=1", "adhesion.stretches"),
    ],
)
def test_bad_settings(setting: str, words: str) -> None:
    assert words in refusal(BUILT_IN, setting)


def test_files_that_are_none(tmp_path: Path) -> None:
    assert "there is no such file" in refusal(tmp_path / "gone.toml")
    assert "is a folder" in refusal(tmp_path)
    (tmp_path / "latin.toml").write_bytes(b"[scenario]\ntitle = '\xe9'\n")
    assert "not UTF-8" in refusal(tmp_path / "latin.toml")
    (tmp_path / "cut.toml").write_text("[scenario]\ntitle = 'a'\nname == 'b'\n")
    assert "line 3" in refusal(tmp_path / "cut.toml")
    (tmp_path / "null.toml").write_bytes(b"[scenario]\n\0\n")
    assert "not valid TOML" in refusal(tmp_path / "null.toml")
    assert "best matches are low-adhesion-stop, typical-low-adhesion (" in refusal("low-adhesion-stp")


NUMBERS = st.one_of(st.floats(), st.integers(-(10**400), 10**400), st.integers(-100, 100))
VALUES = st.recursive(
    NUMBERS | st.booleans() | st.text(max_size=5) | st.dates(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)
KEYS = st.sampled_from(
    [
        ("scenario", "world_seed"),
        ("simulation", "step_s"),
        ("simulation", "longest_s"),
        ("coach", "body", "mass_kg"),
        ("coach", "preset"),
        ("track", "curves"),
        ("track", "length_m"),
        ("coach", "contact", "geometry"),
        ("coach", "contact", "conical"),
        ("adhesion", "stretches"),
        ("adhesion", "patches"),
        ("adhesion", "memory"),
        ("adhesion", "rail_state_file"),
        ("creep_law",),
        ("creep_law", "name"),
        ("creep_law", "parameters"),
        ("sanding", "sanders"),
        ("sanding", "effect"),
        ("driver", "phases"),
        ("wsp", "controller"),
        ("wsp", "parameters"),
        ("imu", "temperature"),
        ("estimators", "names"),
        ("estimators",),
        ("balises",),
        ("new",),
    ]
)


@settings(deadline=None, max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(key=KEYS, value=VALUES)
def test_any_value_anywhere_is_taken_or_refused_in_words(key: tuple[str, ...], value: object, write: Write) -> None:
    """Whatever stands in a file: either a scenario that can be written and read again, or BadInput; nothing else."""
    import tomli_w

    # cones: profiles take a while to be tabulated
    tree: dict[str, object] = {"scenario": {"extends": BUILT_IN}, "coach": {"contact": {"geometry": "conical"}}}
    table = tree
    for name in key[:-1]:
        table = table.setdefault(name, {})  # type: ignore[assignment]
    table[key[-1]] = value
    path = write(tomli_w.dumps(tree))
    try:
        scenario = load_scenario(path)
    except BadInput as refused:
        faults = refused.faults
    else:
        path.write_text(dump_scenario(scenario), encoding="utf-8")
        assert load_scenario(path) == scenario.model_copy(update={"presets": {}})
        return
    assert faults
    assert all(str(fault).strip() for fault in faults)


@settings(deadline=None, max_examples=60)
@given(st.floats(0.01, 1.0), st.floats(-1e5, 1e5))
def test_adhesion_is_taken_exactly_between_0_and_1(peak: float, other: float) -> None:
    cones = "coach.contact.geometry=conical"  # profiles take a while to be tabulated
    scenario = load_scenario(BUILT_IN, [cones, f"adhesion.stretches.0.peak_adhesion={peak!r}"])
    assert scenario.adhesion.stretches[0].peak_adhesion == peak
    if not 0.0 < other <= 1.0:
        assert "peak_adhesion" in refusal(BUILT_IN, f"adhesion.stretches.0.peak_adhesion={other!r}")
