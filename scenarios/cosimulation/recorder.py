"""Records the co-simulation at its own period into rows that grow, and makes the streams of truth from them."""

import contextlib
import mmap
from collections.abc import Iterator

import numpy as np

from scenarios.cosimulation.core import BRAKE_ROW
from scenarios.truth import BrakeStream, MotionStream, WheelsetStream
from sensors.streams import quantities
from vehicle import OBSERVATION, POWERS
from wheel_rail import Contact, Track
from wheel_rail.adhesion_condition import NO_KIND, past_conditions
from wheel_rail.adhesion_memory import recall_friction
from wheel_rail.adhesion_state import RailTables
from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.lanes import LANES
from wheel_rail.peak_adhesion import offered_to_wheels
from wheel_rail.recovery import CONDITION

_BLOCK = 4096
_HUGE_PAGE = 1 << 21
_STILL_MPS = 0.1  # below this slip has no meaning and is recorded as zero

_OF_MOTION = ("t_s", "position_m", "speed_mps", "acceleration_mps2", "roll_rad", "pitch_rad", "yaw_rad",
              "specific_force_mps2", "angular_rate_radps", "angular_acceleration_radps2", "kinetic_energy_j",
              "momentum_ns", "external_force_n")  # fmt: skip
_OF_WHEELSETS = ("t_s", "rim_speed_mps", "wheel_angle_rad", "lateral_displacement_m", "normal_force_n",
                 "longitudinal_force_n", "lateral_force_n", "brake_torque_nm", "drive_torque_nm",
                 "friction_power_w")  # fmt: skip


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

    def _taken(self, kind: int) -> Iterator[tuple[slice, np.ndarray]]:
        """Block after block, and which rows of the whole it is. Each goes once it is used: a long run would be there
        twice."""
        blocks = self._full[kind]
        blocks.append(self.block[kind][: self.rows])
        blocks.reverse()
        begin = 0
        while blocks:
            block = blocks.pop()
            yield slice(begin, begin + len(block)), block
            begin += len(block)

    def brake(self, t_s: np.ndarray) -> BrakeStream:
        """Brake, valves and what the WSP sees, at the times of the motion."""
        columns = {
            name: np.empty((len(t_s), *BRAKE_ROW[name].shape), what.dtype)
            for name, what in quantities(BrakeStream).items()
            if name != "t_s"
        }
        for rows, block in self._taken(1):
            for name, values in columns.items():
                values[rows] = block[name]
        return BrakeStream(t_s=t_s, **columns)

    def motion_and_wheelsets(
        self, track: Track, contact: Contact, rail: RailTables
    ) -> tuple[MotionStream, WheelsetStream]:
        """The carbody's motion with the track where it is, and the wheelsets; `contact` and `rail` for the peak
        adhesion on offer, a centred wheel's."""
        count = self._before + self.rows
        columns = {
            name: np.empty((count, *OBSERVATION[name].shape))
            for name in OBSERVATION.names or ()
            if name not in ("rail_kept", "memory")  # of use only here
        }
        speed = columns["wheelset_speed_mps"]
        offered, at_slip = np.empty_like(speed), np.empty_like(speed)
        law = contact.law
        for rows, block in self._taken(0):
            for name, values in columns.items():
                values[rows] = block[name]
            _offered_adhesion(
                block,
                rail,
                (law.number, law.address),
                law.extra,
                tuple(contact.patch),
                contact.load_n,
                contact.parameters.shear_modulus_pa,
                offered[rows],
                at_slip[rows],
            )
        position, power = columns["position_m"], columns["power_w"]
        motion = MotionStream(
            **{name: columns[name] for name in _OF_MOTION},
            gradient_permille=track.gradient_permille(position),
            curvature_radpm=track.curvature_radpm(position),
            cant_mm=track.cant_mm(position),
            **{f"power_{name}_w": power[:, k] for k, name in enumerate(POWERS)},
        )
        moving = np.abs(speed) > _STILL_MPS
        slip = np.where(moving, (speed - columns["rim_speed_mps"]) / np.where(moving, speed, 1.0), 0.0)
        wheelsets = WheelsetStream(
            **{name: columns[name] for name in _OF_WHEELSETS},
            position_m=columns["wheelset_position_m"],
            speed_mps=speed,
            slip=slip,
            peak_adhesion=offered,
            peak_slip=at_slip,
        )
        return motion, wheelsets


