"""Forces of springs, dampers, bump stops, links and anti-roll bars, and their Jacobian, compiled.

Every element joins an upper and a lower body at two points that coincide at rest. Deflection and its speed are taken
in the upper body's axes: d = R_u^T (p_l - p_u); the force acts on both bodies at the lower point, which conserves
momentum, angular momentum and energy.
"""

import math

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


@compiled
def _on_curve(x: float, curve: int, coach: Record) -> tuple[float, float]:
    """Force and slope of a characteristic."""
    side = 0 if x >= 0.0 else 1
    n = coach.curve_points[curve, side]
    size = abs(x)
    k = 1
    while k < n - 1 and size > coach.curve_x[curve, side, k]:
        k += 1
    slope = coach.curve_slope[curve, side, k]
    force = coach.curve_force[curve, side, k - 1] + slope * (size - coach.curve_x[curve, side, k - 1])
    return math.copysign(force, x), slope


@inlined
def _axis_force(deflection: float, speed: float, element: int, axis: int, coach: Record) -> tuple[float, float, float]:
    """Force along one axis of an element, and its slopes over deflection and speed."""
    k = coach.stiffness[element, axis]
    c = coach.damping[element, axis]
    force = k * deflection + c * speed
    if coach.damper[element, axis] >= 0:
        extra, slope = _on_curve(speed, coach.damper[element, axis], coach)
        force += extra
        c += slope
    if coach.stop[element, axis] >= 0:
        extra, slope = _on_curve(deflection, coach.stop[element, axis], coach)
        force += extra
        k += slope
    return force, k, c


@inlined
def _world_rate(rotation: Array, v: Array, at: int) -> tuple[float, float, float]:
    """Angular velocity in the world of the body whose coordinates begin at `at`."""
    x, y, z = v[at + 3], v[at + 4], v[at + 5]
    return (
        rotation[0, 0] * x + rotation[0, 1] * y + rotation[0, 2] * z,
        rotation[1, 0] * x + rotation[1, 1] * y + rotation[1, 2] * z,
        rotation[2, 0] * x + rotation[2, 1] * y + rotation[2, 2] * z,
    )


@inlined
def _relative(q: Array, v: Array, coach: Record, e: int, out: Array) -> None:
    """Deflection (3), its speed (3), lever arms of the lower point on upper (3) and lower (3) body: `out` (12,)."""
    u, w = coach.upper[e], coach.lower[e]
    ru, rw = coach.rotation[u], coach.rotation[w]
    point, rest = coach.lower_point[e], coach.upper_point[e]
    a, b, c = point[0], point[1], point[2]
    ax = rw[0, 0] * a + rw[0, 1] * b + rw[0, 2] * c
    ay = rw[1, 0] * a + rw[1, 1] * b + rw[1, 2] * c
    az = rw[2, 0] * a + rw[2, 1] * b + rw[2, 2] * c
    at_u, at_w = place_of(u), place_of(w)
    bx, by, bz = q[at_w] + ax - q[at_u], q[at_w + 1] + ay - q[at_u + 1], q[at_w + 2] + az - q[at_u + 2]
    wu, wl = _world_rate(ru, v, at_u), _world_rate(rw, v, at_w)
    sx = v[at_w] - v[at_u] + wl[1] * az - wl[2] * ay - (wu[1] * bz - wu[2] * by)
    sy = v[at_w + 1] - v[at_u + 1] + wl[2] * ax - wl[0] * az - (wu[2] * bx - wu[0] * bz)
    sz = v[at_w + 2] - v[at_u + 2] + wl[0] * ay - wl[1] * ax - (wu[0] * by - wu[1] * bx)
    for j in range(3):
        x, y, z = ru[0, j], ru[1, j], ru[2, j]
        out[j] = x * bx + y * by + z * bz - rest[j]
        out[3 + j] = x * sx + y * sy + z * sz
    out[6], out[7], out[8] = bx, by, bz
    out[9], out[10], out[11] = ax, ay, az


@compiled
def add_suspension(q: Array, v: Array, coach: Record, f: Array) -> None:
    """Add all element forces to the generalised force `f` (coordinates,); needs `body_frames`."""
    e = 0
    while e < coach.elements:
        e = _add_between(e, q, v, coach, f)


