"""Where the bodies' coordinates stand, and how the bodies are turned: quaternions that grow step by step."""

from wheel_rail.compiled import Array, Record, compiled, inlined


@inlined
def place_of(body: int) -> int:
    """First coordinate of a body; the four spins stand between wheelsets and axle boxes."""
    return 6 * body if body < 7 else 6 * body + 4


@compiled
def body_frames(q: Array, coach: Record) -> None:
    """Rotation matrices of the bodies at q."""
    for i in range(coach.bodies):
        w, x, y, z = attitude(i, q, coach)
        r = coach.rotation[i]
        r[0, 0] = 1.0 - 2.0 * (y * y + z * z)
        r[0, 1] = 2.0 * (x * y - w * z)
        r[0, 2] = 2.0 * (x * z + w * y)
        r[1, 0] = 2.0 * (x * y + w * z)
        r[1, 1] = 1.0 - 2.0 * (x * x + z * z)
        r[1, 2] = 2.0 * (y * z - w * x)
        r[2, 0] = 2.0 * (x * z - w * y)
        r[2, 1] = 2.0 * (y * z + w * x)
        r[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@compiled
def attitude(i: int, q: Array, coach: Record) -> tuple[float, float, float, float]:
    """Unit quaternion of body i at q: the committed one, turned by what the turn coordinates have grown since."""
    at = place_of(i)
    a = 0.5 * (q[at + 3] - coach.turned[i, 0])
    b = 0.5 * (q[at + 4] - coach.turned[i, 1])
    c = 0.5 * (q[at + 5] - coach.turned[i, 2])
    angle2 = a * a + b * b + c * c
    # sine over angle and cosine to rounding for half turns below 0.03 rad: a step turns a body by far less
    s = 1.0 - angle2 / 6.0 * (1.0 - angle2 / 20.0 * (1.0 - angle2 / 42.0))
    d = 1.0 - 0.5 * angle2 * (1.0 - angle2 / 12.0 * (1.0 - angle2 / 30.0))
    a *= s
    b *= s
    c *= s
    old = coach.attitude[i]
    w, x, y, z = old[0], old[1], old[2], old[3]
    return (
        w * d - x * a - y * b - z * c,
        w * a + x * d + y * c - z * b,
        w * b - x * c + y * d + z * a,
        w * c + x * b - y * a + z * d,
    )


@compiled
def commit_attitudes(q: Array, coach: Record) -> None:
    """Take the rotations at q as those from which the next turns count."""
    for i in range(coach.bodies):
        w, x, y, z = attitude(i, q, coach)
        # one Newton step to unit length: products drift by rounding only
        scale = 1.5 - 0.5 * (w * w + x * x + y * y + z * z)
        own = coach.attitude[i]
        own[0], own[1], own[2], own[3] = w * scale, x * scale, y * scale, z * scale
        for j in range(3):
            coach.turned[i, j] = q[place_of(i) + 3 + j]
