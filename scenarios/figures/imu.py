"""Readings of the IMU against the truth."""

import numpy as np
from matplotlib.figure import Figure

from scenarios.figures.style import TRUE_COLOUR, legend, new_figure, plot, robust_limits
from scenarios.truth import MotionStream
from sensors import ImuParameters, ImuReadings, mounting_rotation

READING_COLOUR = "#e08a3c"


def draw_imu(motion: MotionStream, imu: ImuReadings, mounting: ImuParameters) -> Figure:
    """Specific force and angular rate as read, against the truth at the carbody's centre of mass in the sensor's axes.

    What lies between them is the sensor's: noise, bias, drift, bandwidth, and the lever arm.
    """
    angles = (mounting.mounting_roll_deg, mounting.mounting_pitch_deg, mounting.mounting_yaw_deg)
    to_sensor = mounting_rotation(*np.radians(angles)).T
    turned = ", ".join(f"{angle:g}" for angle in angles)
    title = f"IMU readings and truth in the IMU's axes (mounted at roll, pitch, yaw {turned} deg)"
    figure, panels = new_figure(title, 8.6, rows=3, columns=2)
    for column, (heading, read, true, unit) in enumerate(
        (
            ("specific force", imu.specific_force_mps2, motion.specific_force_mps2 @ to_sensor, "m/s²"),
            ("angular rate", imu.angular_rate_radps, motion.angular_rate_radps @ to_sensor, "rad/s"),
        )
    ):
        for i, name in enumerate("xyz"):
            axes = panels[i, column]
            plot(axes, imu.t_s, read[:, i], color=READING_COLOUR, linewidth=0.6, label="reading")
            plot(axes, motion.t_s, true[:, i], color=TRUE_COLOUR, linewidth=0.8, label="truth")
            axes.set_ylim(robust_limits(np.concatenate([read[:, i], true[:, i]])))
            axes.set_ylabel(f"{name}   {unit}")
        panels[0, column].set_title(heading)
        panels[-1, column].set_xlabel("time  s")
    legend(panels[0, 0], columns=2, place="lower left")
    return figure
