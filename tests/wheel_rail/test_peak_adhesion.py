"""The peak adhesion on offer is the highest point of the curve, for one wheel as for eight at once."""

import numpy as np
import pytest

from tests.wheel_rail.rail_kinds import CONTACT, LOAD_N, PATCH, SHEAR_PA, condition_at, fresh, parameters
from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.creep_laws import CREEP_LAWS, KalkerLinearParameters, LawInForce
from wheel_rail.lanes import LANES
from wheel_rail.peak_adhesion import LARGEST_CREEP, offered_adhesion, offered_to_wheels
from wheel_rail.recovery import CONDITION, DEGRADED, ENERGY, RECOVERED, TAU, adhesive_force

POLACH = CREEP_LAWS["polach"].in_force()
PLACES = 4000
STEEP_CREEP = 0.03


@compiled
def _curve(
    law: int, extra: Array, speed_mps: float, load_n: float, patch: Vector, condition: Array, shear_pa: float,
    creep: Array, adhesion: Array,
) -> None:  # fmt: skip
    for k in range(creep.shape[0]):
        fx, _, _, _ = adhesive_force(
            law, 0, extra, creep[k], 0.0, 0.0, creep[k] * speed_mps, speed_mps, load_n, patch, condition, shear_pa
        )
        adhesion[k] = -fx / load_n


def scanned(
    law: LawInForce, speed_mps: float, load_n: float, condition: np.ndarray, patch: Vector = tuple(PATCH)
) -> tuple[float, float]:
    """Highest place of a fine scan, and of a finer one about it."""
    creep = np.geomspace(1e-4, LARGEST_CREEP, PLACES + 1)
    adhesion = np.empty(PLACES + 1)
    for _ in range(2):
        _curve(law.number, law.extra, speed_mps, load_n, patch, condition, SHEAR_PA, creep, adhesion)
        at = int(np.argmax(adhesion))
        best = float(adhesion[at]), float(creep[at])
        creep = np.geomspace(creep[max(at - 1, 0)], creep[min(at + 1, PLACES)], PLACES + 1)
    return best


def offered(law: LawInForce, speed_mps: float, load_n: float, condition: np.ndarray) -> tuple[float, float]:
    return offered_adhesion(
        law.number, law.address, law.extra, speed_mps, load_n, tuple(PATCH), condition, SHEAR_PA, True
    )


def random_wheel(rng: np.random.Generator) -> tuple[float, float, np.ndarray]:
    """Speed, load and rail of a wheel: kinds of rail as they are used, dry and treated by wheels."""
    condition = np.zeros(CONDITION)
    condition[DEGRADED:RECOVERED] = rng.uniform(0.03, 0.4), 0.4, rng.uniform(0.1, 0.6), rng.choice([0.3, 1.0]), 0.1
    condition[RECOVERED:TAU] = condition[0] * rng.uniform(1.0, 5.0), 0.5, rng.uniform(0.1, 0.6), 1.0, 0.4
    condition[TAU] = rng.choice([0.0, 1.9e-4, 5e-4, 2e-3])
    condition[ENERGY] = rng.choice([0.0, 300.0, 3e3])
    return float(rng.uniform(0.0, 60.0)), float(rng.uniform(5e3, 1.5e5)), condition


@pytest.mark.parametrize("law", ["polach", "kalker-linear", "fastsim"])
def test_the_peak_is_the_highest_place_of_a_fine_scan(law: str) -> None:
    rng = np.random.default_rng(11)
    chosen = CREEP_LAWS[law].in_force()
    worst = shift = 0.0
    for _ in range(8 if law == "fastsim" else 200):
        wheel = random_wheel(rng)
        (peak, creep), (found, place) = scanned(chosen, *wheel), offered(chosen, *wheel)
        worst = max(worst, peak / found - 1.0)
        assert found <= peak * (1.0 + 1e-9)
        if law == "polach":  # the others have plateaus
            shift = max(shift, abs(place / creep - 1.0))
    print(f"{law}: peak {worst:.1e}, creep {shift:.1e}")
    assert worst < 3e-9
    assert shift < 2e-5


