"""The coach standing in its suspension on the track, its wheels rolling: where every run and every analysis starts."""

import numpy as np
from scipy.spatial.transform import Rotation

from vehicle.layout import BODIES, COORDINATES, SPIN, centres, coach_record
from vehicle.parameters import CoachParameters
from wheel_rail import Contact, Track
from wheel_rail.adhesion_state import RailTables, rail_record
from wheel_rail.track import track_frame


def start_state(
    parameters: CoachParameters,
    contact: Contact,
    track: Track,
    rail: RailTables,
    position_m: float,
    speed_mps: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Record for the compiled routines, coordinates q and velocities v (46,); keep `rail` alive as long as the record.

    Every body stands square to the track at its own place, at the height of static equilibrium on level straight track.
    """
    record = coach_record(parameters, contact)
    coach = record[0]
    coach["rail"] = rail_record(rail)
    coach["memory"] = 1.0
    coach["track_origin_m"] = track.origin_m
    q, v = np.zeros(COORDINATES), np.zeros(COORDINATES)
    frame = np.empty(14)
    for i, (x, _, z) in enumerate(centres(parameters, contact)):
        track_frame(position_m + x, track.origin_m, track.table, frame)
        axes = frame[3:12].reshape(3, 3)
        q[6 * i : 6 * i + 3] = frame[:3] + z * axes[2]
        coach["attitude"][i] = Rotation.from_matrix(axes.T).as_quat(scalar_first=True)
        v[6 * i : 6 * i + 3] = speed_mps * axes[0]
        if i == 0 or i >= BODIES - 4:
            coach["s"][i - 3 if i else 4] = position_m + x
    coach["passed"] = coach["s"][:4]
    v[SPIN:] = speed_mps / contact.rolling_radius_m
    return record, q, v
