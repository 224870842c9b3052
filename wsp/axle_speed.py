"""What a controller makes of the axle speeds: smooth speed and acceleration, and wheels of different wear compared."""

import numpy as np
from numpy.typing import NDArray

from wsp.compiled import compiled


@compiled
def fading_memory_after(
    speed_mps: float, acceleration_mps2: float, measured_mps: float, memory: float, period_s: float
) -> tuple[float, float]:
    """Speed (m/s) and acceleration (m/s2) after one more measurement, by a straight line through the past.

    The errors' weights fade by memory m = exp(-period/time constant) per tick, which makes it the alpha-beta filter
    with alpha = 1 - m^2 and beta = (1 - m)^2.
    """
    predicted = speed_mps + acceleration_mps2 * period_s
    residual = measured_mps - predicted
    speed = predicted + (1.0 - memory * memory) * residual
    return speed, acceleration_mps2 + (1.0 - memory) ** 2 / period_s * residual


@compiled
def compare_wheels(
    ratio: NDArray[np.float64],
    axle_speed_mps: NDArray[np.float64],
    counted: NDArray[np.bool_],
    share: float,
    largest_difference: float,
) -> None:
    """Move the ratio (n,) of each wheel that is counted (n,), its indicated speed over the mean, towards what is seen.

    By `share` of the way. To be called while all wheels roll freely: then unequal speeds mean unequal diameters, not
    slip. The ratios stay within 1 +- largest_difference. Axle speeds (n,) in m/s; nothing is learnt from speeds that
    differ by more than worn wheels do (a wheel that stands, turns backwards or is not read).
    """
    total = 0.0
    count = 0
    for axle in range(ratio.shape[0]):
        if counted[axle]:
            total += axle_speed_mps[axle]
            count += 1
    mean = total / count if count else 0.0
    for axle in range(ratio.shape[0]):
        # written so that nan, and a mean of zero, fail it
        if counted[axle] and (not abs(axle_speed_mps[axle] - mean) <= largest_difference * abs(mean) or mean == 0.0):
            return
    for axle in range(ratio.shape[0]):
        if counted[axle]:
            ratio[axle] += share * (axle_speed_mps[axle] / mean - ratio[axle])
            ratio[axle] = min(max(ratio[axle], 1.0 - largest_difference), 1.0 + largest_difference)
