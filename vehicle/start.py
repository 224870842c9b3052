"""The coach standing in its suspension on the track, its wheels rolling: where every run and every analysis starts."""

import numpy as np
from scipy.spatial.transform import Rotation

from vehicle.layout import BODIES, SPIN, centres, coach_record, first_coordinate
from vehicle.parameters import CoachParameters
from wheel_rail import Contact, Track
from wheel_rail.adhesion_state import RailTables, rail_record
from wheel_rail.track import RAIL_SPACING_M, track_frame


def start_state(
    parameters: CoachParameters,
    contact: Contact,
    track: Track,
    rail: RailTables,
    position_m: float,
    speed_mps: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Record for the compiled routines, coordinates q and velocities v (coordinates,); keep `rail` alive as long as it.

    Every body stands square to the track at its own place, at the height of static equilibrium on level straight track;
    where wheels are unequal, as they lift it.
    """
    record = coach_record(parameters, contact)
    coach = record[0]
    coach["rail"] = rail_record(rail)
    coach["memory"] = 1.0
    coach["track_origin_m"] = track.origin_m
    q, v = np.zeros(coach["coordinates"]), np.zeros(coach["coordinates"])
    frame = np.empty(14)
    at = centres(parameters, contact)
    rod = parameters.traction_rod
    lifts = _lifts(coach["oversize"], at, rod.height_m if rod else parameters.bogie.height_m)
    for i, ((x, y, z), (ahead, lift, roll, pitch)) in enumerate(zip(at, lifts, strict=True)):
        track_frame(position_m + x, track.origin_m, track.table, frame)
        axes = frame[3:12].reshape(3, 3)
        first = first_coordinate(i)
        q[first : first + 3] = frame[:3] + ahead * axes[0] + (y - roll * z) * axes[1] + (z + lift) * axes[2]
        turned = Rotation.from_matrix(axes.T) * Rotation.from_rotvec([roll, pitch, 0.0])
        coach["attitude"][i] = turned.as_quat(scalar_first=True)
        v[first : first + 3] = speed_mps * axes[0]
        if i == 0 or BODIES - 4 <= i < BODIES:
            coach["s"][i - 3 if i else 4] = position_m + x
    coach["passed"] = coach["s"][:4]
    v[SPIN : SPIN + 4] = speed_mps / (contact.rolling_radius_m + coach["oversize"].mean(axis=1))
    return record, q, v


def _lifts(oversize: np.ndarray, at: np.ndarray, pulled_at_m: float) -> np.ndarray:
    """How far the bodies at `at` (bodies, 3) are moved forwards and up (m), rolled and pitched (rad) by wheels that are
    too large by so much, (4, 2): a bogie pitches with its wheelsets as one, about the height where it is pulled."""
    lifts = np.zeros((len(at), 4))
    lifts[3:7, 1] = oversize.mean(axis=1)
    lifts[3:7, 2] = (oversize[:, 0] - oversize[:, 1]) / RAIL_SPACING_M
    for body, front, rear in ((1, 3, 4), (2, 5, 6), (0, 1, 2)):
        lifts[body] = 0.5 * (lifts[front] + lifts[rear])
        lifts[body, 3] = -(lifts[front, 1] - lifts[rear, 1]) / (at[front, 0] - at[rear, 0])
    for bogie in (1, 2):
        lifts[1 + 2 * bogie : 3 + 2 * bogie, 3] = lifts[bogie, 3]
    lifts[:7, 0] = lifts[:7, 3] * (at[:7, 2] - pulled_at_m)
    for box in range(BODIES, len(at)):
        lifts[box] = lifts[3 + (box - BODIES) // 2]
        lifts[box, 1] += lifts[box, 2] * at[box, 1]
    return lifts
