"""Programmes and limits: what the built-in ones hold, and what becomes of bad ones."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from scenarios.errors import BadInput
from scenarios.wsp_test.limits import LIMITS, Limit, beyond, load_limits
from scenarios.wsp_test.programme import PROGRAMME, Programme, load_programme
from scenarios.wsp_test.results import METRICS, Result
from scenarios.wsp_test.runner import stop_key
from scenarios.wsp_test.scorecard import BrakeStretch, ScoringParameters, score_stop

FAULT_KINDS = {
    "valve-stuck", "tachometer-lost", "tachometer-frozen", "tooth-count", "wheel-diameter", "pipe-leak",
    "low-reservoir", "controller-dead", "brake-cut-out",
}  # fmt: skip


@pytest.fixture(scope="module")
def built_in() -> Programme:
    return load_programme(PROGRAMME, "rule-table", [])


def test_built_in_programme_covers_what_it_promises(built_in: Programme) -> None:
    assert len(built_in.stops) >= 40
    assert {stop.group for stop in built_in.stops} == set(built_in.groups)
    settings = " ".join(setting for stop in built_in.stops for setting in stop.settings)
    speeds = {float(found) for found in re.findall(r"initial_speed_kmh=([\d.]+)", settings)}
    assert min(speeds) == 30.0
    assert max(speeds) == 200.0
    assert set(re.findall(r'kind="([\w-]+)"', settings)) == FAULT_KINDS
    limit_groups = {group for stop in built_in.stops for group in stop.limits}
    for limit in load_limits(LIMITS, limit_groups):
        assert limit.known != "quoted"  # no standard is at hand
        assert limit.source


def test_every_stop_is_a_valid_scenario_that_starts_before_its_brake(built_in: Programme) -> None:
    for stop in (*built_in.dry_references, *built_in.stops):
        scenario = stop.load()
        simulation = scenario.simulation
        first_m = next(phase.from_m for phase in scenario.driver.phases if phase.action == "brake")
        run_in_s = (first_m - simulation.initial_position_m) * 3.6 / simulation.initial_speed_kmh
        assert run_in_s == pytest.approx(stop.run_in_s), stop.name
        assert scenario.name == stop.name


def test_loaded_brakes_as_empty_does(built_in: Programme) -> None:
    by_name = {stop.name: stop.load() for stop in built_in.dry_references}
    empty, loaded = by_name["dry-reference-120-empty"], by_name["dry-reference-120-seated"]
    assert loaded.coach.mass_kg - empty.coach.mass_kg == pytest.approx(8000.0)

    def deceleration(scenario: Any) -> float:
        brake = scenario.brake_at_load
        pressure_bar: float = brake.full_service_pressure_bar - brake.return_spring_pressure_bar
        return pressure_bar / float(scenario.coach.effective_mass_kg)

    assert deceleration(loaded) == pytest.approx(deceleration(empty), rel=1e-9)
    assert loaded.brake == empty.brake  # the plant is the same; the load sets it


def test_a_dry_reference_for_each_speed_and_load_without_the_controller() -> None:
    programme = load_programme(PROGRAMME, "rule-table", ["wsp.parameters.watchdog_s=7.0", "coach.body.height_m=1.7"])
    names = [reference.name for reference in programme.dry_references]
    assert len(set(names)) == len(names)
    assert {stop.dry for stop in programme.stops} == set(names)
    scenario = programme.dry_references[0].load()
    assert scenario.wsp.controller == "none"
    assert scenario.coach.body.height_m == 1.7
    assert scenario.adhesion.stretches[0].surface == "dry"
    assert programme.stops[0].load().wsp.parameters.watchdog_s == 7.0


def test_only_takes_groups_names_and_patterns(built_in: Programme) -> None:
    chosen = built_in.only(["drag", "low-050-120-*"])
    assert {stop.group for stop in chosen.stops} == {"drag", "low"}
    assert sum(stop.group == "low" for stop in chosen.stops) == 2
    assert {reference.name for reference in chosen.dry_references} == {stop.dry for stop in chosen.stops}
    with pytest.raises(BadInput, match=r"--only: drga: no group and no stop of this name; did you mean drag"):
        built_in.only(["drga"])


def test_key_changes_with_whatever_a_score_follows_from(built_in: Programme) -> None:
    stop = built_in.stops[0]
    key = stop_key(stop, stop.load())
    assert key == stop_key(stop, stop.load())
    slower = replace(stop, settings=(*stop.settings, "simulation.initial_speed_kmh=50"))
    assert stop_key(slower, slower.load()) != key
    scored_otherwise = replace(stop, scoring=ScoringParameters(slide_slip=0.1))
    assert stop_key(scored_otherwise, stop.load()) != key


def test_key_changes_with_a_file_that_the_stop_names(tmp_path: Path, built_in: Programme) -> None:
    file = tmp_path / "mine.py"
    source = "from wsp.controllers.none import NoProtection\nclass Mine(NoProtection):\n    pass\n"
    file.write_text(source)
    stop = load_programme(PROGRAMME, f"{file}:Mine", []).stops[0]
    scenario = stop.load()
    key = stop_key(stop, scenario)
    file.write_text(source + "# changed\n")
    assert stop_key(stop, scenario) != key


GOOD = """
[programme]
name = "mine"
scenario = "low-adhesion-stop"
dry = []
[groups.low]
title = "low"
limits = ["low"]
[[stops]]
name = "one"
group = "low"
speed_kmh = 60
load = "empty"
"""
BAD_PROGRAMMES = {
    "not TOML": (("[programme]", "[programme"), ["is not valid TOML"]),
    "unknown key": (("speed_kmh", "speed_mph"), ["stops.0.speed_mph", "speed_kmh"]),
    "negative speed": (("speed_kmh = 60", "speed_kmh = -60"), ["stops.0.speed_kmh = -60", "greater than 0"]),
    "text for a number": (("speed_kmh = 60", 'speed_kmh = "fast"'), ["stops.0.speed_kmh", "fast"]),
    "no such group": (('group = "low"', 'group = "lo"'), ["stops.0.group = 'lo'", "there are low"]),
    "a load is a name": (('load = "empty"', 'load = "two words"'), ["stops.0.load", "two words"]),
    "bad name": (('name = "one"', 'name = "../one"'), ["stops.0.name", "../one"]),
    "setting is no text": (('load = "empty"', 'load = "empty"\nsettings = [3]'), ["stops.0.settings.0 = 3"]),
}


@pytest.mark.parametrize(("change", "told"), BAD_PROGRAMMES.values(), ids=BAD_PROGRAMMES.keys())
def test_a_bad_programme_is_one_clear_message(change: tuple[str, str], told: list[str], tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    assert change[0] in GOOD
    file.write_text(GOOD.replace(*change, 1) if "name" not in change[0] else GOOD.replace(*change))
    with pytest.raises(BadInput) as caught:
        load_programme(file, "rule-table", [])
    messages = [str(fault) for fault in caught.value.faults]
    assert all(message.startswith(str(file)) for message in messages)
    assert any(all(part in message for part in told) for message in messages), messages


def test_names_of_stops_are_unique(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(GOOD + GOOD[GOOD.index("[[stops]]") :])
    with pytest.raises(BadInput, match=r"stops\.1\.name = 'one': is the name of an earlier stop"):
        load_programme(file, "rule-table", [])


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        ("coach.load=full", "coach.load = 'full': no such load; there are empty, seated, crush"),
        ("simulation.step_s=0.003", "simulation.step_s = 0.003: must be one of"),
        ("adhesion.stretches.7.peak_adhesion=0.1", "adhesion.stretches.7: there are 2 entries"),
        ('driver.phases=[{from_m=0.0, action="coast"}]', "driver.phases: nobody brakes"),
        ('driver.phases=[{from_m=0.0, action="brake", demand=1.0}]', "run_in_s = 2.0: the coach would start at -"),
    ],
)
def test_a_bad_setting_names_programme_and_stop(setting: str, told: str, tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(f"{GOOD}settings = ['{setting}']\n")
    (stop,) = load_programme(file, "rule-table", []).stops
    with pytest.raises(BadInput) as caught:
        stop.load()
    assert str(caught.value).startswith(f"{file}: one: {told}")
    assert len(caught.value.faults) == 1


LIMIT = """
[[limits]]
metric = "longest_lock_s"
at_most = 0.4
unit = "s"
applies_to = ["low"]
known = "second-hand"
source = "said by somebody somewhere"
"""
BAD_LIMITS = {
    "no such metric": (("longest_lock_s", "longest_lck_s"), ["limits.0.metric", "did you mean longest_lock_s"]),
    "wrong unit": (('"s"', '"ms"'), ["limits.0.unit = 'ms'", "longest_lock_s has the unit 's'"]),
    "two bounds": (("unit", "at_least = 0.1\nunit"), ["limits.0.at_most", "exactly one"]),
    "no source": (('source = "said by somebody somewhere"', ""), ["limits.0.source", "missing"]),
    "unknown standing": (("second-hand", "quotd"), ["limits.0.known", "quotd"]),
    "no such group": (('["low"]', '["lo"]'), ["limits.0.applies_to = 'lo'", "there are low"]),
}


@pytest.mark.parametrize(("change", "told"), BAD_LIMITS.values(), ids=BAD_LIMITS.keys())
def test_bad_limits_are_one_clear_message(change: tuple[str, str], told: list[str], tmp_path: Path) -> None:
    file = tmp_path / "limits.toml"
    assert change[0] in LIMIT
    file.write_text(LIMIT.replace(*change, 1))
    with pytest.raises(BadInput) as caught:
        load_limits(file, {"low"})
    (message,) = [str(fault) for fault in caught.value.faults]
    assert message.startswith(f"{file}: {told[0]}")
    assert told[1] in message


def limit(metric: str, **bound: float) -> Limit:
    unit = METRICS[metric].unit
    return Limit(metric=metric, unit=unit, applies_to=("low",), known="own", source="for this test alone", **bound)


def test_a_figure_beyond_its_limit_is_marked(make_truth: Any, built_in: Programme) -> None:
    stop = replace(built_in.stops[0], limits=("low",))
    score = score_stop(make_truth(30.0, 0.75, used_share=0.7), 500.0, stop.scoring)
    dry = replace(score, distance_m=480.0)
    result = Result(stop, score, dry)
    limits = (
        limit("distance_over_dry", at_most=1.25 + 1e-5),  # 600 m over 480 m
        limit("distance_over_dry", at_most=1.249),
        limit("distance_over_shortest", at_most=1.3),
        limit("adhesion_utilisation", at_least=0.75),
        limit("adhesion_utilisation", at_least=0.6),
    )
    found = beyond(result, limits)
    assert [(b.metric, b.limit) for b in found] == [
        ("distance_over_dry", limits[1]),
        ("adhesion_utilisation", limits[3]),
    ]
    assert beyond(Result(replace(stop, limits=("dry",)), score, dry), limits) == []
    assert beyond(Result(replace(stop, compares_with_dry=False), score, dry), limits[:2]) == []
    rolled_on = Result(stop, replace(score, ended="time", distance_m=None), dry)
    assert str(beyond(rolled_on, ())[0]) == "no standstill"


def test_brake_performance_is_against_the_dry_reference(make_truth: Any, built_in: Programme) -> None:
    stop = built_in.stops[0]
    score = score_stop(make_truth(30.0, 0.75), None, stop.scoring)
    dry = replace(score, stretches=(BrakeStretch(5.0, 8.0, 0.5, 0.05, 100.0, 50.0),))
    stretches = (
        BrakeStretch(0.0, 20.0, 0.4, 0.03, 100.0, 90.0),  # required: 0.4 of the full 0.1
        BrakeStretch(20.0, 9.0, 1.0, 0.01, 90.0, 10.0),  # too short
    )
    result = Result(stop, replace(score, stretches=stretches), dry)
    assert result.required_ratio == pytest.approx(0.1)
    assert [value for _, value in result.performances()] == [pytest.approx(-0.25)]
    assert METRICS["brake_performance"].value(result) == pytest.approx(-0.25)
