"""What a run really did: motion of the coach, its wheelsets, its brake, and what the tachometers in the loop gave."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from sensors.readings import AxleSpeedReadings, TachometerReadings
from sensors.streams import WHEELS, WHEELSETS, XYZ, FloatArray, Int8Array, Stream, quantity
from wheel_rail.adhesion_state import ENERGY_KEPT, SAND_KEPT, STATE_CELL_M

RAILS = ("left", "right")
BOGIES = ("front", "rear")


class MotionStream(Stream):
    """The carbody's motion at the record period, and the balances of the whole coach that tests audit."""

    t_s: FloatArray = quantity("s", about="time from the start of the run")
    position_m: FloatArray = quantity("m", about="of the carbody's centre along the track")
    speed_mps: FloatArray = quantity("m/s", about="of the carbody along the track")
    acceleration_mps2: FloatArray = quantity("m/s2", about="of the carbody along the track")
    gradient_permille: FloatArray = quantity("permille", about="of the track at the carbody's centre, positive uphill")
    curvature_radpm: FloatArray = quantity("rad/m", about="of the track at the carbody's centre, positive to the left")
    cant_mm: FloatArray = quantity(
        "mm", about="of the track at the carbody's centre, positive with the right rail raised"
    )
    roll_rad: FloatArray = quantity("rad", about="of the carbody against the horizontal")
    pitch_rad: FloatArray = quantity("rad", about="of the carbody against the horizontal, nose down positive")
    yaw_rad: FloatArray = quantity("rad", about="heading of the carbody since the start of the track")
    specific_force_mps2: FloatArray = quantity(
        "m/s2", XYZ, about="acceleration minus gravity at the carbody's centre of mass, carbody axes"
    )
    angular_rate_radps: FloatArray = quantity("rad/s", XYZ, about="of the carbody, carbody axes")
    angular_acceleration_radps2: FloatArray = quantity("rad/s2", XYZ, about="of the carbody, carbody axes")
    kinetic_energy_j: FloatArray = quantity("J", about="of all bodies")
    power_gravity_w: FloatArray = quantity("W", about="power of gravity")
    power_suspension_w: FloatArray = quantity("W", about="power of springs, dampers and stops, positive into motion")
    power_contact_normal_w: FloatArray = quantity("W", about="power of the contacts' normal forces")
    power_creep_w: FloatArray = quantity("W", about="power of the creep forces")
    power_brake_w: FloatArray = quantity("W", about="power of the brake torques")
    power_drive_w: FloatArray = quantity("W", about="power of the drive torques")
    power_resistance_w: FloatArray = quantity("W", about="power of the running resistance")
    power_track_brake_w: FloatArray = quantity("W", about="power of the magnetic track brakes")
    momentum_ns: FloatArray = quantity("N s", XYZ, about="of all bodies, world axes")
    external_force_n: FloatArray = quantity(
        "N", XYZ, about="gravity, contacts, resistance and track brakes on all bodies, world axes"
    )


class WheelsetStream(Stream):
    """The wheelsets 1..4 from the front at the record period; eight wheels 1L 1R 2L ..."""

    t_s: FloatArray = quantity("s", about="time from the start of the run")
    position_m: FloatArray = quantity("m", WHEELSETS, about="of the wheelset's centre along the track")
    speed_mps: FloatArray = quantity("m/s", WHEELSETS, about="of the wheelset's centre along the track")
    rim_speed_mps: FloatArray = quantity("m/s", WHEELSETS, about="angular speed times rolling radius")
    wheel_angle_rad: FloatArray = quantity("rad", WHEELSETS, about="angle turned since the start")
    slip: FloatArray = quantity("1", WHEELSETS, about="(speed - rim speed)/speed, positive when braking")
    normal_force_n: FloatArray = quantity("N", WHEELS, about="normal force of the contact")
    longitudinal_force_n: FloatArray = quantity(
        "N", WHEELS, about="creep force on the wheel along the track, positive forward"
    )
    lateral_force_n: FloatArray = quantity("N", WHEELS, about="creep force on the wheel to the left")
    lateral_displacement_m: FloatArray = quantity(
        "m", WHEELSETS, about="of the wheelset against the track, to the left"
    )
    peak_adhesion: FloatArray = quantity("1", WHEELSETS, about="what the rail offers there at this speed and load")
    peak_slip: FloatArray = quantity("1", WHEELSETS, about="slip at which the rail offers it")
    brake_torque_nm: FloatArray = quantity("N m", WHEELSETS, about="friction torque acting on the wheelset")
    drive_torque_nm: FloatArray = quantity("N m", WHEELSETS, about="of motors and dynamic brake, positive forward")
    friction_power_w: FloatArray = quantity("W", WHEELSETS, about="dissipated in both contacts")