@compiled
def _add_between(first: int, q: Array, v: Array, coach: Record, f: Array) -> int:
    """Add the forces of element `first` and of those behind it between the same two bodies; the number of the next.

    What is the same for all of them is worked out once, and everything is summed in the upper body's axes.
    """
    u, w = coach.upper[first], coach.lower[first]
    ru, rw = coach.rotation[u], coach.rotation[w]
    at_u, at_w = place_of(u), place_of(w)
    # the lower body in the upper one's axes: its axes, its centre, that one's speed, the rate of turn between them
    m00 = ru[0, 0] * rw[0, 0] + ru[1, 0] * rw[1, 0] + ru[2, 0] * rw[2, 0]
    m01 = ru[0, 0] * rw[0, 1] + ru[1, 0] * rw[1, 1] + ru[2, 0] * rw[2, 1]
    m02 = ru[0, 0] * rw[0, 2] + ru[1, 0] * rw[1, 2] + ru[2, 0] * rw[2, 2]
    m10 = ru[0, 1] * rw[0, 0] + ru[1, 1] * rw[1, 0] + ru[2, 1] * rw[2, 0]
    m11 = ru[0, 1] * rw[0, 1] + ru[1, 1] * rw[1, 1] + ru[2, 1] * rw[2, 1]
    m12 = ru[0, 1] * rw[0, 2] + ru[1, 1] * rw[1, 2] + ru[2, 1] * rw[2, 2]
    m20 = ru[0, 2] * rw[0, 0] + ru[1, 2] * rw[1, 0] + ru[2, 2] * rw[2, 0]
    m21 = ru[0, 2] * rw[0, 1] + ru[1, 2] * rw[1, 1] + ru[2, 2] * rw[2, 1]
    m22 = ru[0, 2] * rw[0, 2] + ru[1, 2] * rw[1, 2] + ru[2, 2] * rw[2, 2]
    x, y, z = q[at_w] - q[at_u], q[at_w + 1] - q[at_u + 1], q[at_w + 2] - q[at_u + 2]
    cx = ru[0, 0] * x + ru[1, 0] * y + ru[2, 0] * z
    cy = ru[0, 1] * x + ru[1, 1] * y + ru[2, 1] * z
    cz = ru[0, 2] * x + ru[1, 2] * y + ru[2, 2] * z
    ox, oy, oz = v[at_u + 3], v[at_u + 4], v[at_u + 5]
    x, y, z = v[at_w] - v[at_u], v[at_w + 1] - v[at_u + 1], v[at_w + 2] - v[at_u + 2]
    vx = ru[0, 0] * x + ru[1, 0] * y + ru[2, 0] * z - (oy * cz - oz * cy)
    vy = ru[0, 1] * x + ru[1, 1] * y + ru[2, 1] * z - (oz * cx - ox * cz)
    vz = ru[0, 2] * x + ru[1, 2] * y + ru[2, 2] * z - (ox * cy - oy * cx)
    x, y, z = v[at_w + 3], v[at_w + 4], v[at_w + 5]
    ox, oy, oz = m00 * x + m01 * y + m02 * z - ox, m10 * x + m11 * y + m12 * z - oy, m20 * x + m21 * y + m22 * z - oz
    force_x = force_y = force_z = 0.0
    upper_x = upper_y = upper_z = lower_x = lower_y = lower_z = 0.0  # moments about the two centres
    e = first
    while e < coach.elements and coach.upper[e] == u and coach.lower[e] == w:
        if coach.pushes[e]:
            point, rest = coach.lower_point[e], coach.upper_point[e]
            x, y, z = point[0], point[1], point[2]
            ax, ay, az = m00 * x + m01 * y + m02 * z, m10 * x + m11 * y + m12 * z, m20 * x + m21 * y + m22 * z
            bx, by, bz = cx + ax, cy + ay, cz + az
            fx, _, _ = _axis_force(bx - rest[0], vx + oy * az - oz * ay, e, 0, coach)
            fy, _, _ = _axis_force(by - rest[1], vy + oz * ax - ox * az, e, 1, coach)
            fz, _, _ = _axis_force(bz - rest[2], vz + ox * ay - oy * ax, e, 2, coach)
            fz += coach.preload[e]
            force_x, force_y, force_z = force_x + fx, force_y + fy, force_z + fz
            upper_x += by * fz - bz * fy
            upper_y += bz * fx - bx * fz
            upper_z += bx * fy - by * fx
            lower_x += ay * fz - az * fy
            lower_y += az * fx - ax * fz
            lower_z += ax * fy - ay * fx
        if coach.turns[e]:
            # small relative rotation of the lower body, and its rate
            stiffness, damping = coach.rotational_stiffness[e], coach.rotational_damping[e]
            tx = stiffness[0] * 0.5 * (m21 - m12) + damping[0] * ox
            ty = stiffness[1] * 0.5 * (m02 - m20) + damping[1] * oy
            tz = stiffness[2] * 0.5 * (m10 - m01) + damping[2] * oz
            upper_x, upper_y, upper_z = upper_x + tx, upper_y + ty, upper_z + tz
            lower_x, lower_y, lower_z = lower_x + tx, lower_y + ty, lower_z + tz
        e += 1
    for j in range(3):
        along = ru[j, 0] * force_x + ru[j, 1] * force_y + ru[j, 2] * force_z
        f[at_u + j] += along
        f[at_w + j] -= along
    f[at_u + 3] += upper_x
    f[at_u + 4] += upper_y
    f[at_u + 5] += upper_z
    f[at_w + 3] -= m00 * lower_x + m10 * lower_y + m20 * lower_z
    f[at_w + 4] -= m01 * lower_x + m11 * lower_y + m21 * lower_z
    f[at_w + 5] -= m02 * lower_x + m12 * lower_y + m22 * lower_z
    return e


