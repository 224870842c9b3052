"""Sand and track brake: asked for where the rail gives too little and slide protection alone cannot help.

The train's deceleration while an axle is under control is what the rail gives (gradient and resistance included, which
nothing on board tells apart): near g times the adhesion when all axles slide.
"""

import numpy as np
from numpy.typing import NDArray

from wsp.compiled import Record
from wsp.controllers.records import part_of_tick
from wsp.controllers.supervision import under_control


@part_of_tick
def _counted(count: int, short: bool, longest: int) -> int:
    return min(count + 1, 2 * longest) if short else max(count - 1, 0)


@part_of_tick
def request(s: Record, c: Record, sand: NDArray[np.bool_], at_work: bool) -> bool:
    """Fill in the wish for sand (4,), all sanders alike; whether the track brake is wanted."""
    sliding = at_work and s.reference_mps >= c.request_above_mps and under_control(s, c)
    if not sliding:
        s.short_of_sand = s.short_of_track_brake = 0
    else:
        short = s.deceleration_mps2 < c.sand_below_mps2
        s.short_of_sand = _counted(s.short_of_sand, short, c.request_after)
        short = s.deceleration_mps2 < c.track_brake_below_mps2
        s.short_of_track_brake = _counted(s.short_of_track_brake, short, c.request_after)
    sand[:] = s.short_of_sand >= c.request_after
    return bool(s.short_of_track_brake >= c.request_after)
