"""The coach standing in its suspension on the track, its wheels rolling: where every run and every analysis starts."""

import numpy as np
from scipy.spatial.transform import Rotation

from vehicle.layout import BODIES, COORDINATES, SPIN, centres, coach_record
from vehicle.parameters import CoachParameters
from wheel_rail import Contact, Track
from wheel_rail.adhesion_state import RailTables, rail_record
from wheel_rail.compiled import address_of
from wheel_rail.irregularities import rail_offsets
from wheel_rail.track import track_frame
from wheel_rail.track_parameters import RAIL_SPACING_M


def start_state(
    parameters: CoachParameters,
    contact: Contact,
    track: Track,
    rail: RailTables,
    position_m: float,
    speed_mps: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Record for the compiled routines, coordinates q and velocities v (46,); keep `track` and `rail` alive as long.

    Every body stands square to the track at its own place, at the height of static equilibrium on level straight track;
    on rough rails it is moved and rolled as the rails below it are.
    """
    record = coach_record(parameters, contact)
    coach = record[0]
    coach["rail"] = rail_record(rail)
    coach["memory"] = 1.0
    coach["track_origin_m"] = track.origin_m
    q, v = np.zeros(COORDINATES), np.zeros(COORDINATES)
    frame, offsets = np.empty(14), np.zeros(8)
    rough = track.irregularities
    if rough is not None:
        coach["offsets_at"], coach["offset_nodes"] = address_of(rough.table), len(rough.table)
        coach["offset_first_m"], coach["offset_cell_m"] = rough.first_m, rough.cell_m
    for i, (x, _, z) in enumerate(centres(parameters, contact)):
        track_frame(position_m + x, track.origin_m, track.table, frame)
        axes = frame[3:12].reshape(3, 3)
        if rough is not None:
            rail_offsets(position_m + x, rough.first_m, rough.cell_m, rough.table, offsets)
            aside, up = 0.5 * (offsets[:2] + offsets[2:4])
            frame[:3] += aside * axes[1] + up * axes[2]
            axes = Rotation.from_rotvec((offsets[1] - offsets[3]) / RAIL_SPACING_M * axes[0]).apply(axes)
        q[6 * i : 6 * i + 3] = frame[:3] + z * axes[2]
        coach["attitude"][i] = Rotation.from_matrix(axes.T).as_quat(scalar_first=True)
        v[6 * i : 6 * i + 3] = speed_mps * axes[0]
        if i == 0 or i >= BODIES - 4:
            coach["s"][i - 3 if i else 4] = position_m + x
    coach["passed"] = coach["s"][:4]
    v[SPIN:] = speed_mps / contact.rolling_radius_m
    return record, q, v
