"""The contact of a scenario's coach in figures: geometry, ellipse, stiffness, and what each stretch of rail offers."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.schema import Scenario
from scenarios.units import KMH_PER_MPS
from wheel_rail.adhesion_condition import rail_condition
from wheel_rail.contact_geometry import ContactGeometry
from wheel_rail.contact_parameters import ProfileGeometry
from wheel_rail.contact_table import C11, C22, C23, NODES, ROLLING_RADIUS, SEMI_AXIS_A, SEMI_AXIS_B, SLOPE, STIFFNESS
from wheel_rail.equivalent_conicity import equivalent_conicity
from wheel_rail.recovery import CONDITION, DEGRADED, MU0, RECOVERED, TAU

AMPLITUDES_MM = (1, 2, 3, 4, 5, 6)
STANDING_MPS = 100.0 / KMH_PER_MPS
"""Speed of the creep curves for a coach that starts from rest."""
_STEP_M = 1e-4


@dataclass(frozen=True)
class CentredContact:
    """One wheel of a centred wheelset at the nominal load.

    `stiffness_npm`: normal, of the contact and the track in series; `angle_rad`: of the contact plane; `spin_1pm`: spin
    creepage of a wheel that rolls. `conicity`: equivalent, by EN 15302, at `AMPLITUDES_MM`; None where no wave fits.
    """

    load_n: float
    wheel_radius_m: float
    flange_play_m: float
    semi_axis_a_m: float
    semi_axis_b_m: float
    pressure_pa: float
    stiffness_npm: float
    angle_rad: float
    spin_1pm: float
    c11: float
    c22: float
    c23: float
    conicity: tuple[float | None, ...]


@dataclass(frozen=True)
class RailSort:
    """One stretch of the rail, or all patches of one entry: what lies there, and where it begins.

    `peak_low`, `peak_high`: peak adhesion as found, at 68.7 kN and 100 km/h; `degraded`, `recovered` (mu0, A, B in s/m,
    kA, kS) at a typical place and the scenario's initial speed, `recovered` None where nothing recovers.
    """

    name: str
    from_m: float
    peak_low: float
    peak_high: float
    degraded: tuple[float, ...]
    recovered: tuple[float, ...] | None


@dataclass(frozen=True)
class ContactSheet:
    """All figures of the contact; `speed_mps` is that of the creep curves."""

    centred: CentredContact
    rails: tuple[RailSort, ...]
    speed_mps: float

    def tree(self, scenario: Scenario) -> dict[str, Any]:
        """For a JSON file, with the parameters that the figures follow from."""
        parameters = scenario.coach.contact
        return {
            "contact": parameters.model_dump(mode="json"),
            "creep_law": scenario.creep_law.model_dump(mode="json"),
            "amplitudes_mm": list(AMPLITUDES_MM),
            **asdict(self),
        }


def contact_sheet(scenario: Scenario, line: Line) -> ContactSheet:
    """The figures for the scenario's coach on its `line`."""
    speed_mps = scenario.simulation.initial_speed_kmh / KMH_PER_MPS or STANDING_MPS
    return ContactSheet(_centred(line), _rails(scenario, line, speed_mps), speed_mps)


def geometry_of(line: Line) -> ContactGeometry | None:
    """Wheelset and track as profiles; None for conical wheels."""
    profiles = _profiles(line)
    radius_m = line.contact.radius_m
    return None if profiles is None else ContactGeometry(profiles.geometry, (radius_m, radius_m))


def _profiles(line: Line) -> ProfileGeometry | None:
    parameters = line.contact.parameters
    return parameters.profiles if parameters.geometry == "profiles" else None


def _centred(line: Line) -> CentredContact:
    contact = line.contact
    constants = contact.constants
    row = constants["table"][0, NODES // 2]
    a_m, b_m, slope = row[SEMI_AXIS_A], row[SEMI_AXIS_B], row[SLOPE]
    angle_rad = math.atan(slope)
    return CentredContact(
        load_n=contact.load_n,
        wheel_radius_m=contact.radius_m,
        flange_play_m=float(constants["flange_clearance_m"]),
        semi_axis_a_m=float(a_m),
        semi_axis_b_m=float(b_m),
        pressure_pa=float(1.5 * contact.load_n / (math.pi * a_m * b_m)),
        stiffness_npm=float(row[STIFFNESS]),
        angle_rad=angle_rad,
        spin_1pm=math.sin(angle_rad) / float(row[ROLLING_RADIUS]),
        c11=float(row[C11]),
        c22=float(row[C22]),
        c23=float(row[C23]),
        conicity=_conicities(line),
    )


def _conicities(line: Line) -> tuple[float | None, ...]:
    """Of rigid profiles on a wheelset that is kept level, as the standard wants; of cones up to the flange."""
    constants = line.contact.constants
    play_m = float(constants["flange_clearance_m"])
    geometry = geometry_of(line)
    if geometry is None:
        displacement_m = line.contact.displacement_m
        radius_m = constants["table"][:, :, ROLLING_RADIUS]
        difference_m = radius_m[0] - radius_m[1]
    else:
        # beyond the play as far as an amplitude needs: the standard's wave runs up the flange
        count = round((max(play_m, 1e-3 * AMPLITUDES_MM[-1]) + 2e-3) / _STEP_M)
        displacement_m = _STEP_M * np.arange(-count, count + 1)
        difference_m = geometry.table(displacement_m, level=True).rolling_radius_difference_m[0]
    found: list[float | None] = []
    for amplitude_mm in AMPLITUDES_MM:
        amplitude_m = 1e-3 * amplitude_mm
        fits = amplitude_m < 0.95 * displacement_m[-1]
        value = (
            float(equivalent_conicity(displacement_m, difference_m, np.array([amplitude_m]), line.contact.radius_m)[0])
            if fits and np.ptp(difference_m) > 0.0
            else math.nan
        )
        found.append(value if math.isfinite(value) else None)
    return tuple(found)


def _rails(scenario: Scenario, line: Line, speed_mps: float) -> tuple[RailSort, ...]:
    adhesion = line.adhesion
    surfaces = [*scenario.adhesion.stretches, *scenario.adhesion.patches]
    row_at = adhesion.places[:, :, 1]
    on_line = adhesion.s_m <= line.track.length_m
    sorts = []
    for k, surface in enumerate(surfaces):
        here = (row_at == k) & on_line
        if not here.any():
            continue
        what = surface.surface or "recovers"
        side, place = _typical(adhesion.places[:, :, 0], here)
        condition = np.empty(CONDITION)
        rail_condition(float(adhesion.s_m[place]), side, speed_mps, line.rail, condition)
        recovers = bool(condition[TAU] > 0.0)
        sorts.append(
            RailSort(
                name=what if k < len(scenario.adhesion.stretches) else f"{what} patch",
                from_m=float(adhesion.s_m[here.any(axis=0)][0]),
                peak_low=float(adhesion.peak[here].min()),
                peak_high=float(adhesion.peak[here].max()),
                degraded=tuple(map(float, condition[DEGRADED + MU0 : RECOVERED])),
                recovered=tuple(map(float, condition[RECOVERED + MU0 : TAU])) if recovers else None,
            )
        )
    return tuple(sorts)


def _typical(mu0: np.ndarray, here: np.ndarray) -> tuple[int, int]:
    """Side and place of the friction nearest the median of those that are `here`."""
    off = np.where(here, np.abs(mu0 - np.median(mu0[here])), np.inf)
    side, place = np.unravel_index(int(off.argmin()), off.shape)
    return int(side), int(place)
