"""Sensor masks: truth in, readings out. Arrays of kinematics go in; nothing here knows a vehicle.

Conventions
    Frames: carbody x forward, y left, z up, right-handed; the IMU's own axes are turned by its mounting,
    sensor = Rx(roll) Ry(pitch) Rz(yaw) carbody. Specific force f = a - g: a level sensor at rest reads +9.81 m/s2 on z.
    Units: SI, with the unit at the end of every name; temperatures in degrees Celsius, mounting angles in degrees.
    Time: seconds from the start of the run; every record carries its own.
    Noise: a density is sigma sqrt(Ts), the coefficient N of the Allan deviation, in unit/sqrt(Hz); a drift is a
    first-order Gauss-Markov process given by its standard deviation and correlation time, stationary from the start.
    Wheels: angles and speeds positive rolling forward; wheelsets 1..4 from the front.
    Records: frozen and read-only (`streams.Stream`), the unit of each field declared once, in the class.
    Random numbers: one stream for each term of each sensor, SeedSequence(seed, spawn_key=(sensor, term)); a run cut
    into chunks in any way gives the same bytes.
"""

from sensors.balises import BaliseParameters, Balises
from sensors.imu import Calibration, Imu, gravity_calibration, mounting_rotation
from sensors.imu_parameters import IMU_PRESETS, ImuParameters
from sensors.random_streams import BALISE_SENSOR, CALIBRATION_TERM, IMU_SENSOR, random_stream
from sensors.readings import AxleSpeedReadings, BaliseReadings, ImuReadings, Kinematics, TachometerReadings
from sensors.streams import Column, Stream, StreamError, columns, quantities, quantity
from sensors.tachometers import TachometerParameters, Tachometers, axle_speeds

__all__ = [
    "BALISE_SENSOR",
    "CALIBRATION_TERM",
    "IMU_PRESETS",
    "IMU_SENSOR",
    "AxleSpeedReadings",
    "BaliseParameters",
    "BaliseReadings",
    "Balises",
    "Calibration",
    "Column",
    "Imu",
    "ImuParameters",
    "ImuReadings",
    "Kinematics",
    "Stream",
    "StreamError",
    "TachometerParameters",
    "TachometerReadings",
    "Tachometers",
    "axle_speeds",
    "columns",
    "gravity_calibration",
    "mounting_rotation",
    "quantities",
    "quantity",
    "random_stream",
]
