"""Functions as a user would write them: one sound law, and some that must be refused."""

import math


def circular(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):  # fmt: skip
    """Kalker's linear force, bent over to mu N: F = F_linear/sqrt(1 + (F_linear/(mu N))^2)."""
    mu = mu0 * ((1.0 - falling_a) * math.exp(-falling_b_spm * slip_speed_mps) + falling_a)
    limit = mu * normal_force_n
    if limit <= 0.0:
        return 0.0, 0.0
    area = shear_modulus_pa * a_m * b_m
    x = area * c11 * creep_x
    y = area * (c22 * creep_y + math.sqrt(a_m * b_m) * c23 * spin_1pm)
    bend = math.sqrt(1.0 + (x * x + y * y) / (limit * limit))
    return -x / bend, -y / bend


def drives(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):  # fmt: skip
    fx, fy = -1e3 * math.tanh(creep_x), -1e3 * math.tanh(creep_y)
    return -fx, -fy


def unbounded(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):  # fmt: skip
    area = shear_modulus_pa * a_m * b_m
    return -area * c11 * creep_x, -area * c22 * creep_y


def divides(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):  # fmt: skip
    size = math.sqrt(creep_x * creep_x + creep_y * creep_y)
    return -normal_force_n * falling_a * mu0 * creep_x / size, 0.0


def lopsided(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):  # fmt: skip
    if creep_x > 0.0:
        return -100.0 * math.tanh(creep_x), 0.0
    return -50.0 * math.tanh(creep_x), 0.0


def scalar(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):  # fmt: skip
    return -creep_x


def uncompilable(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):  # fmt: skip
    with open("table.txt") as file:
        return float(file.read()), 0.0


def raises(
    creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
    mu0, falling_a, falling_b_spm, k_adhesion, k_slip,
):  # fmt: skip
    if creep_x > 0.5:
        raise ValueError("out of my table")
    return 0.0, 0.0


def short(creep_x, creep_y):
    return -creep_x, -creep_y
