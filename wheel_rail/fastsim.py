"""Kalker's simplified theory of rolling contact: FASTSIM, and its modification for falling friction.

The surface is a bed of springs: a particle that enters at the leading edge is sheared by the creepage until its stress
p meets the bound mu p_n, p_n = 2 N/(pi a b) (1 - x^2/a^2 - y^2/b^2); then it slides:
dpx/dx = -(xi/L1 - phi y/L3), dpy/dx = -(eta/L2 + phi x/L3), L1 = 8a/(3 G C11), L2 = 8a/(3 G C22),
L3 = pi a sqrt(a/b)/(4 G C23). Source: J. J. Kalker, Vehicle System Dynamics 11 (1982) 1-13.

`modified_fastsim_force` divides the flexibilities by k(eps), which falls with creepage (Spiryagin, Polach and Cole,
Vehicle System Dynamics 51 (2013) 1719-1730). Friction follows the slip speed of the whole wheel in both.
"""

import math

from wheel_rail.compiled import Array, Vector, compiled, inlined
from wheel_rail.fastsim_strip import strip_force
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

    Strips at y = b sin(theta), theta at the middle of `ny` equal parts of (-pi/2, pi/2) without spin; spin crowds them
    where the slip turns about its pole (`_crowding`). In units of the bound at the middle of a strip and of its half
    length all strips have one bound, and differ in growth alone. The sums carry the known errors of the strips, so that
    full sliding gives mu N and full adhesion Kalker's linear forces on any grid. The tangent is that of these sums: the
    strips move with the pole.
    """
    a, b = patch[0], patch[1]
    total = total_creep(creep_x, creep_y, spin_1pm, a)
    if total < 1e-14 or limit_n <= 0.0:
        slope = k * shear_modulus_pa * a * b * patch[2]
        return 0.0, 0.0, slope, slope
    along_x, along_y = slip_direction(creep_x, creep_y)
    turn = math.pi / ny
    # integral of cos^3 theta over its sum, where the strips do not crowd; sin 3 x = sin x (3 - 4 sin^2 x)
    half_sine = math.sin(0.5 * turn)
    strips = 16.0 / 3.0 * half_sine / (turn * (3.0 - 1.0 / (3.0 - 4.0 * half_sine * half_sine)))
    # growth of the stress over one cell of a strip of half length a, in units of the bound at the patch's centre
    peak = 2.0 * limit_n / (math.pi * a * b)
    cell = 2.0 / nx * a / peak
    per_x = cell * 0.375 * shear_modulus_pa * patch[2] / a * strips
    per_y = cell * 0.375 * shear_modulus_pa * patch[3] / a * strips
    per_spin = cell * 4.0 * shear_modulus_pa * patch[4] / (math.pi * a * math.sqrt(a / b)) * spin_1pm
    grow_x, grow_y, grow_s = k * per_x * creep_x, k * per_y * creep_y, k * per_spin
    rate_x = k * per_x * along_x + k_rate * per_x * creep_x
    rate_y = k * per_y * along_y + k_rate * per_y * creep_y
    rate_s = k_rate * per_spin
    middle, reach, mean, stride = 0.0, math.inf, 0.0, turn
    middle_rate = reach_rate = mean_rate = stride_rate = 0.0
    if grow_s != 0.0:
        # the length of the strips and their elasticity spread the turn over y; half of each was found to serve best
        pole = grow_x / (grow_s * b)
        middle, reach, mean, stride, middle_rate, reach_rate, mean_rate, stride_rate = _crowding(
            ny, pole, 0.5 * a / b + 1.0 / (nx * abs(grow_s) * b), (rate_x - pole * b * rate_s) / (grow_s * b)
        )
    crowds = reach < 1e5  # beyond, nothing is left of it but rounding
    if not crowds:
        mean, stride = 0.0, turn
    sum_x = sum_y = sum_rate = sum_bound = sum_bound_rate = 0.0
    # sinh and cosh of the mean, of one stride and of a strip's place, by their addition theorems
    place = 0.5 * (ny % 2) - 0.5
    sinh_mean = sinh_stride = sinh_place = 0.0
    cosh_mean = cosh_stride = cosh_place = 1.0
    if crowds:
        sinh_mean, half = math.sinh(mean), math.sinh(0.5 * stride)
        cosh_mean, cosh_half = math.sqrt(1.0 + sinh_mean * sinh_mean), math.sqrt(1.0 + half * half)
        sinh_stride, cosh_stride = 2.0 * half * cosh_half, 1.0 + 2.0 * half * half
        if ny % 2 == 0:
            sinh_place, cosh_place = -half, cosh_half
    for j in range(ny):
        # in pairs from the middle, so that a patch that is symmetric has no trace of rounding to one side
        if j > 0:
            place, sinh_place = -place, -sinh_place
            if (j + ny) % 2 == 0:
                place -= 1.0
                sinh_place, cosh_place = (
                    sinh_place * cosh_stride - cosh_place * sinh_stride,
                    cosh_place * cosh_stride - sinh_place * sinh_stride,
                )
        share = stride
        theta, theta_rate, share_rate = place * stride, 0.0, 0.0
        if crowds:
            rise = sinh_mean * cosh_place + cosh_mean * sinh_place
            run = cosh_mean * cosh_place + sinh_mean * sinh_place
            theta = middle + reach * rise
            v_rate = mean_rate + place * stride_rate
            theta_rate = middle_rate + reach_rate * rise + reach * run * v_rate
            share_rate = run * (reach_rate * stride + reach * stride_rate) + reach * stride * rise * v_rate
            share *= reach * run
        cosine, sine = math.cos(theta), math.sin(theta)
        lever = b * sine
        # half the length halves the growth, the bound falls with its square
        inverse = 1.0 / cosine
        strip_grow_x, strip_grow_y = (grow_x - grow_s * lever) * inverse, grow_y * inverse
        shorter = sine * inverse * theta_rate
        strip_x, strip_y, strip_rate = strip_force(
            nx, strip_grow_x, strip_grow_y, grow_s * a,
            (rate_x - rate_s * lever) * inverse - grow_s * b * theta_rate + strip_grow_x * shorter,
            rate_y * inverse + strip_grow_y * shorter, rate_s * a, along_x, along_y,
        )  # fmt: skip
        weight = cosine * cosine
        weight_rate = weight * weight * (share_rate - 4.0 * shorter * share)
        weight *= weight * share
        sum_bound += weight
        sum_x += weight * strip_x
        sum_y += weight * strip_y
        sum_bound_rate += weight_rate
        sum_rate += weight * strip_rate + weight_rate * (strip_x * along_x + strip_y * along_y)
    scale = 1.5 * limit_n / nx / sum_bound
    size = scale * math.sqrt(sum_x * sum_x + sum_y * sum_y)
    if size > limit_n:  # by no more than where sliding begins is found short of
        scale *= limit_n / size
    tangent = scale * (sum_rate - sum_bound_rate / sum_bound * (sum_x * along_x + sum_y * along_y))
    return -scale * sum_x, -scale * sum_y, tangent, min(size, limit_n) / total


@inlined
def _crowding(
    ny: int, pole: float, spread: float, pole_rate: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Strips at theta = middle + reach sinh(v), v amid `ny` equal parts: middle, reach, mean and stride of v; and how
    these four change with the `pole`, by `pole_rate`.

    Where y passes the `pole` of the slip (y/b) the stress turns over, within a width `spread` b. A force that is
    analytic up to pole + i spread in y/b is so up to the arcsine of that in theta, middle + i arcosh(larger), and in v
    up to i pi/2 however close that is; sinh in place of the arcosh lets the crowding vanish far away. The arcsine's
    derivative is 1/cosine, of size 1/sqrt(right left).
    """
    right = math.sqrt((pole + 1.0) * (pole + 1.0) + spread * spread)
    left = math.sqrt((pole - 1.0) * (pole - 1.0) + spread * spread)
    larger = 0.5 * (right + left)
    middle = math.asin(2.0 * pole / (right + left))
    reach = math.sqrt(larger * larger - 1.0)
    relative = pole_rate / (right * left)
    reach_rate = relative * pole * reach
    per_reach = 1.0 / reach
    middle_rate = relative * larger * spread * per_reach
    start, end = (0.5 * math.pi + middle) * per_reach, (0.5 * math.pi - middle) * per_reach
    start_root, end_root = math.sqrt(start * start + 1.0), math.sqrt(end * end + 1.0)
    # arsinh(w) is log(w + sqrt(w^2 + 1)), and odd; first v is -before, last v is after
    before, after = math.log(start + start_root), math.log(end + end_root)
    before_rate = (middle_rate * per_reach - start * relative * pole) / start_root
    after_rate = -(middle_rate * per_reach + end * relative * pole) / end_root
    return (
        middle, reach, 0.5 * (after - before), (before + after) / ny,
        middle_rate, reach_rate, 0.5 * (after_rate - before_rate), (before_rate + after_rate) / ny,
    )  # fmt: skip


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
