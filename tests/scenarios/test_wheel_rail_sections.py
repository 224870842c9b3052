"""Scenario files that choose creep law, profiles, recovery and rail state: names, the user's own files."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from scenarios.cosimulation.line import Line
from scenarios.cosimulation.simulation import simulate
from scenarios.errors import BadInput
from scenarios.metrics import stop_metrics
from scenarios.parquet import write_stream
from scenarios.scenario_file import dump_scenario, load_scenario
from scenarios.schema import Scenario
from scenarios.truth import rail_stream
from wheel_rail import RailState
from wheel_rail.creep_laws import FASTSIM, KALKER_LINEAR, MODIFIED_FASTSIM, POLACH, USER
from wheel_rail.profiles import WHEEL_PROFILES
from wheel_rail.recovery_parameters import RECOVERY_PRESETS

BUILT_IN = "low-adhesion-stop"
CONES = '[coach.contact]\ngeometry = "conical"\n'
"""The table of the profiles takes a while to fill."""

Write = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """A file my.toml in a folder below, extending the built-in scenario."""

    def written(text: str, cones: bool = True) -> Path:
        folder = tmp_path / "mine"
        folder.mkdir(exist_ok=True)
        path = folder / "my.toml"
        path.write_text(f'[scenario]\nextends = "{BUILT_IN}"\n{CONES if cones else ""}{text}', encoding="utf-8")
        return path

    return written


def refusal(source: str | Path, *settings: str) -> str:
    with pytest.raises(BadInput) as caught:
        load_scenario(source, settings)
    return str(caught.value)


def assert_survives_being_written(scenario: Scenario, folder: Path) -> None:
    resolved = folder / "resolved.toml"
    resolved.write_text(dump_scenario(scenario), encoding="utf-8")
    assert load_scenario(resolved) == scenario.model_copy(update={"presets": {}})


@pytest.mark.parametrize(
    ("text", "number", "own"),
    [
        ('name = "polach"', POLACH, []),
        ('name = "kalker-linear"\nparameters.saturation = "cut"', KALKER_LINEAR, [1.0]),
        ('name = "kalker-linear"', KALKER_LINEAR, [0.0]),
        ('name = "fastsim"\nparameters.nx = 20', FASTSIM, [20.0, 10.0]),
        (
            'name = "modified-fastsim"\nparameters = {k0 = 0.5, beta = 1}',
            MODIFIED_FASTSIM,
            [10.0, 10.0, 0.5, 0.02, 1.0],
        ),
    ],
)
def test_a_creep_law_by_name_with_its_parameters(
    write: Write, tmp_path: Path, text: str, number: int, own: list[float]
) -> None:
    scenario = load_scenario(write(f"[creep_law]\n{text}\n"))
    law = Line(scenario).contact.law
    assert law.number == number
    assert law.extra[: len(own)] == pytest.approx(own)
    assert_survives_being_written(scenario, tmp_path)


def test_another_law_leaves_the_parameters_of_the_first_behind(write: Write) -> None:
    path = write('[creep_law]\nname = "fastsim"\n[creep_law.parameters]\nnx = 20\n')
    assert load_scenario(path).creep_law.parameters.nx == 20  # type: ignore[attr-defined]
    other = load_scenario(path, ["creep_law.name=polach"]).creep_law
    assert other.parameters.model_dump() == {}
    assert load_scenario(path, ["creep_law.name=modified-fastsim"]).creep_law.parameters.nx == 10  # type: ignore[attr-defined]
    same = load_scenario(path, ["creep_law.name=fastsim"]).creep_law
    assert same.parameters.nx == 20  # type: ignore[attr-defined]


POLACH_OF_ONES_OWN = """
import math


