"""A coach on a line of the test's choice, and a short way to run and record it."""

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from vehicle import COACH_PRESETS, OBSERVATION, Actuation, Coach, CoachParameters, CoachState, SolveReport
from wheel_rail import Adhesion, AdhesionParameters, Contact, RailState, Track, TrackParameters
from wheel_rail.adhesion_state import RailTables

RECORD_S = 0.005


def coach_of(preset: str = "malvezzi-2014", **changes: Any) -> CoachParameters:
    """The coach of a preset with other values; `a__b` is key b in table a."""
    with COACH_PRESETS[preset].open("rb") as file:
        tree = tomllib.load(file)
    for path, value in changes.items():
        table: dict[str, Any] = tree
        *tables, key = path.split("__")
        for name in tables:
            table = table.setdefault(name, {})
        table[key] = value
    return CoachParameters.model_validate(tree)


@pytest.fixture(scope="session")
def parameters() -> CoachParameters:
    return coach_of()


@dataclass
class Bench:
    """A coach on its line; `run` returns the observations every 5 ms, each run on rails that no wheel has touched."""

    parameters: CoachParameters
    contact: Contact
    track: Track
    rail: RailTables
    coach: Coach

    def run(
        self,
        *,
        step_s: float = 0.005,
        duration_s: float,
        speed_mps: float,
        position_m: float = 50.0,
        brake: Callable[[float], np.ndarray | float] = lambda t: 0.0,
        drive: Callable[[float], float] = lambda t: 0.0,
        until: Callable[[CoachState], bool] = lambda state: False,
        newton: bool = False,
    ) -> tuple[np.ndarray, SolveReport]:
        rows = np.zeros(round(duration_s / RECORD_S) + 2, OBSERVATION)
        count = 0
        actuation = Actuation()

        def on_step(t_s: float, state: CoachState) -> Actuation | None:
            nonlocal count
            state.observe(t_s, rows, count)
            count += 1
            if until(state):
                return None
            actuation.brake_torque_nm[:] = brake(t_s)
            actuation.drive_torque_nm[:] = drive(t_s)
            return actuation

        self.rail.state[:] = 0.0
        report = self.coach.run(step_s, duration_s, position_m, speed_mps, on_step, RECORD_S, newton)
        return rows[:count], report


MakeBench = Callable[..., Bench]


@pytest.fixture(scope="session")
def make_bench(parameters: CoachParameters) -> MakeBench:
    def make(
        peak_adhesion: float = 0.3,
        surface: str = "dry",
        geometry: str = "profiles",
        given: CoachParameters = parameters,
        **line: object,
    ) -> Bench:
        contact_parameters = given.contact.model_copy(update={"geometry": geometry})
        coach = given.model_copy(update={"contact": contact_parameters})
        track_parameters = TrackParameters.model_validate({"length_m": 4000.0, **line})
        track = Track(track_parameters, np.random.default_rng(1))
        contact = Contact(coach.contact, 0.5 * coach.wheelset.wheel_diameter_m, coach.static_wheel_load_n)
        found = AdhesionParameters.model_validate(
            {"stretches": [{"from_m": 0.0, "surface": surface, "peak_adhesion": peak_adhesion}]}
        )
        length_m = track_parameters.length_m
        rail = Adhesion(found, length_m, contact, np.random.default_rng(1)).tables(RailState(length_m))
        return Bench(coach, contact, track, rail, Coach(coach, contact, track, rail))

    return make
