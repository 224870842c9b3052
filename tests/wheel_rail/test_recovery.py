"""Recovery of degraded adhesion: the composed law and the fitted preset.

Figures of the published parameter set are cases of the verification.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.wheel_rail.rail_kinds import LAW, LOAD_N, PATCH, SHEAR_PA, condition_at, force, fresh, parameters, peak
from wheel_rail.polach import polach_force
from wheel_rail.recovery import (
    DEGRADED,
    ENERGY,
    RECOVERED,
    TAU,
    adhesive_force,
    share_degraded,
)
from wheel_rail.recovery_parameters import RECOVERY_PRESETS, RecoveryParameters, load_recovery

KMH = 1.0 / 3.6
SERVICE_BRAKE = 0.099
"""What a full service brake asks, as a share of the wheel load."""


def condition(preset: str, energy_jpm: float = 0.0, peak_adhesion: float | None = None) -> np.ndarray:
    stretch = {"recovery": preset} | ({} if peak_adhesion is None else {"peak_adhesion": peak_adhesion})
    found = condition_at(fresh(parameters(stretch), 10.0), 5.0)
    found[ENERGY] = energy_jpm
    return found


def on_one_curve(found: np.ndarray, at: int, creep: float, speed_mps: float) -> float:
    return -polach_force(creep, 0.0, 0.0, creep * speed_mps, LOAD_N, PATCH, found[at : at + 5], SHEAR_PA)[0]


energies = st.one_of(st.just(0.0), st.floats(1e-3, 1e6))
creeps = st.floats(1e-7, 1.0)
speeds = st.floats(0.5, 100.0)
presets = st.sampled_from(sorted(RECOVERY_PRESETS))
CONDITIONS = {name: condition(name) for name in RECOVERY_PRESETS}
# compiled before hypothesis looks at the time
force(CONDITIONS["allotta-2014"], 0.1, 10.0)
on_one_curve(CONDITIONS["allotta-2014"], DEGRADED, 0.1, 10.0)
share_degraded(1.0, 2.0, 1e-4, 0.0, 0.1)


def at_energy(preset: str, energy_jpm: float) -> np.ndarray:
    found = CONDITIONS[preset].copy()
    found[ENERGY] = energy_jpm
    return found


@given(presets, energies, creeps, speeds)
def test_the_composed_force_solves_its_equation_between_the_two_curves(
    preset: str, energy_jpm: float, creep: float, speed_mps: float
) -> None:
    found = at_energy(preset, energy_jpm)
    f = -force(found, creep, speed_mps)[0]
    low, high = (on_one_curve(found, at, creep, speed_mps) for at in (DEGRADED, RECOVERED))
    share = -math.expm1(-found[TAU] * (energy_jpm + f * creep))
    assert f == pytest.approx(low + share * (high - low), rel=1e-9)
    assert min(low, high) * (1 - 1e-12) <= f <= max(low, high) * (1 + 1e-12)


@given(
    degraded=st.floats(0.0, 1e5), recovered=st.floats(0.0, 1e5), tau=st.floats(1e-6, 1e-2), energy=energies,
    creep=st.floats(0.0, 500.0),
)  # fmt: skip
def test_the_share_is_a_share_for_any_two_forces(
    degraded: float, recovered: float, tau: float, energy: float, creep: float
) -> None:
    kept, x = share_degraded(degraded, recovered, tau, energy, creep)
    assert 0.0 <= kept <= 1.0
    assert x <= 1.0
    if degraded > 0.01 * recovered:  # elsewhere the equation is close to having a second solution
        f = degraded + (1.0 - kept) * (recovered - degraded)
        assert kept == pytest.approx(math.exp(-tau * (energy + f * creep)), rel=1e-6, abs=1e-12)


def test_without_energy_nothing_recovers() -> None:
    """lambda(0) = 0: no energy on the rail and none of the wheel's own."""
    assert share_degraded(5e3, 2e4, 1.9e-4, 0.0, 0.0) == (1.0, 0.0)


@given(presets, energies, energies, creeps, speeds)
def test_more_energy_on_the_rail_never_takes_adhesion_away(
    preset: str, one: float, other: float, creep: float, speed_mps: float
) -> None:
    less, more = (force(at_energy(preset, e), creep, speed_mps)[0] for e in sorted((one, other)))
    low, high = (on_one_curve(CONDITIONS[preset], at, creep, speed_mps) for at in (DEGRADED, RECOVERED))
    assert (less - more) * math.copysign(1.0, high - low) >= -1e-6 * abs(less)


@given(presets, energies, creeps, speeds, st.floats(-math.pi, math.pi))
def test_the_force_is_odd_and_turns_with_the_creep(
    preset: str, energy_jpm: float, creep: float, speed_mps: float, angle: float
) -> None:
    found = at_energy(preset, energy_jpm)
    x, y = creep * math.cos(angle), creep * math.sin(angle)
    fx, fy, *slopes = force(found, x, speed_mps, y, 0.3)
    back_x, back_y, *back_slopes = force(found, -x, speed_mps, -y, -0.3)
    assert (back_x, back_y) == pytest.approx((-fx, -fy), rel=1e-12)
    assert back_slopes == pytest.approx(slopes, rel=1e-12)


@pytest.mark.parametrize("preset", RECOVERY_PRESETS)
@pytest.mark.parametrize("creep", [1e-5, 1e-3, 0.01, 0.05, 0.3])
@pytest.mark.parametrize("energy_jpm", [0.0, 1500.0])
def test_tangent_and_secant_are_those_of_the_composed_law(preset: str, creep: float, energy_jpm: float) -> None:
    found = at_energy(preset, energy_jpm)
    h = 1e-4 * creep
    fx, _, tangent, secant = force(found, creep, 30.0)
    slope = -(force(found, creep + h, 30.0)[0] - force(found, creep - h, 30.0)[0]) / (2.0 * h)
    assert tangent == pytest.approx(slope, rel=1e-4, abs=1e-6 * secant)
    assert secant == pytest.approx(-fx / creep, rel=1e-9)


