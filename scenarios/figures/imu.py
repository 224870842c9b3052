"""Readings of the IMU against the truth."""

import numpy as np
from matplotlib.figure import Figure

from scenarios.figures.style import TRUE_COLOUR, legend, new_figure, robust_limits, thinned
from scenarios.truth import MotionStream
from sensors import ImuParameters, ImuReadings

AXES = ("x, forward", "y, left", "z, up")
READING_COLOUR = "#e08a3c"


def draw_imu(motion: MotionStream, imu: ImuReadings, mounting: ImuParameters) -> Figure:
    """Specific force and angular rate: the sensor's own axes against the carbody's at its centre of mass."""
    turned = f"{mounting.mounting_roll_deg:g}, {mounting.mounting_pitch_deg:g}, {mounting.mounting_yaw_deg:g}"
    title = f"IMU readings (axes turned by roll, pitch, yaw {turned} deg) against truth (carbody axes, centre of mass)"
    figure, panels = new_figure(title, 8.6, rows=3, columns=2)
    true_rows, read_rows = thinned(len(motion)), thinned(len(imu))
    for i, axis in enumerate(AXES):
        for axes, read, true, unit in (
            (panels[i, 0], imu.specific_force_mps2[:, i], motion.specific_force_mps2[:, i], "m/s²"),
            (panels[i, 1], imu.angular_rate_radps[:, i], motion.angular_rate_radps[:, i], "rad/s"),
        ):
            axes.plot(imu.t_s[read_rows], read[read_rows], color=READING_COLOUR, linewidth=0.6, label="reading")
            axes.plot(motion.t_s[true_rows], true[true_rows], color=TRUE_COLOUR, linewidth=0.8, label="truth")
            axes.set_ylim(robust_limits(np.concatenate([read, true])))
            axes.set_ylabel(f"{axis}   {unit}")
    panels[0, 0].set_title("specific force")
    panels[0, 1].set_title("angular rate")
    legend(panels[0, 0], columns=2, place="lower left")
    for axes in panels[-1]:
        axes.set_xlabel("time  s")
    return figure