def test_a_kink_is_found_as_well() -> None:
    """Kalker's linear law cut off at mu N, which falls: the slope jumps at the peak."""
    rng = np.random.default_rng(12)
    law = CREEP_LAWS["kalker-linear"].in_force(KalkerLinearParameters(saturation="cut"))
    worst = 0.0
    for _ in range(100):
        wheel = random_wheel(rng)
        worst = max(worst, scanned(law, *wheel)[0] / offered(law, *wheel)[0] - 1.0)
    print(f"{worst:.1e}")
    assert worst < 2e-6


def test_either_of_two_maxima_is_found() -> None:
    """A steep one, of the degraded curve, and one made by cleaning: the speed decides which is higher."""
    condition = condition_at(fresh(parameters({"recovery": "low-recovering", "peak_adhesion": 0.07}), 10.0), 5.0)
    places = []
    for speed_mps in np.linspace(1.0, 60.0, 60):
        peak, creep = scanned(POLACH, speed_mps, LOAD_N, condition)
        found, place = offered(POLACH, speed_mps, LOAD_N, condition)
        assert found == pytest.approx(peak, rel=1e-9)
        assert place == pytest.approx(creep, rel=2e-5)
        places.append(place)
    assert min(places) < STEEP_CREEP
    assert max(places) > 5.0 * STEEP_CREEP


def to_wheels(
    law: LawInForce, wheels: list[tuple[float, float, np.ndarray]], own_cleaning: bool
) -> tuple[np.ndarray, np.ndarray]:
    speed, load = (np.array([wheel[k] for wheel in wheels]) for k in range(2))
    peak, creep = np.full((2, LANES), np.nan)
    offered_to_wheels(
        law.number, law.address, law.extra, speed, load, tuple(PATCH), CONTACT.load_n,
        np.stack([wheel[2] for wheel in wheels], axis=1), SHEAR_PA, own_cleaning, peak, creep,
    )  # fmt: skip
    return peak, creep


@pytest.mark.parametrize("law", ["polach", "kalker-linear"])
@pytest.mark.parametrize("own_cleaning", [True, False])
def test_eight_wheels_are_offered_what_each_is_alone(law: str, own_cleaning: bool) -> None:
    rng = np.random.default_rng(13)
    chosen = CREEP_LAWS[law].in_force()
    for _ in range(20):
        wheels = [random_wheel(rng) for _ in range(LANES)]
        peak, creep = to_wheels(chosen, wheels, own_cleaning)
        for w, (speed_mps, load_n, condition) in enumerate(wheels):
            growth = np.cbrt(load_n / CONTACT.load_n)
            patch = (PATCH[0] * growth, PATCH[1] * growth, *PATCH[2:])
            alone, place = offered_adhesion(
                chosen.number, chosen.address, chosen.extra, speed_mps, load_n, patch, condition, SHEAR_PA, own_cleaning
            )
            # the recovery's equation is solved to 1e-9 where it is solved step by step
            assert peak[w] == pytest.approx(alone, rel=1e-9)
            assert creep[w] == pytest.approx(place, rel=1e-4)


@pytest.mark.parametrize("law", ["polach", "kalker-linear"])
def test_a_wheel_in_the_air_is_offered_nothing_and_disturbs_no_other(law: str) -> None:
    rng = np.random.default_rng(14)
    chosen = CREEP_LAWS[law].in_force()
    wheels = [random_wheel(rng) for _ in range(LANES)]
    plain = np.array(to_wheels(chosen, wheels, True))
    for w in (1, 4):
        wheels[w] = (wheels[w][0], 0.0, np.zeros(CONDITION))
    lifted = np.array(to_wheels(chosen, wheels, True))
    assert np.all(lifted[:, [1, 4]] == 0.0)
    others = [0, 2, 3, 5, 6, 7]
    assert lifted[:, others] == pytest.approx(plain[:, others], rel=1e-9)
