"""What goes into the sensors (`Kinematics`) and what comes out of them (readings), as records with units."""

import numpy as np

from sensors.streams import WHEELSETS, XYZ, BoolArray, FloatArray, Int8Array, Stream, quantity


class Kinematics(Stream):
    """True motion of the carbody's centre of mass, in carbody axes (x forward, y left, z up)."""

    t_s: FloatArray = quantity("s", about="time from the start of the run")
    specific_force_mps2: FloatArray = quantity("m/s2", XYZ, about="acceleration minus gravity at the centre of mass")
    angular_rate_radps: FloatArray = quantity("rad/s", XYZ, about="angular rate of the carbody")
    angular_acceleration_radps2: FloatArray = quantity("rad/s2", XYZ, about="angular acceleration of the carbody")


class ImuReadings(Stream):
    """Readings of a triaxial accelerometer and gyroscope, in the sensor's own (turned) axes."""

    t_s: FloatArray = quantity("s", about="time of the sample")
    specific_force_mps2: FloatArray = quantity("m/s2", XYZ, about="measured specific force, sensor axes")
    angular_rate_radps: FloatArray = quantity("rad/s", XYZ, about="measured angular rate, sensor axes")
    temperature_degc: FloatArray = quantity("degC", about="reading of the chip's temperature sensor")


class TachometerReadings(Stream):
    """Pulse edges of the tachometers in the order of time."""

    t_s: FloatArray = quantity("s", about="time of the edge by the counter's clock")
    wheelset: Int8Array = quantity("1", about="wheelset 1..4 from the front", dtype=np.int8)
    direction: Int8Array = quantity("1", about="+1 turning forward, -1 backward (from quadrature)", dtype=np.int8)


class AxleSpeedReadings(Stream):
    """Speeds that the tachometers' front end makes of the edges, with the assumed wheel radii; positive forward."""

    t_s: FloatArray = quantity("s", about="time of the tick")
    axle_speed_mps: FloatArray = quantity("m/s", WHEELSETS, about="rim speed from pulses")
    valid: BoolArray = quantity("1", WHEELSETS, about="whether the speed may be used", dtype=np.bool_)


class BaliseReadings(Stream):
    """Balises passed: when, and the position that the balise tells (not quite where it lies)."""

    t_s: FloatArray = quantity("s", about="time of the passage")
    position_m: FloatArray = quantity("m", about="position told by the balise")