def test_at_rest_without_creep_there_is_no_force_and_a_finite_slope() -> None:
    fx, fy, tangent, secant = force(at_energy("low-recovering", 500.0), 0.0, 0.0)
    assert (fx, fy) == (0.0, 0.0)
    assert tangent == secant > 0.0


def test_a_wheel_that_spins_on_the_spot_cleans_its_place() -> None:
    found = CONDITIONS["allotta-2014"]
    fx, *_ = adhesive_force(
        LAW.number, LAW.address, LAW.extra, -1.0, 0.0, 0.0, 5.0, 0.0, LOAD_N, PATCH, found, SHEAR_PA
    )
    clean = -polach_force(-1.0, 0.0, 0.0, 5.0, LOAD_N, PATCH, found[RECOVERED:TAU], SHEAR_PA)[0]
    assert fx == pytest.approx(-clean, rel=1e-6)


def train(found: np.ndarray, creep: float, speed_mps: float) -> tuple[list[float], list[float]]:
    """Four wheels over one place of the rail, all at this creep: what each finds there at most, and what it uses."""
    offered, used = [], []
    now = found.copy()
    now[ENERGY] = 0.0
    for _ in range(4):
        offered.append(peak(now, speed_mps, own_cleaning=True))
        used.append(-force(now, creep, speed_mps)[0] / LOAD_N)
        now[ENERGY] += used[-1] * LOAD_N * creep
    return offered, used


def test_fitted_preset_first_axle_and_later_ones() -> None:
    offered, used = train(CONDITIONS["low-recovering"], 0.15, 120 * KMH)
    gain = offered[3] / offered[0] - 1.0
    print("offered", np.round(offered, 4), "used", np.round(used, 4), f"gain {gain:.3f}")
    assert 0.06 <= offered[0] <= 0.08
    assert offered[0] == pytest.approx(0.071, abs=0.0005)
    assert gain == pytest.approx(0.145, abs=0.005)  # what the preset's file says
    assert np.all(np.diff(offered) > 0.0)
    assert np.all(np.diff(used) > 0.0)


@pytest.mark.parametrize("peak_adhesion", [0.06, 0.07, 0.08])
@pytest.mark.parametrize("speed_kmh", [5.0, 10.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0])
def test_fitted_preset_a_locked_wheel_stays_locked(peak_adhesion: float, speed_kmh: float) -> None:
    """Under full service brake; with 5 % more load on a leading wheel than 68.7 kN, and at any creep below one too."""
    found = condition("low-recovering", peak_adhesion=peak_adhesion)
    _, used = train(found, 1.0, speed_kmh * KMH)
    assert max(used) < 0.9 * SERVICE_BRAKE
    found[ENERGY] = 1e9
    assert peak(found, speed_kmh * KMH) < SERVICE_BRAKE / 1.05


def test_peak_with_own_cleaning_lies_above_the_peak_as_found() -> None:
    found = CONDITIONS["allotta-2014"]
    assert peak(found, 30.0, own_cleaning=True) > peak(found, 30.0) + 0.03


@pytest.mark.parametrize("energy_jpm", [0.0, 200.0, 1500.0, 1e5])
@pytest.mark.parametrize("own_cleaning", [True, False])
def test_offered_adhesion_is_the_highest_point_of_the_curve(energy_jpm: float, own_cleaning: bool) -> None:
    found = at_energy("allotta-2014", energy_jpm)
    creep = np.geomspace(1e-4, 0.3, 3000)
    if own_cleaning:
        curve = [-force(found, c, 30.0)[0] / LOAD_N for c in creep]
    else:
        kept = math.exp(-found[TAU] * energy_jpm)
        curve = [
            (kept * on_one_curve(found, DEGRADED, c, 30.0) + (1 - kept) * on_one_curve(found, RECOVERED, c, 30.0))
            / LOAD_N
            for c in creep
        ]
    assert peak(found, 30.0, own_cleaning) == pytest.approx(max(curve), rel=1e-5)


def test_a_preset_by_path_and_bad_ones(tmp_path: Path) -> None:
    text = RECOVERY_PRESETS["low-recovering"].read_text(encoding="utf-8")
    mine = tmp_path / "mine.toml"
    mine.write_text(text.replace("tau_mpj = 5e-4", "tau_mpj = 6e-4"), encoding="utf-8")
    assert load_recovery(str(mine)).tau_mpj == 6e-4
    mine.write_text(text.replace("k_slip = 0.1", "k_slip = 10"), encoding="utf-8")
    with pytest.raises(ValueError, match=r"mine.toml: degraded.k_slip: Input should be less than or equal to 1"):
        load_recovery(str(mine))
    with pytest.raises(ValueError, match=r"cannot be read"):
        load_recovery(str(tmp_path / "none.toml"))
    with pytest.raises(ValueError, match=r"must be one of allotta-2014, low-recovering, malvezzi-degraded, or a path"):
        load_recovery("alota-2014")


def test_a_curve_that_recovers_downwards_is_refused() -> None:
    tree = load_recovery("low-recovering").model_dump()
    tree["recovered"]["mu0"] = 0.05
    with pytest.raises(ValueError, match=r"recovered.mu0 = 0.05: must not lie below degraded.mu0"):
        RecoveryParameters.model_validate(tree)