def closed_formula(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):
    limit = normal_force_n * mu0 * ((1.0 - falling_a) * math.exp(-falling_b_spm * slip_speed_mps) + falling_a)
    counted = creep_y if abs(creep_y) >= abs(creep_y + spin_1pm * a_m) else creep_y + spin_1pm * a_m
    size = math.hypot(creep_x, counted)
    if size < 1e-14:
        return 0.0, 0.0
    gradient = math.pi * shear_modulus_pa * a_m * b_m * math.hypot(c11 * creep_x, c22 * counted) / (4.0 * limit)
    held, slid = k_adhesion * gradient, k_slip * gradient
    force = 2.0 * limit / math.pi * (held / (1.0 + held**2) + math.atan(slid))
    fx, fy = -force * creep_x / size, -force * creep_y / size
    aspect = 1.0 + 6.3 * (1.0 - math.exp(-a_m / b_m))
    turn = 8.0 * shear_modulus_pa * b_m * math.sqrt(a_m * b_m) * c23 * abs(counted) / (3.0 * aspect * limit)
    delta = (turn**2 - 1.0) / (turn**2 + 1.0)
    moment = turn * (delta**3 / 3.0 - delta**2 / 2.0 + 1.0 / 6.0) - (1.0 - delta**2) ** 1.5 / 3.0
    fy += 9.0 / 16.0 * a_m * limit * moment * aspect * spin_1pm / size
    shrink = min(1.0, limit / math.hypot(fx, fy))
    return shrink * fx, shrink * fy


def backwards(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):
    return mu0 * falling_a * normal_force_n * math.tanh(1e3 * creep_x), 0.0


def too_few(creep_x, creep_y):
    return -creep_x, -creep_y


