"""Where the bodies' coordinates stand, and how the bodies are turned: quaternions that grow step by step.

Eight bodies are worked on at once, a lane for each; lanes without a body follow the carbody and are not read.
"""

from wheel_rail.compiled import Array, Record, compiled, inlined
from wheel_rail.lane_arrays import lanes_at, of_places, put_lanes
from wheel_rail.lanes import LANES, Lanes

BODY_LANES = 2 * LANES


@inlined
def place_of(body: int) -> int:
    """First coordinate of a body; the four spins stand between wheelsets and axle boxes."""
    return 6 * body if body < 7 else 6 * body + 4


@compiled
def body_frames(q: Array, coach: Record) -> None:
    """Rotation matrices of the bodies at q, into `coach.rotation` (3, 3, BODY_LANES)."""
    for first in range(0, coach.bodies, LANES):
        w, x, y, z = _attitudes(first, q, coach)
        rotation = coach.rotation
        put_lanes(rotation, first, 1.0 - 2.0 * (y * y + z * z))
        put_lanes(rotation, first + BODY_LANES, 2.0 * (x * y - w * z))
        put_lanes(rotation, first + 2 * BODY_LANES, 2.0 * (x * z + w * y))
        put_lanes(rotation, first + 3 * BODY_LANES, 2.0 * (x * y + w * z))
        put_lanes(rotation, first + 4 * BODY_LANES, 1.0 - 2.0 * (x * x + z * z))
        put_lanes(rotation, first + 5 * BODY_LANES, 2.0 * (y * z - w * x))
        put_lanes(rotation, first + 6 * BODY_LANES, 2.0 * (x * z - w * y))
        put_lanes(rotation, first + 7 * BODY_LANES, 2.0 * (y * z + w * x))
        put_lanes(rotation, first + 8 * BODY_LANES, 1.0 - 2.0 * (x * x + y * y))


@inlined
def _attitudes(first: int, q: Array, coach: Record) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    """Unit quaternions of eight bodies at q: the committed ones, turned by what the turn coordinates grew by since."""
    old, turned, places = coach.attitude, coach.turned, coach.body_place
    a = 0.5 * (of_places(q, places, first, 3) - lanes_at(turned, first))
    b = 0.5 * (of_places(q, places, first, 4) - lanes_at(turned, first + BODY_LANES))
    c = 0.5 * (of_places(q, places, first, 5) - lanes_at(turned, first + 2 * BODY_LANES))
    angle2 = a * a + b * b + c * c
    # sine over angle and cosine to rounding for half turns below 0.03 rad: a step turns a body by far less
    s = 1.0 - angle2 * (1.0 / 6.0 - angle2 * (1.0 / 120.0 - angle2 * (1.0 / 5040.0)))
    d = 1.0 - angle2 * (0.5 - angle2 * (1.0 / 24.0 - angle2 * (1.0 / 720.0)))
    a, b, c = a * s, b * s, c * s
    w, x = lanes_at(old, first), lanes_at(old, first + BODY_LANES)
    y, z = lanes_at(old, first + 2 * BODY_LANES), lanes_at(old, first + 3 * BODY_LANES)
    return (
        w * d - x * a - y * b - z * c,
        w * a + x * d + y * c - z * b,
        w * b - x * c + y * d + z * a,
        w * c + x * b - y * a + z * d,
    )


@compiled
def commit_attitudes(q: Array, coach: Record) -> None:
    """Take the rotations at q as those from which the next turns count."""
    old, turned, places = coach.attitude, coach.turned, coach.body_place
    for first in range(0, coach.bodies, LANES):
        w, x, y, z = _attitudes(first, q, coach)
        # one Newton step to unit length: products drift by rounding only
        scale = 1.5 - 0.5 * (w * w + x * x + y * y + z * z)
        put_lanes(old, first, w * scale)
        put_lanes(old, first + BODY_LANES, x * scale)
        put_lanes(old, first + 2 * BODY_LANES, y * scale)
        put_lanes(old, first + 3 * BODY_LANES, z * scale)
        put_lanes(turned, first, of_places(q, places, first, 3))
        put_lanes(turned, first + BODY_LANES, of_places(q, places, first, 4))
        put_lanes(turned, first + 2 * BODY_LANES, of_places(q, places, first, 5))
