"""The world of a scenario: track, rails as found, and the contact of this coach's wheels with them."""

from pathlib import Path

from scenarios.parquet import read_columns
from scenarios.schema import Scenario
from sensors import random_stream
from wheel_rail import Adhesion, Contact, RailState, Track

# numbers of the random streams that hang on the world seed
RAIL_STREAM = 100
IRREGULARITY_STREAM = 101


def track_of(scenario: Scenario) -> Track:
    """The track of a scenario; raises ValueError with the key of what does not fit."""
    return Track(scenario.track, random_stream(scenario.scenario.world_seed, IRREGULARITY_STREAM, 0))


class Line:
    """Track, rails and contact of a scenario.

    `state` is what the rails keep of every train; a run changes it, all else is fixed. Raises ValueError with the key
    of what does not fit.
    """

    def __init__(self, scenario: Scenario) -> None:
        coach = scenario.coach
        # from the coach's centre to its outer wheelsets
        self.reach_m = 0.5 * (coach.bogie_distance_m + coach.wheelbase_m)
        radius_m = 0.5 * coach.wheelset.wheel_diameter_m
        self.contact = Contact(coach.contact, radius_m, coach.static_wheel_load_n, scenario.creep_law.in_force())
        self.track = track_of(scenario)
        self.adhesion = Adhesion(
            scenario.adhesion,
            scenario.track.length_m,
            self.contact,
            random_stream(scenario.scenario.world_seed, RAIL_STREAM, 0),
            scenario.sanding.effect,
        )
        self.state = _rail_state(scenario)
        self.rail = self.adhesion.tables(self.state)

    @property
    def places_m(self) -> tuple[float, float]:
        """First and last place of the coach's centre at which all its wheelsets are on the line."""
        return self.reach_m, self.track.length_m - self.reach_m


def _rail_state(scenario: Scenario) -> RailState:
    """Rails without a trace of trains, or as an earlier run has left them."""
    length_m = scenario.track.length_m
    path = scenario.adhesion.rail_state_file
    if path is None:
        return RailState(length_m)
    try:
        return RailState.from_arrays(length_m, read_columns(Path(path)))
    except ValueError as error:
        raise ValueError(f"adhesion.rail_state_file = {path}: {error}") from None
