"""What the wheels of a coach meet: their places along the track, its frames there, the rails and their condition."""

from vehicle.layout import FRAMES
from wheel_rail.adhesion_condition import NO_KIND, rail_conditions
from wheel_rail.adhesion_memory import recall_friction
from wheel_rail.adhesion_state import RailTables
from wheel_rail.compiled import Array, Record, array_at, compiled, inlined
from wheel_rail.contact import FRAME, put_row
from wheel_rail.irregularities import ASIDE, OFFSETS, SLOPES, UP, Three, displaced_frame, rail_offsets
from wheel_rail.lane_arrays import lanes_at, of_pairs, of_places, of_wheelsets, put_lanes
from wheel_rail.lanes import LANES, Lanes, doubled, every
from wheel_rail.track_frame import FRAME_ROWS, track_frames

_MOST_LOOKS, _NEAR_M = 20, 1e-3


@compiled
def find_rails(q: Array, v: Array, coach: Record, track: Array, rail: RailTables) -> None:
    """Bring up to date what the wheels meet: places along the track, track frames, the rails there, their condition."""
    locate(q, coach, track)
    if coach.offset_nodes > 0:
        _displace_rails(q, coach)
    else:
        for k in range(FRAME_ROWS):
            put_row(coach.wheels, FRAME + k, doubled(lanes_at(coach.frame, LANES * k)))
    put_lanes(coach.along, 0, speeds_along(v, coach))
    meet_rails(coach, rail)
    if rail.memory_distance_m > 0.0:
        recall_friction(coach.condition, coach.memory)
        coach.condition_kind[:] = NO_KIND


@inlined
def meet_rails(coach: Record, rail: RailTables) -> None:
    """The rails' condition under each wheel."""
    for i in range(4):
        rail_conditions(i, coach.s[i], coach.along[i], rail, coach.condition, coach.condition_kind)


@compiled
def locate(q: Array, coach: Record, track: Array) -> None:
    """Bring the places of wheelsets and carbody along the track up to date, and the track frames there."""
    s, frames = coach.s, coach.frame
    # within a millimetre a frame is as good as the one at the new place
    for _ in range(_MOST_LOOKS):
        track_frames(s, FRAMES, coach.track_origin_m, track, frames)
        here = lanes_at(s, 0)
        put_lanes(coach.frame_s, 0, here)
        ahead, _ = from_frames(q, coach)
        put_lanes(s, 0, here + ahead)
        if every(abs(ahead) < _NEAR_M):
            break


@inlined
def from_frames(q: Array, coach: Record) -> tuple[Lanes, Lanes]:
    """How far along the track from the origins of their frames wheelsets and carbody stand, and how far to the left."""
    frames, places = coach.frame, coach.frame_place
    (x, y, z), (tx, ty, tz), (nx, ny, nz) = _three(frames, 0), _three(frames, 3), _three(frames, 6)
    dx, dy, dz = of_places(q, places, 0, 0) - x, of_places(q, places, 0, 1) - y, of_places(q, places, 0, 2) - z
    aside = dx * nx + dy * ny + dz * nz
    # decimetres over a radius of curvature: 1/(1 - x) is 1 + x + x^2 to a millionth of a way that is millimetres
    inward = lanes_at(frames, 13 * LANES) * aside
    return (dx * tx + dy * ty + dz * tz) * (1.0 + inward * (1.0 + inward)), aside


@inlined
def speeds_along(v: Array, coach: Record) -> Lanes:
    """Speeds of wheelsets and carbody along the track."""
    places, (tx, ty, tz) = coach.frame_place, _three(coach.frame, 3)
    return of_places(v, places, 0, 0) * tx + of_places(v, places, 0, 1) * ty + of_places(v, places, 0, 2) * tz


@inlined
def _three(rows: Array, number: int) -> Three:
    at = number * LANES
    return lanes_at(rows, at), lanes_at(rows, at + LANES), lanes_at(rows, at + 2 * LANES)


@inlined
def _three_doubled(rows: Array, number: int) -> Three:
    x, y, z = _three(rows, number)
    return doubled(x), doubled(y), doubled(z)


@compiled
def _displace_rails(q: Array, coach: Record) -> None:
    """The track frame as the rail under each wheel has it, on rough rails."""
    offsets = coach.offsets
    table = array_at(coach.offsets_at, (coach.offset_nodes, OFFSETS))
    for i in range(4):
        rail_offsets(coach.s[i], coach.offset_first_m, coach.offset_cell_m, table, offsets[i])
    track, wheels = coach.frame, coach.wheels
    x0, y0, z0 = _three_doubled(track, 0)
    (x, y, z), (ahead, left, up, twist, curvature) = displaced_frame(
        (of_wheelsets(q, 18, 6) - x0, of_wheelsets(q, 19, 6) - y0, of_wheelsets(q, 20, 6) - z0),
        (
            _three_doubled(track, 3), _three_doubled(track, 6), _three_doubled(track, 9),
            doubled(lanes_at(track, 12 * LANES)), doubled(lanes_at(track, 13 * LANES)),
        ),
        (
            of_pairs(offsets, ASIDE, OFFSETS), of_pairs(offsets, UP, OFFSETS),
            of_pairs(offsets, SLOPES + ASIDE, OFFSETS), of_pairs(offsets, SLOPES + UP, OFFSETS),
        ),
    )  # fmt: skip
    _put_three(wheels, FRAME, (x0 + x, y0 + y, z0 + z))
    _put_three(wheels, FRAME + 3, ahead)
    _put_three(wheels, FRAME + 6, left)
    _put_three(wheels, FRAME + 9, up)
    put_row(wheels, FRAME + 12, twist)
    put_row(wheels, FRAME + 13, curvature)


@inlined
def _put_three(rows: Array, number: int, values: Three) -> None:
    put_row(rows, number, values[0])
    put_row(rows, number + 1, values[1])
    put_row(rows, number + 2, values[2])
