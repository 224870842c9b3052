"""The coach of a scenario: presets, a user's own file, loads, forms, wheels; and what becomes of bad ones."""

from pathlib import Path

import numpy as np
import pytest

from scenarios.cosimulation.simulation import simulate
from scenarios.errors import BadInput
from scenarios.metrics import stop_metrics
from scenarios.scenario_file import dump_scenario, load_scenario
from scenarios.shortest_stop import shortest_stop
from scenarios.truth import Truth
from vehicle import COACH_PRESETS

BUILT_IN = "low-adhesion-stop"
DRY_STOP = (
    "simulation.initial_speed_kmh=60",
    "track.curves=[]",
    "track.gradients=[]",
    'driver.phases=[{from_m=0.0, action="brake", demand=1.0}]',
    'adhesion.stretches=[{from_m=0.0, surface="dry", peak_adhesion=0.3}]',
)
MINE = """
[scenario]
extends = "low-adhesion-stop"
[coach]
preset = "coaches/mine.toml"
"""


def run(*settings: str) -> Truth:
    return simulate(load_scenario(BUILT_IN, [*DRY_STOP, *settings]), lambda *_: None, lambda: False)


def own_coach(folder: Path, old: str = "", new: str = "") -> tuple[Path, Path]:
    """A scenario, and beside it a coach of the user's own: the Manchester one with `new` in place of `old`."""
    text = COACH_PRESETS["manchester-1"].read_text(encoding="utf-8")
    assert old in text
    (folder / "coaches").mkdir()
    coach = folder / "coaches" / "mine.toml"
    coach.write_text(text.replace(old, new, 1), encoding="utf-8")
    (folder / "my.toml").write_text(MINE, encoding="utf-8")
    return folder / "my.toml", coach


@pytest.mark.parametrize("preset", sorted(COACH_PRESETS))
@pytest.mark.parametrize("load", ["empty", "seated", "crush"])
def test_every_preset_and_load_is_a_valid_scenario_and_survives_being_written(
    preset: str, load: str, tmp_path: Path
) -> None:
    scenario = load_scenario(BUILT_IN, [f"coach.preset={preset}", f"coach.load={load}"])
    (tmp_path / "resolved.toml").write_text(dump_scenario(scenario), encoding="utf-8")
    assert load_scenario(tmp_path / "resolved.toml") == scenario.model_copy(update={"presets": {}})


def test_a_coach_of_the_users_own_is_found_beside_the_scenario(tmp_path: Path) -> None:
    scenario_file, _ = own_coach(tmp_path, "mass_kg = 32_000", "mass_kg = 30_000")
    assert load_scenario(scenario_file).coach.body.mass_kg == 30_000
    text = MINE + '[coach.secondary]\nlateral_damper = "soft"\n[coach.characteristics.soft]\nsource = "mine"\n'
    scenario_file.write_text(text + "speed_mps = [0.0, 1.0]\nforce_n = [0.0, 5e3]\n", encoding="utf-8")
    coach = load_scenario(scenario_file).coach
    assert coach.characteristics["soft"].slope_at_zero == 5e3
    assert set(coach.characteristics) == {"lateral-stop", "soft"}


BAD_FILES = {
    "no damping": (
        "damping_nspm = [0, 32_000, 20_000]",
        "damping_nspm = [0, 32_000, 0]",
        "coach.secondary.damping_nspm = [0.0, 32000.0, 0.0]: nothing damps the vertical axis, no damper either: "
        "bounce and pitch of the body would not be damped",
    ),
    "negative mass": ("mass_kg = 2_615", "mass_kg = -2_615", "coach.bogie.mass_kg = -2615: must be greater than 0"),
    "unequal arrays": (
        "force_n = [0.0, 0.0, ",
        "force_n = [0.0, ",
        "coach.characteristics.lateral-stop.force_n: has 9 points, deflection_m has 10: they must be equally many",
    ),
    "heavy boxes": ("mass_kg = 100", "mass_kg = 1_000", "coach.axle_box.mass_kg = 1000.0: two boxes weigh as much as"),
    "payload above the roof": (
        "height_m = 2.0\n",
        "height_m = 3.0\n",
        "coach.loads.crush.height_m = 3.0: the payload would reach 4.80 m, above saloon.roof_height_m = 3.4",
    ),
    "unknown curve": ('stop = "lateral-stop"', 'stop = "stop"', "coach.lateral_stop.stop = 'stop': no such charact"),
}


@pytest.mark.parametrize(("old", "new", "told"), BAD_FILES.values(), ids=BAD_FILES.keys())
def test_a_bad_coach_is_refused_with_file_key_and_reason(old: str, new: str, told: str, tmp_path: Path) -> None:
    scenario_file, coach_file = own_coach(tmp_path, old, new)
    with pytest.raises(BadInput) as caught:
        load_scenario(scenario_file)
    (fault,) = caught.value.faults
    print(fault)
    assert str(coach_file) in fault.source
    assert told in str(fault)


def test_a_load_beyond_the_air_supply_is_refused() -> None:
    with pytest.raises(BadInput, match=r"brake.full_service_pressure_bar = 5.5: weighs the load up to 6.\d+ bar, more"):
        load_scenario(BUILT_IN, ["coach.load=crush", "brake.full_service_pressure_bar=5.5"])


def test_seated_stops_where_empty_does_and_without_weighing_later() -> None:
    """The brake follows the load, in the run and in the shortest stop alike."""
    found = {}
    for name, settings in {
        "empty": [],
        "seated": ["coach.load=seated"],
        "not weighed": ["coach.load=seated", "brake.weighs_load=false"],
    }.items():
        scenario = load_scenario(BUILT_IN, [*DRY_STOP, *settings])
        truth = run(*settings)
        stop_m, shortest_m = stop_metrics(truth, None).distance_m, shortest_stop(scenario, truth)
        assert stop_m is not None
        assert shortest_m is not None
        found[name] = stop_m, shortest_m
        total = truth.wheelsets.normal_force_n[100:].sum(axis=1).mean()
        assert total == pytest.approx(scenario.coach.mass_kg * 9.81, rel=2e-3)
    print(found)
    # resistance grows less than the mass, so that the laden coach rolls a little farther
    assert found["seated"] == pytest.approx(found["empty"], rel=0.005)
    assert found["not weighed"][0] > 1.08 * found["empty"][0]
    assert found["not weighed"][1] > 1.08 * found["empty"][1]


def test_explicit_axle_boxes_go_through_a_whole_run() -> None:
    lumped, explicit = run(), run("coach.axle_boxes=explicit")
    one, two = (stop_metrics(truth, None).distance_m for truth in (lumped, explicit))
    assert two == pytest.approx(one, rel=2e-3)
    assert explicit.axle_speeds.axle_speed_mps[100] == pytest.approx(lumped.axle_speeds.axle_speed_mps[100], abs=0.02)


def test_tachometers_keep_the_diameter_they_believe() -> None:
    """The third wheelset's wheels are 2 % smaller: its speed is read 2 % too high, though it rolls with the train."""
    wheels = "coach.wheels.diameter_m=[0.92, 0.92, 0.92, 0.92, 0.9016, 0.9016, 0.92, 0.92]"
    truth = run(wheels, 'driver.phases=[{from_m=0.0, action="coast"}]', "simulation.longest_s=5")
    late = slice(200, 450)
    seen = truth.axle_speeds.axle_speed_mps[late].mean(axis=0)
    assert seen[2] / seen[[0, 1, 3]].mean() == pytest.approx(0.92 / 0.9016, rel=1e-3)
    assert np.abs(truth.wheelsets.slip[-1]).max() < 2e-3
