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
def body_frames(q: Array, v: Array, coach: Record) -> None:
    """Rotation matrices of the bodies at q and their world angular velocities."""
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
        at = place_of(i)
        x, y, z = v[at + 3], v[at + 4], v[at + 5]
        for j in range(3):
            coach.rate[i, j] = r[j, 0] * x + r[j, 1] * y + r[j, 2] * z


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
    wu, wl = coach.rate[u], coach.rate[w]
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
    rel = coach.probe_element
    moment = coach.moment  # world moments by body, turned into body axes at the end
    for i in range(coach.bodies):
        moment[i, 0] = moment[i, 1] = moment[i, 2] = 0.0
    for e in range(coach.elements):
        u, w = coach.upper[e], coach.lower[e]
        ru = coach.rotation[u]
        if coach.pushes[e]:
            _relative(q, v, coach, e, rel)
            fx, _, _ = _axis_force(rel[0], rel[3], e, 0, coach)
            fy, _, _ = _axis_force(rel[1], rel[4], e, 1, coach)
            fz, _, _ = _axis_force(rel[2], rel[5], e, 2, coach)
            fz += coach.preload[e]
            gx = ru[0, 0] * fx + ru[0, 1] * fy + ru[0, 2] * fz
            gy = ru[1, 0] * fx + ru[1, 1] * fy + ru[1, 2] * fz
            gz = ru[2, 0] * fx + ru[2, 1] * fy + ru[2, 2] * fz
            at_u, at_w = place_of(u), place_of(w)
            f[at_u] += gx
            f[at_u + 1] += gy
            f[at_u + 2] += gz
            f[at_w] -= gx
            f[at_w + 1] -= gy
            f[at_w + 2] -= gz
            moment[u, 0] += rel[7] * gz - rel[8] * gy
            moment[u, 1] += rel[8] * gx - rel[6] * gz
            moment[u, 2] += rel[6] * gy - rel[7] * gx
            moment[w, 0] -= rel[10] * gz - rel[11] * gy
            moment[w, 1] -= rel[11] * gx - rel[9] * gz
            moment[w, 2] -= rel[9] * gy - rel[10] * gx
        if coach.turns[e]:
            rw = coach.rotation[w]
            wu, wl = coach.rate[u], coach.rate[w]
            sx, sy, sz = wl[0] - wu[0], wl[1] - wu[1], wl[2] - wu[2]
            tx = ty = tz = 0.0
            # small relative rotation of the lower body in the upper body's axes, and its rate
            for axis in range(3):
                k, c = coach.rotational_stiffness[e, axis], coach.rotational_damping[e, axis]
                if k == 0.0 and c == 0.0:
                    continue
                i, j = (axis + 1) % 3, (axis + 2) % 3
                x, y, z = ru[0, axis], ru[1, axis], ru[2, axis]
                angle = 0.5 * (
                    (ru[0, j] * rw[0, i] - ru[0, i] * rw[0, j])
                    + (ru[1, j] * rw[1, i] - ru[1, i] * rw[1, j])
                    + (ru[2, j] * rw[2, i] - ru[2, i] * rw[2, j])
                )
                size = k * angle + c * (x * sx + y * sy + z * sz)
                tx += x * size
                ty += y * size
                tz += z * size
            moment[u, 0] += tx
            moment[u, 1] += ty
            moment[u, 2] += tz
            moment[w, 0] -= tx
            moment[w, 1] -= ty
            moment[w, 2] -= tz
    for i in range(coach.bodies):
        r = coach.rotation[i]
        at = place_of(i) + 3
        for j in range(3):
            f[at + j] += r[0, j] * moment[i, 0] + r[1, j] * moment[i, 1] + r[2, j] * moment[i, 2]


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
