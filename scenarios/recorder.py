"""Records the co-simulation at its own period into rows that grow, and makes the streams of truth from them."""

from collections.abc import Sequence

import numpy as np

from scenarios.truth import BrakeStream, MotionStream, WheelsetStream
from vehicle import OBSERVATION, POWERS, CoachState
from wheel_rail import Contact, Track
from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.recovery import offered_adhesion
from wsp import Brake, ControllerOutput

_STILL_MPS = 0.1  # below this slip has no meaning and is recorded as zero


class Recorder:
    """One row of coach and brake per call of `record`, in blocks: what is written is not copied again in the run."""

    _BRAKE_COLUMNS = 21
    _BLOCK = 4096

    def __init__(self) -> None:
        self._full: list[tuple[np.ndarray, np.ndarray]] = []
        self._begin_block()

    def _begin_block(self) -> None:
        self._motion = np.zeros(self._BLOCK, OBSERVATION)
        self._brake = np.zeros((self._BLOCK, self._BRAKE_COLUMNS))
        self._rows = 0

    @property
    def _motion_rows(self) -> np.ndarray:
        return np.concatenate([*(motion for motion, _ in self._full), self._motion[: self._rows]])

    @property
    def _brake_rows(self) -> np.ndarray:
        return np.concatenate([*(brake for _, brake in self._full), self._brake[: self._rows]])

    def record(
        self,
        t_s: float,
        state: CoachState,
        demand: float,
        brake: Brake,
        axle_speed_mps: np.ndarray,
        output: ControllerOutput,
    ) -> None:
        """Write what is true at `t_s`; the brake as it stands before the step that begins there."""
        if self._rows == self._BLOCK:
            self._full.append((self._motion, self._brake))
            self._begin_block()
        n = self._rows
        state.observe(t_s, self._motion, n)
        row = self._brake[n]
        row[0] = demand
        row[1] = output.reference_speed_mps
        row[2:6] = axle_speed_mps
        row[6:10] = brake.valve_state
        row[10:21] = brake.plant_state
        self._rows = n + 1

    def brake_stream(self) -> BrakeStream:
        """Brake, valves and what the WSP sees."""
        rows = self._brake_rows
        plant = rows[:, 10:21]
        return BrakeStream(
            t_s=self._motion_rows["t_s"],
            demand=rows[:, 0],
            reference_speed_mps=rows[:, 1],
            axle_speed_mps=rows[:, 2:6],
            valve=rows[:, 6:10].astype(np.int8),
            distributor_pressure_bar=plant[:, Brake.DISTRIBUTOR],
            air_nl=plant[:, Brake.DRAWN],
            cylinder_pressure_bar=plant[:, Brake.CYLINDER],
            friction_torque_capacity_nm=plant[:, Brake.TORQUE],
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
            **{f"power_{name}_w": rows["power_w"][:, k] for k, name in enumerate(POWERS)},
        )

    def wheelset_stream(self, contact: Contact) -> WheelsetStream:
        """Wheelsets; `contact` for the peak adhesion on offer, a centred wheel's."""
        rows = self._motion_rows
        speed = rows["wheelset_speed_mps"]
        moving = np.abs(speed) > _STILL_MPS
        slip = np.where(moving, (speed - rows["rim_speed_mps"]) / np.where(moving, speed, 1.0), 0.0)
        offered, at_slip = np.empty_like(speed), np.empty_like(speed)
        law = contact.law
        _offered_adhesion(
            speed,
            rows["normal_force_n"],
            np.ascontiguousarray(rows["rail_condition"]),
            (law.number, law.address),
            law.extra,
            tuple(contact.patch),
            contact.load_n,
            contact.parameters.shear_modulus_pa,
            offered,
            at_slip,
        )
        copied = ("t_s", "rim_speed_mps", "wheel_angle_rad", "lateral_displacement_m", "normal_force_n",
                  "longitudinal_force_n", "lateral_force_n", "brake_torque_nm", "friction_power_w")  # fmt: skip
        return WheelsetStream(
            **_fields(rows, copied),
            position_m=rows["wheelset_position_m"],
            speed_mps=speed,
            slip=slip,
            peak_adhesion=offered,
            peak_slip=at_slip,
        )


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
