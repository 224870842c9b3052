"""Stops come nearer to the reference as steps get shorter; a short version of the rows of the verification."""

import numpy as np

from scenarios.verification.convergence import REFERENCE_S, STEPS_S, plain_stop, protected_stop

FROM_KMH = 12.0


def test_plain_stop_converges() -> None:
    reference = plain_stop(REFERENCE_S, FROM_KMH)
    off_m = [plain_stop(step_s, FROM_KMH).distance_m - reference.distance_m for step_s in STEPS_S]
    print("off by", [f"{1e3 * off:.2f} mm" for off in off_m], f"of {reference.distance_m:.2f} m")
    assert 5.0 < reference.distance_m < 15.0
    assert abs(off_m[0]) < 0.02
    assert abs(off_m[0]) > abs(off_m[1]) > abs(off_m[2])


def test_protected_stop_is_that_of_the_reference() -> None:
    """Wheels slide and are caught again; the stop differs by less than half a percent of its length."""
    stops = [protected_stop(step_s, FROM_KMH) for step_s in (STEPS_S[0], STEPS_S[-1])]
    reference = protected_stop(REFERENCE_S, FROM_KMH)
    for stop in stops:
        both = min(len(stop.speed_mps), len(reference.speed_mps))
        assert abs(stop.distance_m / reference.distance_m - 1.0) < 0.01
        assert np.abs(stop.speed_mps[:both] - reference.speed_mps[:both]).max() < 0.1
