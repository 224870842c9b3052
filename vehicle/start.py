"""The coach standing in its suspension on the track, its wheels rolling: where every run and every analysis starts."""

import numpy as np
from scipy.spatial.transform import Rotation

from vehicle.layout import BODIES, BODY_FRAME, SPIN, centres, coach_record, first_coordinate
from vehicle.parameters import CoachParameters
from wheel_rail import Contact, Track
from wheel_rail.adhesion_state import RailTables, rail_record
from wheel_rail.compiled import address_of
from wheel_rail.irregularities import ASIDE, OFFSETS, SLOPES, UP, rail_offsets
from wheel_rail.track_frame import track_frame
from wheel_rail.track_parameters import RAIL_SPACING_M


def start_state(
    parameters: CoachParameters,
    contact: Contact,
    track: Track,
    rail: RailTables,
    position_m: float,
    speed_mps: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Record for the compiled routines, coordinates q and velocities v (coordinates,); keep `track` and `rail` alive as
    long.

    Every body stands square to the track at its own place, at the height of static equilibrium on level straight track;
    where wheels are unequal, as they lift it, and on rough rails moved and rolled as those below it are.
    """
    record = coach_record(parameters, contact)
    coach = record[0]
    coach["rail"] = rail_record(rail)
    coach["memory"] = 1.0
    coach["track_origin_m"] = track.origin_m
    if track.irregularities is not None:
        rough = track.irregularities
        coach["offsets_at"], coach["offset_nodes"] = address_of(rough.table), len(rough.table)
        coach["offset_first_m"], coach["offset_cell_m"] = rough.first_m, rough.cell_m
    q, v = np.zeros(coach["coordinates"]), np.zeros(coach["coordinates"])
    at = centres(parameters, contact)
    rod = parameters.traction_rod
    lifts = _lifts(coach["oversize"], at, rod.height_m if rod else parameters.bogie.height_m)
    for i, ((x, y, z), (ahead, lift, roll, pitch)) in enumerate(zip(at, lifts, strict=True)):
        place, axes = _rails_at(track, position_m + x)
        first = first_coordinate(i)
        q[first : first + 3] = place + ahead * axes[0] + (y - roll * z) * axes[1] + (z + lift) * axes[2]
        turned = Rotation.from_matrix(axes.T) * Rotation.from_rotvec([roll, pitch, 0.0])
        coach["attitude"][:, i] = turned.as_quat(scalar_first=True)
        v[first : first + 3] = speed_mps * axes[0]
        if i == 0 or BODIES - 4 <= i < BODIES:
            coach["s"][i - 3 if i else slice(BODY_FRAME, None)] = position_m + x
    coach["passed"] = coach["s"][:4]
    v[SPIN : SPIN + 4] = speed_mps / (contact.rolling_radius_m + coach["oversize"].mean(axis=1))
    return record, q, v


def _rails_at(track: Track, s_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Place (3,) and axes (3, 3), row by row, of the track at s, moved and rolled as its rails are there."""
    frame = np.empty(14)
    track_frame(s_m, track.origin_m, track.table, frame)
    place, axes = frame[:3], frame[3:12].reshape(3, 3)
    rough = track.irregularities
    if rough is not None:
        offsets = np.zeros(OFFSETS)
        rail_offsets(s_m, rough.first_m, rough.cell_m, rough.table, offsets)
        aside, up = offsets[ASIDE:UP], offsets[UP:SLOPES]  # left, right
        place = place + np.mean(aside) * axes[1] + np.mean(up) * axes[2]
        axes = Rotation.from_rotvec((up[0] - up[1]) / RAIL_SPACING_M * axes[0]).apply(axes)
    return place, axes


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
