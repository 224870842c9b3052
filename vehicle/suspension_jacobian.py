"""The Jacobian of the suspension, element by element, and whether dry friction has begun to slide; compiled."""

from vehicle.rotations import place_of
from wheel_rail.compiled import Array, Record, compiled, inlined


@compiled
def _slope_of(curve: int, x: float, coach: Record) -> float:
    """Slope of a characteristic at x."""
    side = 0 if x >= 0.0 else 1
    n = coach.curve_points[curve, side]
    size = abs(x)
    k = 1
    while k < n - 1 and size > coach.curve_x[curve, side, k]:
        k += 1
    slope: float = coach.curve_slope[curve, side, k]
    return slope


@inlined
def _axis_slopes(deflection: float, speed: float, element: int, axis: int, coach: Record) -> tuple[float, float]:
    """Slopes over deflection and speed of the force along one axis of an element."""
    k = coach.stiffness[element, axis]
    c = coach.damping[element, axis]
    if coach.damper[element, axis] >= 0:
        c += _slope_of(coach.damper[element, axis], speed, coach)
    if coach.stop[element, axis] >= 0:
        k += _slope_of(coach.stop[element, axis], deflection, coach)
    return k, c


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
    ru, rw = coach.rotation[:, :, u], coach.rotation[:, :, w]
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
        ru, rw = coach.rotation[:, :, u], coach.rotation[:, :, w]
        _relative(q, v, coach, e, rel)
        for axis in range(3):
            k, c = _axis_slopes(rel[axis], rel[3 + axis], e, axis, coach)
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
        slope = _slope_of(coach.damper[e, axis], rel[3 + axis], coach)
        if slope != coach.old_rubbing[k]:
            changed = True
        coach.old_rubbing[k] = slope
    return changed
