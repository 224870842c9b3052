"""Records the co-simulation at its own period into rows that grow, and makes the streams of truth from them."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from scenarios.cosimulation.core import BRAKE_ROW
from scenarios.truth import BrakeStream, MotionStream, WheelsetStream
from vehicle import OBSERVATION, POWERS
from wheel_rail import Contact, Track
from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.recovery import offered_adhesion

_BLOCK = 4096
_STILL_MPS = 0.1  # below this slip has no meaning and is recorded as zero


class Recorder:
    """Rows of coach and brake in blocks, which the compiled loop fills: what is written is not copied in the run.

    `block`: the arrays (of dtypes OBSERVATION and BRAKE_ROW) being filled; `rows`: how far, once the run is over.
    """

    def __init__(self) -> None:
        self._full: tuple[list[np.ndarray], list[np.ndarray]] = [], []
        self.block = _new_block()
        self._before = 0
        self.rows = 0

    def make_room(self, rows: int, needed: int) -> int:
        """With `rows` of the block filled and so many more to come: begin another one if they do not fit; its rows."""
        if rows + needed <= _BLOCK:
            return rows
        for full, block in zip(self._full, self.block, strict=True):
            full.append(block[:rows])
        self.block = _new_block()
        self._before += rows
        return 0

    def motion_rows(self, first: int, last: int) -> np.ndarray:
        """Rows first..last - 1 of the motion since the start; they may lie in the last two blocks."""
        begin, end = first - self._before, last - self._before
        rows = self.block[0][max(begin, 0) : end]
        return np.concatenate([self._full[0][-1][begin:], rows]) if begin < 0 else rows

    @property
    def before(self) -> int:
        """Rows before those of the block."""
        return self._before

    def _rows_of(self, kind: int) -> np.ndarray:
        """All rows in one array; the blocks go, as a long run would be there twice."""
        whole = np.concatenate([*self._full[kind], self.block[kind][: self.rows]])
        self._full[kind].clear()
        return whole

    @cached_property
    def _motion_rows(self) -> np.ndarray:
        return self._rows_of(0)

    def brake_stream(self) -> BrakeStream:
        """Brake, valves and what the WSP sees."""
        rows = self._rows_of(1)
        whole = ("valve", "valve_command", "sand_command", "track_brake_command", "safety_timer_fired")
        return BrakeStream(
            t_s=self._motion_rows["t_s"].copy(),
            valve=rows["valve"].astype(np.int8),
            valve_command=rows["valve_command"].astype(np.int8),
            sand_command=rows["sand_command"].astype(np.int8),
            track_brake_command=rows["track_brake_command"].astype(np.int8),
            safety_timer_fired=rows["safety_timer_fired"].astype(np.int8),
            **_fields(rows, [name for name in BRAKE_ROW.names or () if name not in whole]),
        )

    def motion_stream(self, track: Track) -> MotionStream:
        """The carbody's motion, and the track where it is."""
        rows = self._motion_rows
        position = rows["position_m"]
        copied = ("t_s", "position_m", "speed_mps", "acceleration_mps2", "roll_rad", "pitch_rad", "yaw_rad",
                  "specific_force_mps2", "angular_rate_radps", "angular_acceleration_radps2", "kinetic_energy_j",
                  "momentum_ns", "external_force_n")  # fmt: skip
        return MotionStream(
            **_fields(rows, copied),
            gradient_permille=track.gradient_permille(position),
            curvature_radpm=track.curvature_radpm(position),
            cant_mm=track.cant_mm(position),
            **{f"power_{name}_w": rows["power_w"][:, k].copy() for k, name in enumerate(POWERS)},
        )

    def wheelset_stream(self, contact: Contact) -> WheelsetStream:
        """Wheelsets; `contact` for the peak adhesion on offer, a centred wheel's."""
        rows = self._motion_rows
        speed = rows["wheelset_speed_mps"].copy()
        moving = np.abs(speed) > _STILL_MPS
        slip = np.where(moving, (speed - rows["rim_speed_mps"]) / np.where(moving, speed, 1.0), 0.0)
        offered, at_slip = np.empty_like(speed), np.empty_like(speed)
        law = contact.law
        for first in range(0, len(rows), _BLOCK):
            some = slice(first, first + _BLOCK)
            _offered_adhesion(
                speed[some],
                rows["normal_force_n"][some],
                np.ascontiguousarray(rows["rail_condition"][some]),
                (law.number, law.address),
                law.extra,
                tuple(contact.patch),
                contact.load_n,
                contact.parameters.shear_modulus_pa,
                offered[some],
                at_slip[some],
            )
        copied = ("t_s", "rim_speed_mps", "wheel_angle_rad", "lateral_displacement_m", "normal_force_n",
                  "longitudinal_force_n", "lateral_force_n", "brake_torque_nm", "drive_torque_nm",
                  "friction_power_w")  # fmt: skip
        return WheelsetStream(
            **_fields(rows, copied),
            position_m=rows["wheelset_position_m"].copy(),
            speed_mps=speed,
            slip=slip,
            peak_adhesion=offered,
            peak_slip=at_slip,
        )


def _new_block() -> tuple[np.ndarray, np.ndarray]:
    return np.zeros(_BLOCK, OBSERVATION), np.zeros(_BLOCK, BRAKE_ROW)


def _fields(rows: np.ndarray, names: Sequence[str]) -> dict[str, np.ndarray]:
    return {name: np.ascontiguousarray(rows[name]) for name in names}


@compiled
def _offered_adhesion(
    speed: Array, normal: Array, conditions: Array, law: tuple[int, int], extra: Array, patch: Vector,
    reference_load_n: float, shear_modulus_pa: float, offered: Array, at_slip: Array,
) -> None:  # fmt: skip
    """Load-weighted peak adhesion of the two wheels of each wheelset, into `offered` (n, 4), and the slip that it is
    found at into `at_slip`."""
    for n in range(speed.shape[0]):
        for i in range(4):
            left, right = conditions[n, 0, i], conditions[n, 1, i]
            loads = max(normal[n, 2 * i], 0.0), max(normal[n, 2 * i + 1], 0.0)
            if loads[0] + loads[1] <= 0.0:
                offered[n, i] = at_slip[n, i] = 0.0
                continue
            # peak adhesion hardly depends on the load: on rails alike one search serves both wheels
            alike = True
            for k in range(left.size):
                if abs(left[k] - right[k]) > 0.02 * abs(left[k]):
                    alike = False
            total = slip = 0.0
            for side in range(2):
                if side == 1 and alike:
                    break
                load = 0.5 * (loads[0] + loads[1]) if alike else loads[side]
                growth = np.cbrt(load / reference_load_n)
                grown = (patch[0] * growth, patch[1] * growth, patch[2], patch[3], patch[4], patch[5])
                condition = right if side == 1 else left
                peak, creep = offered_adhesion(
                    law[0], law[1], extra, abs(speed[n, i]), max(load, 1.0), grown, condition, shear_modulus_pa, True
                )
                carried = 2.0 * load if alike else load
                total += peak * carried
                slip += creep * carried
            offered[n, i] = total / (loads[0] + loads[1])
            at_slip[n, i] = slip / (loads[0] + loads[1])