@compiled
def add_suspension_jacobian(
    q: Array, v: Array, coach: Record, factor_q: float, factor_v: float, jacobian: Array
) -> None:
    """Subtract df/dq factor_q + df/dv factor_v of the elements from `jacobian`, geometric stiffness left out.

    With G the map of coordinate increments to the deflection in the upper body's axes, each element gives G^T K G.
    """
    rel = coach.probe_element
    g = coach.probe_map
    for e in range(coach.elements):
        u, w = coach.upper[e], coach.lower[e]
        ru, rw = coach.rotation[u], coach.rotation[w]
        _relative(q, v, coach, e, rel)
        for axis in range(3):
            _, k, c = _axis_force(rel[axis], rel[3 + axis], e, axis, coach)
            stiffness = factor_q * k + factor_v * c
            if stiffness != 0.0:
                # row of G: force direction n = R_u e_axis; rotations are body-axes increments
                nx, ny, nz = ru[0, axis], ru[1, axis], ru[2, axis]
                _row(g, nx, ny, nz, rel, ru, rw)
                _rank_one(jacobian, place_of(u), place_of(w), g, stiffness)
        if coach.turns[e]:
            for axis in range(3):
                stiffness = (
                    factor_q * coach.rotational_stiffness[e, axis] + factor_v * coach.rotational_damping[e, axis]
                )
                if stiffness != 0.0:
                    for j in range(3):
                        g[j] = g[6 + j] = 0.0
                        g[3 + j] = 0.0
                        g[9 + j] = 0.0
                        for m in range(3):
                            g[9 + j] += rw[m, j] * ru[m, axis]
                    g[3 + axis] = -1.0
                    _rank_one(jacobian, place_of(u), place_of(w), g, stiffness)


@compiled
def _row(g: Array, nx: float, ny: float, nz: float, rel: Array, ru: Array, rw: Array) -> None:
    """Deflection along n by unit increments of upper (6) and lower (6) body."""
    g[0], g[1], g[2] = -nx, -ny, -nz
    g[6], g[7], g[8] = nx, ny, nz
    # dp = R (dtheta x rho): n.dp = dtheta . R^T (arm x n)
    ax, ay, az = rel[7] * nz - rel[8] * ny, rel[8] * nx - rel[6] * nz, rel[6] * ny - rel[7] * nx
    bx, by, bz = rel[10] * nz - rel[11] * ny, rel[11] * nx - rel[9] * nz, rel[9] * ny - rel[10] * nx
    for j in range(3):
        g[3 + j] = -(ru[0, j] * ax + ru[1, j] * ay + ru[2, j] * az)
        g[9 + j] = rw[0, j] * bx + rw[1, j] * by + rw[2, j] * bz


@compiled
def _rank_one(jacobian: Array, at_upper: int, at_lower: int, g: Array, stiffness: float) -> None:
    for i in range(12):
        gi = g[i] * stiffness
        if gi == 0.0:
            continue
        row = at_upper + i if i < 6 else at_lower + i - 6
        for j in range(6):
            jacobian[row, at_upper + j] += gi * g[j]
            jacobian[row, at_lower + j] += gi * g[6 + j]


@compiled
def friction_has_changed(q: Array, v: Array, coach: Record) -> bool:
    """Whether any dry friction has begun or ceased to slide since it was asked last; needs `body_frames`.

    Its slope then jumps by so much that a Jacobian with the old one would make it chatter.
    """
    changed = False
    rel = coach.probe_element
    for k in range(coach.rubbing_count):
        e, axis = coach.rubbing[k, 0], coach.rubbing[k, 1]
        _relative(q, v, coach, e, rel)
        _, slope = _on_curve(rel[3 + axis], coach.damper[e, axis], coach)
        if slope != coach.old_rubbing[k]:
            changed = True
        coach.old_rubbing[k] = slope
    return changed
