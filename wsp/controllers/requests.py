"""Sand and track brake: asked for where the rail gives too little and slide protection alone cannot help.

The train's deceleration while an axle is under control is what the rail gives (gradient and resistance included, which
nothing on board tells apart): near g times the adhesion when all axles slide.
"""

from wsp.compiled import Record
from wsp.controllers.records import part_of_tick
from wsp.controllers.supervision import under_control


@part_of_tick
def _counted(count: int, short: bool, longest: int) -> int:
    return min(count + 1, 2 * longest) if short else max(count - 1, 0)


@part_of_tick
def request(s: Record, c: Record, output: Record, at_work: bool) -> None:
    """Fill in the wishes for sand, all sanders alike, and for the track brake."""
    sliding = at_work and s.reference_mps >= c.request_above_mps and under_control(s, c)
    if not sliding:
        s.short_of_sand = s.short_of_track_brake = 0
    else:
        short = s.deceleration_mps2 < c.sand_below_mps2
        s.short_of_sand = _counted(s.short_of_sand, short, c.request_after)
        short = s.deceleration_mps2 < c.track_brake_below_mps2
        s.short_of_track_brake = _counted(s.short_of_track_brake, short, c.request_after)
    output.sand[:] = 1 if s.short_of_sand >= c.request_after else 0
    output.track_brake = 1 if s.short_of_track_brake >= c.request_after else 0
