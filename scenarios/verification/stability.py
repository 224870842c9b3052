"""Whether a coach runs quietly at a speed: on a line with faults, by the sum of its guiding forces after EN 14363."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.scenario_file import load_scenario
from scenarios.units import KMH_PER_MPS
from scenarios.verification.case import Case
from vehicle import OBSERVATION, Actuation, Coach, CoachParameters, CoachState
from vehicle.forces import CONTACT_NORMAL, CREEP
from vehicle.hunting import hunting_speed
from vehicle.layout import SPIN
from vehicle.linear import Linearisation, without_resistance

GROUP = "Running stability"
STEP_S = 0.005
BEGIN_M, WINDOW_M, APPROACH_M = 60.0, 100.0, 300.0
_FIRST_WHEELSET = SPIN - 4 * 6


@dataclass(frozen=True)
class Running:
    """A run at constant speed: the largest rms of a wheelset's guiding force over 100 m, against its limit.

    `displacement_rms_m`: of the wheelsets against the track, over the last and over the first half of the way.
    """

    guiding_rms_n: float
    limit_n: float
    displacement_rms_m: tuple[float, float]

    @property
    def share(self) -> float:
        """Of the limit; below one the running is stable."""
        return self.guiding_rms_n / self.limit_n


def guiding_limit_n(coach: CoachParameters) -> float:
    """EN 14363, instability criterion: half of (10 kN + axle load/3) for the rms of the sum of the guiding forces.

    The standard filters a band about the hunting frequency; here only the mean is taken away, which is stricter.
    """
    return 0.5 * (10e3 + 2.0 * coach.static_wheel_load_n / 3.0)


def running(preset: str, speed_kmh: float, length_m: float, settings: Sequence[str]) -> Running:
    """Run the coach of that preset (name or file) on dry rail; `settings` of the scenario give the track its faults."""
    scenario = load_scenario(
        "low-adhesion-stop",
        [
            f"coach.preset={preset}",
            "track.curves=[]",
            "track.gradients=[]",
            f"track.length_m={length_m + 2.0 * APPROACH_M}",
            "adhesion.stretches=[{from_m=0.0, surface='dry', peak_adhesion=0.35}]",
            *settings,
        ],
    )
    line = Line(scenario)
    speed_mps = speed_kmh / KMH_PER_MPS
    longest_s = (length_m + APPROACH_M) / speed_mps
    count = 0
    row = np.zeros(1, OBSERVATION)
    guiding = np.zeros((round(longest_s / STEP_S) + 2, 4))
    aside, place = np.zeros_like(guiding), np.zeros(len(guiding))
    idle = Actuation()

    def on_step(t_s: float, state: CoachState) -> Actuation | None:
        nonlocal count
        state.observe(t_s, row, 0)
        coach = state.observed
        force = (coach["force"][CONTACT_NORMAL] + coach["force"][CREEP])[_FIRST_WHEELSET:SPIN].reshape(4, 6)[:, :3]
        guiding[count] = np.einsum("ji,ij->i", coach["frame"][6:9, :4], force)
        aside[count] = row[0]["lateral_displacement_m"]
        place[count] = row[0]["position_m"]
        count += 1
        return idle

    coach = Coach(without_resistance(scenario.coach), line.contact, line.track, line.rail)
    coach.run(STEP_S, longest_s, BEGIN_M, speed_mps, on_step, STEP_S)
    seen = slice(int(np.searchsorted(place[:count], APPROACH_M)), count)
    per_window = max(2, round(WINDOW_M / speed_mps / STEP_S))
    windows = np.array_split(guiding[seen], max(1, (seen.stop - seen.start) // per_window))
    halves = np.array_split(aside[seen], 2)
    return Running(
        guiding_rms_n=float(max(window.std(axis=0).max() for window in windows)),
        limit_n=guiding_limit_n(scenario.coach),
        displacement_rms_m=(float(halves[1].std()), float(halves[0].std())),
    )


def kinked(length_m: float, heading_rad: float = 1e-3, spacing_m: float = 11.0) -> str:
    """Setting of a line whose rails bend to and fro by an angle every few metres, alternately to either side."""
    bends = [
        f"{{start_m={start:.1f}, transition_m=5.0, length_m=0.0, radius_m={side * 5.0 / heading_rad:.1f}}}"
        for start, side in zip(
            np.arange(APPROACH_M, APPROACH_M + length_m, spacing_m), np.resize((1, -1, -1, 1), 10_000), strict=False
        )
    ]
    return f"track.curves=[{', '.join(bends)}]"


LENGTH_M = 1000.0
FAULTS = {
    "kinked line": kinked(LENGTH_M),
    "rails of ERRI B176, low": "track.irregularities={spectrum='erri-b176-low'}",
}
"""Name -> setting of a line with faults."""


@cache
def _share_of_limit(preset: str, speed_kmh: float, faults: str) -> float:
    return running(preset, speed_kmh, LENGTH_M, [FAULTS[faults]]).share


def stability_case(preset: str, speed_kmh: float, faults: str) -> Case:
    """The row of one coach at one of its service speeds."""
    return Case(
        f"stability-{preset}-{speed_kmh:g}", GROUP,
        f"{preset}, {speed_kmh:g} km/h, {faults}: rms of a wheelset's guiding force over 100 m over its limit",
        "EN 14363, instability criterion (M)", (0.0, 1.0), "-", lambda: _share_of_limit(preset, speed_kmh, faults),
    )  # fmt: skip


def _hunting_kmh(preset: str) -> float:
    coach = load_scenario("low-adhesion-stop", [f"coach.preset={preset}"]).coach
    speed_mps = hunting_speed(Linearisation(coach)).speed_mps
    return math.inf if speed_mps is None else KMH_PER_MPS * speed_mps


CASES = (
    stability_case("malvezzi-2014", 200.0, "kinked line"),
    *(stability_case("manchester-1", speed_kmh, "rails of ERRI B176, low") for speed_kmh in (120.0, 160.0, 200.0)),
    Case(
        "stability-manchester-1-hunting", GROUP,
        "manchester-1: critical speed by linear theory on S1002/UIC60 1:40, beyond its service speeds",
        "no figure is published with the vehicle's data", (200.0, 540.0), "km/h",
        partial(_hunting_kmh, "manchester-1"),
    ),
)  # fmt: skip
