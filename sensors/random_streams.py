"""Random streams by number of sensor and term, so that results do not depend on what else draws, or in which order."""

import numpy as np

IMU_SENSOR = 1
BALISE_SENSOR = 2

# Terms of the IMU.
CONSTANT_TERM, WHITE_TERM, DRIFT_TERM, CALIBRATION_TERM = range(4)


def random_stream(seed: int, sensor: int, term: int) -> np.random.Generator:
    """The random stream of one term of one sensor: `SeedSequence(seed, spawn_key=(sensor, term))`."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(sensor, term)))