def _new_block() -> tuple[np.ndarray, np.ndarray]:
    return _own_pages(OBSERVATION), _own_pages(BRAKE_ROW)


def _own_pages(dtype: np.dtype) -> np.ndarray:
    """Rows of zeros in pages of their own, which the system has back with the block; the allocator would keep them.

    Huge pages where there are any: small ones are handed out one by one, within the run.
    """
    size = _BLOCK * dtype.itemsize
    pages = mmap.mmap(-1, -(-size // _HUGE_PAGE) * _HUGE_PAGE, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    if hasattr(mmap, "MADV_HUGEPAGE"):
        with contextlib.suppress(OSError):  # a system without them
            pages.madvise(mmap.MADV_HUGEPAGE)
    return np.frombuffer(pages, dtype, _BLOCK)


@compiled
def _offered_adhesion(
    rows: np.ndarray, rail: RailTables, law: tuple[int, int], extra: Array, patch: Vector, reference_load_n: float,
    shear_modulus_pa: float, offered: Array, at_slip: Array,
) -> None:  # fmt: skip
    """Load-weighted peak adhesion of the two wheels of each wheelset, into `offered` (n, 4), and the slip that it is
    found at into `at_slip`; both 0 for a wheelset in the air. `rows` (n,) of dtype OBSERVATION."""
    here, kinds = np.empty((CONDITION, LANES)), np.full(LANES, NO_KIND)
    # eight wheels together, of whatever row and wheelset, cost little more than one
    condition = np.zeros((CONDITION, LANES))
    wheel_speed, load, share, peak, creep = np.zeros((5, LANES))
    asked = np.empty((LANES, 2), np.int64)
    offered[:] = 0.0
    at_slip[:] = 0.0
    count, last = 0, 4 * rows.shape[0] - 1
    for number in range(last + 1):
        n, i = number // 4, number % 4
        row = rows[n]
        if i == 0:
            past_conditions(
                row.wheelset_position_m, row.wheelset_speed_mps, row.rail_kept[0], row.rail_kept[1], rail, here, kinds
            )
            if rail.memory_distance_m > 0.0:
                recall_friction(here, row.memory)
                kinds[:] = NO_KIND
        of_wheels = max(row.normal_force_n[2 * i], 0.0), max(row.normal_force_n[2 * i + 1], 0.0)
        both = of_wheels[0] + of_wheels[1]
        # peak adhesion hardly depends on the load: on rails alike one search serves both wheels
        alike = _alike(here, 2 * i)
        for side in range(1 if alike else 2):
            carried = both if alike else of_wheels[side]
            if carried > 0.0:
                asked[count] = n, i
                wheel_speed[count] = abs(row.wheelset_speed_mps[i])
                load[count] = max(0.5 * both if alike else carried, 1.0)
                share[count] = carried / both
                condition[:, count] = here[:, 2 * i + side]
                count += 1
            if count == LANES or (number == last and count > 0):
                load[count:] = 0.0
                offered_to_wheels(
                    law[0], law[1], extra, wheel_speed, load, patch, reference_load_n, condition, shear_modulus_pa,
                    True, peak, creep,
                )  # fmt: skip
                for w in range(count):
                    offered[asked[w, 0], asked[w, 1]] += share[w] * peak[w]
                    at_slip[asked[w, 0], asked[w, 1]] += share[w] * creep[w]
                count = 0


@compiled
def _alike(conditions: Array, left: int) -> bool:
    """Whether the rails' conditions under a left wheel and the right one beside it differ by 2 % at most in each
    number."""
    alike = True
    for k in range(CONDITION):
        alike &= abs(conditions[k, left] - conditions[k, left + 1]) <= 0.02 * abs(conditions[k, left])
    return alike
