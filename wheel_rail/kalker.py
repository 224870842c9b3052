"""Kalker's creep coefficients of the linear theory, tabulated over the ellipse ratio and Poisson's number.

Source: J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990, table E.3 (C11, C22, C23).
1/C is interpolated quadratically in Poisson's number, which gives CONTACT's figure (3.7335 for a/b = 0.5, nu = 0.28);
along the ellipse ratio C is linear in log(a/b).
"""

import numpy as np

_RATIO = np.array([*(k / 10 for k in range(1, 11)), *(10 / k for k in range(9, 0, -1))])  # a/b
# rows: a/b as in _RATIO; columns: C11 at the three Poisson numbers, then C22, then C23
_TABLE = np.array(
    [
        [2.51, 3.31, 4.85, 2.51, 2.52, 2.53, 0.334, 0.473, 0.731],
        [2.59, 3.37, 4.81, 2.59, 2.63, 2.66, 0.483, 0.603, 0.809],
        [2.68, 3.44, 4.80, 2.68, 2.75, 2.81, 0.607, 0.715, 0.889],
        [2.78, 3.53, 4.82, 2.78, 2.88, 2.98, 0.720, 0.823, 0.977],
        [2.88, 3.62, 4.83, 2.88, 3.01, 3.14, 0.827, 0.929, 1.07],
        [2.98, 3.72, 4.91, 2.98, 3.14, 3.31, 0.930, 1.03, 1.18],
        [3.09, 3.81, 4.97, 3.09, 3.28, 3.48, 1.03, 1.14, 1.29],
        [3.19, 3.91, 5.05, 3.19, 3.41, 3.65, 1.13, 1.25, 1.40],
        [3.29, 4.01, 5.12, 3.29, 3.54, 3.82, 1.23, 1.36, 1.51],
        [3.40, 4.12, 5.20, 3.40, 3.67, 3.98, 1.33, 1.47, 1.63],
        [3.51, 4.22, 5.30, 3.51, 3.81, 4.16, 1.44, 1.59, 1.77],
        [3.65, 4.36, 5.42, 3.65, 3.99, 4.39, 1.58, 1.75, 1.94],
        [3.82, 4.54, 5.58, 3.82, 4.21, 4.67, 1.76, 1.95, 2.18],
        [4.06, 4.78, 5.80, 4.06, 4.50, 5.04, 2.01, 2.23, 2.50],
        [4.37, 5.10, 6.11, 4.37, 4.90, 5.56, 2.35, 2.62, 2.96],
        [4.84, 5.57, 6.57, 4.84, 5.48, 6.31, 2.88, 3.24, 3.70],
        [5.57, 6.34, 7.34, 5.57, 6.40, 7.51, 3.79, 4.32, 5.01],
        [6.96, 7.78, 8.82, 6.96, 8.14, 9.79, 5.72, 6.63, 7.89],
        [10.7, 11.7, 12.9, 10.7, 12.8, 16.0, 12.2, 14.6, 18.0],
    ]
).reshape(-1, 3, 3)


def creep_coefficients(a_over_b: float, poisson: float) -> tuple[float, float, float]:
    """C11, C22, C23 (dimensionless) for an ellipse with semi-axes a (rolling direction) and b (lateral).

    Raises ValueError outside 0.1 <= a/b <= 10 or 0 <= poisson <= 0.5, the range of the table.
    """
    if not _RATIO[0] <= a_over_b <= _RATIO[-1]:
        raise ValueError(f"a_over_b = {a_over_b}: Kalker's table covers 0.1 to 10")
    if not 0.0 <= poisson <= 0.5:
        raise ValueError(f"poisson = {poisson}: Kalker's table covers 0 to 0.5")
    log_ratio = np.log(_RATIO)
    at_poisson = [[np.interp(np.log(a_over_b), log_ratio, _TABLE[:, j, k]) for k in range(3)] for j in range(3)]
    # Lagrange weights of the three tabulated Poisson numbers 0, 1/4, 1/2
    n = poisson
    weights = np.array([(n - 0.25) * (n - 0.5) / 0.125, -n * (n - 0.5) / 0.0625, n * (n - 0.25) / 0.125])
    c11, c22, c23 = (1.0 / float(weights @ (1.0 / np.array(row))) for row in at_poisson)
    return c11, c22, c23