class BrakeStream(Stream):
    """Brake, valves and what the wheel slide protection sees, at the record period."""

    t_s: FloatArray = quantity("s", about="time from the start of the run")
    demand: FloatArray = quantity("1", about="brake demand, 1 is full service")
    distributor_pressure_bar: FloatArray = quantity("bar", about="gauge pressure at the distributor's output")
    cylinder_pressure_bar: FloatArray = quantity("bar", WHEELSETS, about="gauge pressure in the cylinders of the axle")
    valve_command: Int8Array = quantity(
        "1", WHEELSETS, about="command in force, before the valves' dead time: 0 fill, 1 hold, 2 vent", dtype=np.int8
    )
    valve: Int8Array = quantity("1", WHEELSETS, about="state of the valves: 0 fill, 1 hold, 2 vent", dtype=np.int8)
    safety_timer_fired: Int8Array = quantity(
        "1", WHEELSETS, about="1 where the valves' safety timer has taken the axle from the controller", dtype=np.int8
    )
    sand_command: Int8Array = quantity("1", WHEELSETS, about="1 where the sander is to work", dtype=np.int8)
    track_brake_command: Int8Array = quantity("1", about="1 where the track brakes are to work", dtype=np.int8)
    friction_torque_capacity_nm: FloatArray = quantity("N m", WHEELSETS, about="largest friction torque of the brake")
    dynamic_brake_torque_nm: FloatArray = quantity("N m", WHEELSETS, about="of the dynamic brake, against the rotation")
    track_brake_force_n: FloatArray = quantity("N", BOGIES, about="friction of the magnets of a bogie on the rails")
    disc_temperature_degc: FloatArray = quantity("degC", WHEELSETS, about="mean temperature of the discs of the axle")
    reservoir_pressure_bar: FloatArray = quantity("bar", about="gauge pressure in the auxiliary reservoir")
    axle_speed_mps: FloatArray = quantity("m/s", WHEELSETS, about="speed as the wheel slide protection sees it")
    reference_speed_mps: FloatArray = quantity("m/s", about="of the wheel slide protection; nan where it has none")
    air_nl: FloatArray = quantity("nl", about="air drawn from the supply so far, normal litres")


class RailStream(Stream):
    """What the rails keep, per cell of 0.1 m."""

    position_m: FloatArray = quantity("m", about="begin of the cell along the track")
    energy_jpm: FloatArray = quantity("J/m", RAILS, about="friction energy that wheels have left")
    sand_gpm: FloatArray = quantity("g/m", RAILS, about="sand")


def rail_stream(table: np.ndarray) -> RailStream:
    """The state `table` (2, n, 2) of `wheel_rail.RailState` as a stream."""
    position_m = STATE_CELL_M * np.arange(table.shape[1], dtype=np.float64)
    return RailStream(
        position_m=position_m, energy_jpm=table[:, :, ENERGY_KEPT].T.copy(), sand_gpm=table[:, :, SAND_KEPT].T.copy()
    )


@dataclass(frozen=True)
class SolveRecord:
    """How the solve went; times are those of the wall clock."""

    simulated_s: float
    wall_s: float
    realtime_factor: float
    step_s: float
    exudyn_build: str
    ended: Literal["standstill", "time"]


@dataclass(frozen=True)
class Truth:
    """All that the co-simulation yields."""

    motion: MotionStream
    wheelsets: WheelsetStream
    brake: BrakeStream
    rail_before: RailStream
    rail: RailStream
    tachometer: TachometerReadings
    axle_speeds: AxleSpeedReadings
    solve: SolveRecord