not_a_law = 3
"""
SHORT_STOP = """
[simulation]
initial_speed_kmh = 40.0
initial_position_m = 1400.0
[[driver.phases]]
from_m = 0.0
action = "brake"
demand = 1.0
"""


def test_polachs_formula_as_a_users_own_law_gives_the_same_stop(write: Write, tmp_path: Path) -> None:
    """Without WSP, whose valves make much of a last digit."""
    path = write(f'[creep_law]\nname = "../own.py:closed_formula"\n[wsp]\ncontroller = "none"\n{SHORT_STOP}')
    (tmp_path / "own.py").write_text(POLACH_OF_ONES_OWN)
    own = load_scenario(path)
    assert own.creep_law.name == f"{tmp_path / 'own.py'}:closed_formula"
    assert_survives_being_written(own, tmp_path)
    stops = []
    for scenario in (own, load_scenario(path, ["creep_law.name=polach"])):
        line = Line(scenario)
        assert (line.contact.law.number == USER) == (scenario is own)
        truth = simulate(scenario, lambda *_: None, lambda: False)
        stops.append(stop_metrics(truth, None).distance_m)
    print("stops", stops)
    assert stops[0] is not None
    assert stops[0] == pytest.approx(stops[1], rel=1e-3)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("polsh", "'polsh' not found, best match is polach"),
        ("fastsm", "'fastsm' not found, best matches are fastsim, modified-fastsim"),
        ("own.py:closed_formla", "'closed_formla' not found, best match is closed_formula"),
        ("own.py:not_a_law", "'not_a_law' not found"),
        ("own.py:backwards", "it drives the slip, but must oppose it"),
        ("own.py:too_few", "takes 2 arguments (creep_x, creep_y), but must take 16"),
        ("gone.py:closed_formula", "there is no file"),
        ("broken.py:closed_formula", "ZeroDivisionError"),
    ],
)
def test_what_is_no_creep_law_is_refused(write: Write, name: str, words: str) -> None:
    path = write(f'[creep_law]\nname = "{name}"\n')
    (path.parent / "own.py").write_text(POLACH_OF_ONES_OWN)
    (path.parent / "broken.py").write_text("1 / 0\n")
    found = refusal(path)
    assert f"{path}: creep_law.name" in found
    assert words in found
    assert "\n" not in found


def recovery_file(folder: Path) -> None:
    text = RECOVERY_PRESETS["low-recovering"].read_text(encoding="utf-8")
    (folder / "slime.toml").write_text(text.replace("tau_mpj = 5e-4", "tau_mpj = 6e-4"))


def test_a_recovery_file_beside_the_scenario(write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # not where the file stands
    kind = 'peak_adhesion = 0.07\nrecovery = "slime.toml"'
    path = write(
        f"[[adhesion.stretches]]\nfrom_m = 0.0\n{kind}\n"
        f"[[adhesion.patches]]\nlength_m = 10.0\nstarts_m = [1500.0]\n{kind}\n"
    )
    recovery_file(path.parent)
    scenario = load_scenario(path)
    for rail in (*scenario.adhesion.stretches, *scenario.adhesion.patches):
        assert rail.recovery is not None
        assert rail.recovery.tau_mpj == 6e-4
    assert_survives_being_written(scenario, tmp_path)
    (path.parent / "slime.toml").unlink()
    assert str(path.parent / "slime.toml") in refusal(path)


def test_a_recovery_preset_stays_a_name_even_where_a_file_is_called_so(write: Write) -> None:
    path = write('[[adhesion.stretches]]\nfrom_m = 0.0\npeak_adhesion = 0.07\nrecovery = "low-recovering"\n')
    (path.parent / "low-recovering").write_text("nonsense")
    recovery = load_scenario(path).adhesion.stretches[0].recovery
    assert recovery is not None
    assert recovery.tau_mpj == 5e-4


def test_a_recovery_written_out_in_the_file(write: Write, tmp_path: Path) -> None:
    text = RECOVERY_PRESETS["allotta-2014"].read_text(encoding="utf-8")
    inline = text.replace("[degraded]", "[adhesion.stretches.recovery.degraded]").replace(
        "[recovered]", "[adhesion.stretches.recovery.recovered]"
    )
    path = write(f"[[adhesion.stretches]]\nfrom_m = 0.0\n[adhesion.stretches.recovery]\n{inline}")
    scenario = load_scenario(path)
    recovery = scenario.adhesion.stretches[0].recovery
    assert recovery is not None
    assert recovery.tau_mpj == 1.9e-4
    assert_survives_being_written(scenario, tmp_path)
    found = refusal(write(f"[[adhesion.stretches]]\nfrom_m = 0.0\n[adhesion.stretches.recovery]\ntau = 1.0\n{inline}"))
    assert "adhesion.stretches.0.recovery.tau: unknown key" in found


def test_a_field_file_beside_the_scenario(write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = write('[[adhesion.stretches]]\nfrom_m = 0.0\nsurface = "low"\nfile = "rail.csv"\n')
    (path.parent / "rail.csv").write_text("position_m,left,right\n0,0.06,0.04\n6000,0.06,0.04\n")
    scenario = load_scenario(path)
    assert scenario.adhesion.stretches[0].file == str(path.parent / "rail.csv")
    peak = Line(scenario).adhesion.peak
    assert peak[0] == pytest.approx(np.full(peak.shape[1], 0.06))
    assert peak[1] == pytest.approx(np.full(peak.shape[1], 0.04))
    assert_survives_being_written(scenario, tmp_path)
    (path.parent / "rail.csv").write_text("position_m,left,right\n0,0.06,0.04\n1000,0.06,0.04\n")
    found = refusal(path)
    assert f"{path}: adhesion.stretches.0.file = {path.parent / 'rail.csv'}" in found


@pytest.mark.parametrize("name", ["state.parquet", "state"])
def test_a_rail_state_beside_the_scenario(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    path = write(f'[adhesion]\nrail_state_file = "{name}"\n')
    state = RailState(6000.0)
    state.energy_jpm[0, 100] = 12.0
    write_stream(path.parent / name, rail_stream(state.table))
    scenario = load_scenario(path)
    assert scenario.adhesion.rail_state_file == str(path.parent / name)
    assert np.array_equal(Line(scenario).state.table, state.table)
    assert_survives_being_written(scenario, tmp_path)
    (path.parent / name).unlink()
    assert f"adhesion.rail_state_file = {path.parent / name}: there is no such file" in refusal(path)


def test_the_columns_of_a_rail_state_have_units(tmp_path: Path) -> None:
    write_stream(tmp_path / "state", rail_stream(RailState(100.0).table))
    units = {field.name: field.metadata[b"unit"] for field in pq.read_schema(tmp_path / "state")}
    assert units == {
        "position_m": b"m", "energy_left_jpm": b"J/m", "energy_right_jpm": b"J/m", "sand_left_gpm": b"g/m",
        "sand_right_gpm": b"g/m",
    }  # fmt: skip


def worn_wheel(path: Path) -> None:
    """S1002 with a tread worn by 0.5 mm about the tape circle, a point each 0.5 mm."""
    y, z = WHEEL_PROFILES["s1002"]().T
    at = np.arange(-69.0, 60.0, 0.5)
    np.savetxt(path, np.stack([at, np.interp(at, y, z) - 0.5 * np.exp(-((at / 20.0) ** 2))], axis=1))


def test_a_profile_beside_the_file_that_names_it(write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = write('[coach.contact.profiles]\nwheel_profile = "worn.txt"\n', cones=False)
    worn_wheel(path.parent / "worn.txt")
    scenario = load_scenario(path)
    assert scenario.coach.contact.profiles is not None
    assert scenario.coach.contact.profiles.wheel_profile == str(path.parent / "worn.txt")
    assert scenario.coach.contact.profiles.rail_profile == "uic60"
    # a hollow tread moves the contact: another rolling radius than that of new wheels
    worn, new = (Line(s).contact.rolling_radius_m for s in (scenario, load_scenario(BUILT_IN)))
    assert 1e-4 < abs(worn - new) < 1e-3
    (path.parent / "worn.txt").write_text("1 2\n")
    key = f"{path}: coach.contact.profiles.wheel_profile = {path.parent / 'worn.txt'}: "
    assert key in refusal(path)


def test_a_profile_in_a_coach_preset_of_the_users_own_counts_from_the_preset(write: Write, tmp_path: Path) -> None:
    from vehicle import COACH_PRESETS

    path = write('[coach]\npreset = "../coaches/mine.toml"\n', cones=False)
    folder = tmp_path / "coaches"
    folder.mkdir()
    preset = COACH_PRESETS["malvezzi-2014"].read_text(encoding="utf-8")
    (folder / "mine.toml").write_text(preset.replace('wheel_profile = "s1002"', 'wheel_profile = "worn.txt"'))
    worn_wheel(folder / "worn.txt")
    profiles = load_scenario(path).coach.contact.profiles
    assert profiles is not None
    assert profiles.wheel_profile == str(folder / "worn.txt")
    (folder / "worn.txt").unlink()
    assert f"{folder / 'mine.toml'}: coach.contact.profiles.wheel_profile" in refusal(path)


def test_a_bad_gauge_is_told_with_its_key(write: Write) -> None:
    path = write("[coach.contact.profiles]\ngauge_m = 1.5\n", cones=False)
    assert f"{path}: coach.contact.profiles.gauge_m = 1.5: " in refusal(path)


def sanders(count: int) -> str:
    rows = ", ".join(f"{{wheelset = 1, offset_m = {-0.1 * k:.1f}}}" for k in range(1, count + 1))
    return f"[sanding]\nsanders = [{rows}]\n"


def test_as_many_sanders_as_a_coach_has_room_for(write: Write) -> None:
    assert len(load_scenario(write(sanders(8))).sanding.sanders) == 8
    found = refusal(write(sanders(9)))
    assert "sanding.sanders" in found
    assert "at most 8" in found
