"""Hunting: the speed from which a coach's swings on straight track grow, linearised and in a simulated run."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from vehicle.coach import Coach
from vehicle.interface import Actuation, CoachState
from vehicle.linear import Linearisation, clean_rail, conical, polach_contact, without_resistance
from vehicle.modes import RIGID_HZ
from vehicle.observation import OBSERVATION
from vehicle.parameters import CoachParameters
from wheel_rail import Contact, Track, TrackParameters
from wheel_rail.contact_geometry import ContactGeometry
from wheel_rail.contact_table import NODES, ROLLING_RADIUS
from wheel_rail.equivalent_conicity import equivalent_conicity

AMPLITUDE_M = 0.003
"""Amplitude of the wheelset's wave to which an equivalent conicity belongs when none is given."""
HIGHEST_MPS = 150.0
_STEP_MPS = 2.0
_SMALL_GROWTH = 1e-3  # 1/s: motions that neither grow nor decay, rolling along, are found with rounding


def profile_conicity(parameters: CoachParameters, amplitude_m: float = AMPLITUDE_M) -> float:
    """Equivalent conicity, after EN 15302, of the profiles on which the coach runs; of cones their own.

    nan where no wave of that amplitude exists.
    """
    contact = parameters.contact
    if contact.geometry == "conical" and contact.conical is not None:
        return contact.conical.conicity
    if contact.profiles is None:
        return float("nan")
    radius_m = 0.5 * parameters.wheelset.wheel_diameter_m
    reach_m = amplitude_m + 0.004
    displacement_m = np.linspace(-reach_m, reach_m, 141)
    geometry = ContactGeometry(contact.profiles.geometry, (radius_m, radius_m))
    difference_m = geometry.table(displacement_m, level=True).rolling_radius_difference_m[0]
    return float(equivalent_conicity(displacement_m, difference_m, np.array([amplitude_m]), radius_m)[0])


def central_conicity(contact: Contact) -> float:
    """Half the slope of the difference of the rolling radii at the centre of the table: that of small swings."""
    left, right = contact.constants["table"][..., ROLLING_RADIUS]
    near = slice(NODES // 2 - 1, NODES // 2 + 2)
    return float(0.5 * np.polyfit(contact.displacement_m[near], (left - right)[near], 1)[0])


def swings(linearisation: Linearisation, speed_mps: float) -> np.ndarray:
    """Eigenvalues of all swings at a speed, one of each pair, the fastest growing first."""
    rates = np.linalg.eigvals(linearisation.at(speed_mps).state_matrix)
    kept: np.ndarray = rates[rates.imag > 2.0 * np.pi * RIGID_HZ]
    return kept[np.argsort(-kept.real)]


def largest_growth_1ps(linearisation: Linearisation, speed_mps: float) -> float:
    """Growth rate of the swing that decays most slowly or grows fastest."""
    return float(swings(linearisation, speed_mps)[0].real)


@dataclass(frozen=True)
class Hunting:
    """Critical speed of the linearised coach; `speed_mps` is None where it is stable up to `HIGHEST_MPS`.

    `frequency_hz`: of the swing that neither grows nor decays there.
    """

    conicity: float
    speed_mps: float | None
    frequency_hz: float | None


def hunting_speed(linearisation: Linearisation, highest_mps: float = HIGHEST_MPS) -> Hunting:
    """The lowest speed at which a swing stops decaying: root of the largest growth rate, to 1 mm/s."""
    conicity = central_conicity(linearisation.contact)

    def growth(speed_mps: float) -> float:
        return largest_growth_1ps(linearisation, speed_mps) - _SMALL_GROWTH

    low = _STEP_MPS
    for high in np.arange(2.0 * _STEP_MPS, highest_mps + _STEP_MPS, _STEP_MPS):
        if growth(float(high)) > 0.0:
            # a coach that is unstable already at the lowest speed has no root below
            critical = low if growth(low) > 0.0 else float(brentq(growth, low, float(high), xtol=1e-3))
            return Hunting(conicity, critical, float(swings(linearisation, critical)[0].imag / (2.0 * np.pi)))
        low = float(high)
    return Hunting(conicity, None, None)


def hunting_speed_on_cones(parameters: CoachParameters, conicity: float, highest_mps: float = HIGHEST_MPS) -> Hunting:
    """Of the same coach on cones, as equivalent conicity is meant."""
    return hunting_speed(Linearisation(conical(parameters, conicity)), highest_mps)


def swing_after_kick(
    parameters: CoachParameters,
    speed_mps: float,
    *,
    heading_change_rad: float = 1e-4,
    duration_s: float = 6.0,
    step_s: float = 0.002,
    contact: Contact | None = None,
    newton: bool = False,
) -> tuple[np.ndarray, np.ndarray]:
    """Time (n,) and lateral displacement of the wheelsets (n, 4) after the track has turned by a small angle.

    A simulated run at constant speed, without resistance, with all that is nonlinear in the coach: profiles, creep,
    dampers with blow-off, stops; `contact`: None for `polach_contact`. The turn is spread over 20 m; recording begins
    when the last wheelset has left it.
    """
    still = without_resistance(parameters)
    contact = contact or polach_contact(still)
    reach_m = 0.5 * (still.bogie_distance_m + still.wheelbase_m) + 1.0
    turn_m, start_m = 20.0, 3.0 * reach_m
    line = {
        "length_m": start_m + turn_m + speed_mps * duration_s + 3.0 * reach_m,
        "curves": [
            {
                "start_m": start_m,
                "transition_m": 0.5 * turn_m,
                "length_m": 0.0,
                "radius_m": 0.5 * turn_m / heading_change_rad,
            }
        ],
    }
    track = Track(TrackParameters.model_validate(line))
    rail = clean_rail(track.length_m, contact)
    rows = np.zeros(round((duration_s + (turn_m + 4.0 * reach_m) / speed_mps) / step_s) + 2, OBSERVATION)
    count = 0
    idle = Actuation()

    def on_step(t_s: float, state: CoachState) -> Actuation | None:
        nonlocal count
        state.observe(t_s, rows, count)
        count += 1
        return idle

    longest_s = (turn_m + 2.0 * reach_m) / speed_mps + duration_s
    Coach(still, contact, track, rail).run(step_s, longest_s, start_m - reach_m, speed_mps, on_step, step_s, newton)
    seen = rows[:count]
    after = seen[seen["wheelset_position_m"].min(axis=1) > start_m + turn_m]
    return after["t_s"] - after["t_s"][0], after["lateral_displacement_m"]


def growth_of(t_s: np.ndarray, swing: np.ndarray) -> float:
    """Growth rate (1/s) of a swing: slope of the logarithm of its rms in ten stretches, the first two left out.

    `swing` (n, m): several signals that grow or decay together.
    """
    stretches = np.array_split(np.arange(len(t_s)), 10)[2:]
    middle = [float(t_s[rows].mean()) for rows in stretches]
    size = [float(np.sqrt(np.mean((swing[rows] - swing[rows].mean(axis=0)) ** 2))) for rows in stretches]
    return float(np.polyfit(middle, np.log(size), 1)[0])
