"""Kalker's simplified theory of rolling contact: FASTSIM, and its modification for falling friction.

The surface is a bed of springs: a particle that enters at the leading edge is sheared by the creepage until its stress
p meets the bound mu p_n, p_n = 2 N/(pi a b) (1 - x^2/a^2 - y^2/b^2); then it slides:
dpx/dx = -(xi/L1 - phi y/L3), dpy/dx = -(eta/L2 + phi x/L3), L1 = 8a/(3 G C11), L2 = 8a/(3 G C22),
L3 = pi a sqrt(a/b)/(4 G C23). Source: J. J. Kalker, Vehicle System Dynamics 11 (1982) 1-13.

`modified_fastsim_force` divides the flexibilities by k(eps), which falls with creepage (Spiryagin, Polach and Cole,
Vehicle System Dynamics 51 (2013) 1719-1730). Friction follows the slip speed of the whole wheel in both.
"""

import math

from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.slip import counted_lateral_creep, friction, slip_direction, tangent_with_fall, total_creep


@compiled
def fastsim_force(
    nx: int, ny: int, creep_x: float, creep_y: float, spin_1pm: float, slip_speed_mps: float, normal_force_n: float,
    patch: Vector, rail: Array, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Creep force on the wheel (Fx, Fy) in N; tangent dF/ds along the slip and secant |F|/s in N per unit creep.

    `nx` >= 2 cells along each of `ny` >= 3 strips; `patch`, `rail` and the results as in `polach_force`; kA and kS,
    which belong to Polach's law, are not used. The tangent is taken at fixed spin; s as in `total_creep`. The force
    stays within mu N.
    """
    mu = friction(rail, slip_speed_mps)
    fx, fy, tangent, secant = _elastic_bed(
        nx, ny, 1.0, 0.0, creep_x, creep_y, spin_1pm, mu * normal_force_n, patch, shear_modulus_pa
    )
    return fx, fy, _falling(fx, fy, tangent, creep_x, creep_y, slip_speed_mps, mu, rail), secant


@compiled
def modified_fastsim_force(
    nx: int, ny: int, k0: float, alpha_inf: float, beta: float, creep_x: float, creep_y: float, spin_1pm: float,
    slip_speed_mps: float, normal_force_n: float, patch: Vector, rail: Array, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """FASTSIM with its stiffness times k = k0 ((1 - alpha_inf)/(1 + beta eps) + alpha_inf); else as `fastsim_force`.

    eps = (1/4) G pi a b k0 C11 s/(mu N) is Polach's gradient of the tangential stress, s the total creepage. The
    tangent contains the change of k.
    """
    mu = friction(rail, slip_speed_mps)
    limit = mu * normal_force_n
    k, k_rate = k0, 0.0
    total = total_creep(creep_x, creep_y, spin_1pm, patch[0])
    if total > 0.0 and limit > 0.0:
        eps_rate = 0.25 * math.pi * shear_modulus_pa * patch[0] * patch[1] * k0 * patch[2] / limit
        fall = 1.0 / (1.0 + beta * eps_rate * total)
        k = k0 * ((1.0 - alpha_inf) * fall + alpha_inf)
        # the total creepage grows along the slip by the cosine between the two
        along_x, along_y = slip_direction(creep_x, creep_y)
        counted_y = counted_lateral_creep(creep_y, spin_1pm, patch[0])
        k_rate = -k0 * (1.0 - alpha_inf) * beta * eps_rate * fall * fall
        k_rate *= (creep_x * along_x + counted_y * along_y) / total
    fx, fy, tangent, secant = _elastic_bed(
        nx, ny, k, k_rate, creep_x, creep_y, spin_1pm, limit, patch, shear_modulus_pa
    )
    return fx, fy, _falling(fx, fy, tangent, creep_x, creep_y, slip_speed_mps, mu, rail), secant


@compiled
def _falling(
    fx: float, fy: float, tangent: float, creep_x: float, creep_y: float, slip_speed_mps: float, mu: float, rail: Array
) -> float:
    along_x, along_y = slip_direction(creep_x, creep_y)
    creep = math.sqrt(creep_x * creep_x + creep_y * creep_y)
    return tangent_with_fall(tangent, -(fx * along_x + fy * along_y), creep, slip_speed_mps, mu, rail)


@compiled
def _elastic_bed(
    nx: int, ny: int, k: float, k_rate: float, creep_x: float, creep_y: float, spin_1pm: float, limit_n: float,
    patch: Vector, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Sum of the stresses over the ellipse for stiffness k times Kalker's; `k_rate`: dk/ds along the slip.

    Strips at y = b sin(theta), theta at the middle of `ny` equal parts of (-pi/2, pi/2). Within a cell of a strip the
    stress is taken as linear up to the point where it meets the bound, and as the bound beyond, both integrated
    exactly: without spin no error is left along the strip, with spin it is of order 1/nx. The stiffnesses carry the
    known errors of the sums of full adhesion, so that full sliding gives mu N and full adhesion Kalker's linear forces
    on any grid. Stresses are in units of the bound at the middle of their strip, u = x/(half length of the strip).
    """
    a, b = patch[0], patch[1]
    total = total_creep(creep_x, creep_y, spin_1pm, a)
    if total < 1e-14 or limit_n <= 0.0:
        slope = k * shear_modulus_pa * a * b * patch[2]
        return 0.0, 0.0, slope, slope
    along_x, along_y = slip_direction(creep_x, creep_y)
    du, turn = 2.0 / nx, math.pi / ny
    # integral of cos^3 theta over its sum, and that of 1 - u^2 over the trapezoidal one
    strips = 4.0 / 3.0 / (0.25 * turn * (3.0 / math.sin(0.5 * turn) - 1.0 / math.sin(1.5 * turn)))
    parabola = 1.0 / (1.0 - 1.0 / (nx * nx))
    # growth of the stress over one cell of a strip of half length a, in units of the bound at the patch's centre
    peak = 2.0 * limit_n / (math.pi * a * b)
    cell = a * du / peak
    per_x = cell * 0.375 * shear_modulus_pa * patch[2] / a * strips
    per_y = cell * 0.375 * shear_modulus_pa * patch[3] / a * strips
    per_spin = cell * 4.0 * shear_modulus_pa * patch[4] / (math.pi * a * math.sqrt(a / b)) * parabola
    grow_x, grow_y, grow_s = k * per_x * creep_x, k * per_y * creep_y, k * per_spin * spin_1pm
    rate_x = k * per_x * along_x + k_rate * per_x * creep_x
    rate_y = k * per_y * along_y + k_rate * per_y * creep_y
    rate_s = k_rate * per_spin * spin_1pm
    turn_cos, turn_sin = math.cos(turn), math.sin(turn)
    cosine, sine = math.sin(0.5 * turn), -math.cos(0.5 * turn)
    sum_x = sum_y = sum_rate_x = sum_rate_y = 0.0
    for _ in range(ny):
        # half the length halves the growth, the bound falls with its square
        inverse = 1.0 / cosine
        step_x = (grow_x - grow_s * b * sine) * inverse
        step_y = grow_y * inverse
        step_rate_x = (rate_x - rate_s * b * sine) * inverse
        step_rate_y = rate_y * inverse
        step_s = grow_s * a
        step_rate_s = rate_s * a
        px = py = qx = qy = 0.0  # stress, and its derivative along the slip
        strip_x = strip_y = strip_rate_x = strip_rate_y = 0.0
        u, bound, before = 1.0, 0.0, 0.0
        for i in range(nx):
            middle = u - 0.5 * du
            next_x, next_y = px + step_x, py + step_y + step_s * middle
            next_qx, next_qy = qx + step_rate_x, qy + step_rate_y + step_rate_s * middle
            next_u = 1.0 - (i + 1) * du
            next_bound = max(1.0 - next_u * next_u, 0.0)
            size2 = next_x * next_x + next_y * next_y
            if size2 <= next_bound * next_bound:
                strip_x += 0.5 * (px + next_x)
                strip_y += 0.5 * (py + next_y)
                strip_rate_x += 0.5 * (qx + next_qx)
                strip_rate_y += 0.5 * (qy + next_qy)
                px, py, qx, qy = next_x, next_y, next_qx, next_qy
                before = -1.0  # a root that is rarely needed
            else:
                # share of the cell in adhesion: stress = bound - missing + excess s + (s du)^2 meets the bound
                size = math.sqrt(size2)
                if before < 0.0:
                    before = math.sqrt(px * px + py * py)
                missing = max(bound - before, 0.0)
                excess = size - before - 2.0 * u * du
                stick, root = 0.0, 1.0
                if missing > 0.0 or excess < 0.0:
                    root = math.sqrt(excess * excess + 4.0 * du * du * missing)
                    stick = 2.0 * missing / (excess + root) if excess > 0.0 else (root - excess) / (2.0 * du * du)
                    stick = min(stick, 1.0)
                slide = bound * (1.0 - stick) + u * du * (1.0 - stick * stick)
                slide -= du * du * (1.0 - stick * stick * stick) / 3.0
                stick_end = 0.5 * stick * stick
                stick_start = stick - stick_end
                inverse_size = 1.0 / size
                outward_x, outward_y = next_x * inverse_size, next_y * inverse_size
                growth = outward_x * next_qx + outward_y * next_qy
                turn_x = (next_qx - growth * outward_x) * inverse_size
                turn_y = (next_qy - growth * outward_y) * inverse_size
                strip_x += stick_start * px + stick_end * next_x + slide * outward_x
                strip_y += stick_start * py + stick_end * next_y + slide * outward_y
                strip_rate_x += stick_start * qx + stick_end * next_qx + slide * turn_x
                strip_rate_y += stick_start * qy + stick_end * next_qy + slide * turn_y
                if 0.0 < stick < 1.0:  # the point where sliding starts moves
                    before_rate = (px * qx + py * qy) / before if before > 0.0 else 0.0
                    moves = -before_rate if missing > 0.0 else 0.0
                    moves = (moves - stick * (growth - before_rate)) / root
                    meets = bound + stick * du * (2.0 * u - stick * du)
                    strip_rate_x += moves * (px + stick * (next_x - px) - meets * outward_x)
                    strip_rate_y += moves * (py + stick * (next_y - py) - meets * outward_y)
                px, py = next_bound * outward_x, next_bound * outward_y
                qx, qy = next_bound * turn_x, next_bound * turn_y
                before = next_bound
            u, bound = next_u, next_bound
        weight = cosine * cosine
        weight *= weight
        sum_x += weight * strip_x
        sum_y += weight * strip_y
        sum_rate_x += weight * strip_rate_x
        sum_rate_y += weight * strip_rate_y
        cosine, sine = cosine * turn_cos - sine * turn_sin, sine * turn_cos + cosine * turn_sin
    scale = peak * a * b * turn * du
    fx, fy = -scale * sum_x, -scale * sum_y
    tangent = scale * (sum_rate_x * along_x + sum_rate_y * along_y)
    return fx, fy, tangent, math.sqrt(fx * fx + fy * fy) / total


@compiled
def fastsim_on_rectangle(
    nx: int, ny: int, k: float, creep_x: float, creep_y: float, spin_1pm: float, limit_n: float, patch: Vector,
    shear_modulus_pa: float,
) -> tuple[float, float]:  # fmt: skip
    """Creep force on the wheel (Fx, Fy) in N by the scheme of CONTACT's FASTSIM, for comparison with its figures.

    Equal cells over a rectangle 1.1 times the ellipse; a cell counts when its centre lies inside. Its stress is the one
    at the END of the cell (implicit Euler), limited by the parabolic bound at its centre: first order, too stiff by
    2..3 % with 48 x 44 cells. `limit_n`: mu N; `k`: factor of the stiffness. Source: E. A. H. Vollebregt, User guide
    for CONTACT, Vtech CMCC.
    """
    a, b = patch[0], patch[1]
    stiffness_x = 0.375 * shear_modulus_pa * patch[2] / a * k
    stiffness_y = 0.375 * shear_modulus_pa * patch[3] / a * k
    stiffness_spin = 4.0 * shear_modulus_pa * patch[4] / (math.pi * a * math.sqrt(a / b)) * k
    peak = 2.0 * limit_n / (math.pi * a * b)
    dx, dy = 2.2 * a / nx, 2.2 * b / ny
    fx = fy = 0.0
    for j in range(ny):
        y = (j + 0.5) * dy - 1.1 * b
        px = py = 0.0
        for i in range(nx):
            x = 1.1 * a - (i + 0.5) * dx
            bound = peak * (1.0 - (x / a) ** 2 - (y / b) ** 2)
            if bound <= 0.0:
                px = py = 0.0
                continue
            px += dx * (stiffness_x * creep_x - stiffness_spin * spin_1pm * y)
            py += dx * (stiffness_y * creep_y + stiffness_spin * spin_1pm * x)
            size = math.sqrt(px * px + py * py)
            if size > bound:
                px *= bound / size
                py *= bound / size
            fx -= px * dx * dy
            fy -= py * dx * dy
    return fx, fy
