"""Kalker's linear creep law, saturated at the friction bound.

Linear forces on the wheel: Fx = -G a b C11 xi, Fy = -G a b (C22 eta + sqrt(ab) C23 phi); F their resultant,
q = F/(mu N). Saturation keeps the direction and shrinks the resultant:
`CUBIC` (Shen, Hedrick and Elkins, 8th IAVSD Symposium, 1983, after Vermeulen and Johnson's cubic of 1964 for pure
creepage): mu N (q - q^2/3 + q^3/27) up to q = 3, mu N beyond; smooth, the field's usual one;
`CUT`: min(F, mu N), the bilinear law of textbooks, too high around q = 1.
"""

import math

from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.slip import friction, slip_direction, tangent_with_fall, total_creep

CUBIC, CUT = 0, 1


@compiled
def kalker_linear_force(
    saturation: int, creep_x: float, creep_y: float, spin_1pm: float, slip_speed_mps: float, normal_force_n: float,
    patch: Vector, rail: Array, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Creep force on the wheel (Fx, Fy) in N; tangent dF/ds along the slip and secant |F|/s in N per unit creep.

    `saturation`: CUBIC or CUT; `patch`, `rail` and the results as in `polach_force`; kA and kS, which belong to
    Polach's law, are not used. The tangent is taken at fixed spin, s as in `total_creep`.
    """
    a, b = patch[0], patch[1]
    area = shear_modulus_pa * a * b
    mu = friction(rail, slip_speed_mps)
    limit = mu * normal_force_n
    linear_x = area * patch[2] * creep_x
    linear_y = area * (patch[3] * creep_y + math.sqrt(a * b) * patch[4] * spin_1pm)
    linear = math.sqrt(linear_x * linear_x + linear_y * linear_y)
    total = total_creep(creep_x, creep_y, spin_1pm, a)
    if total < 1e-14 or limit <= 0.0:
        return 0.0, 0.0, area * patch[2], area * patch[2]
    q = linear / limit
    # share of the linear force that is transmitted, and its slope over q
    if saturation == CUT:
        share, slope = (1.0, 0.0) if q <= 1.0 else (1.0 / q, -1.0 / (q * q))
    elif q < 3.0:
        share, slope = 1.0 - q / 3.0 + q * q / 27.0, -1.0 / 3.0 + 2.0 * q / 27.0
    else:
        share, slope = 1.0 / q, -1.0 / (q * q)
    along_x, along_y = slip_direction(creep_x, creep_y)
    rate_x, rate_y = area * patch[2] * along_x, area * patch[3] * along_y
    q_rate = (linear_x * rate_x + linear_y * rate_y) / (linear * limit) if linear > 0.0 else 0.0
    tangent = share * (rate_x * along_x + rate_y * along_y) + slope * q_rate * (linear_x * along_x + linear_y * along_y)
    creep = math.sqrt(creep_x * creep_x + creep_y * creep_y)
    force = share * (linear_x * along_x + linear_y * along_y)
    tangent = tangent_with_fall(tangent, force, creep, slip_speed_mps, mu, rail)
    return -share * linear_x, -share * linear_y, tangent, share * linear / total
