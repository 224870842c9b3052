"""Kinds of rail as rows of numbers: the friction curves that a surface or a recovery preset stands for.

A scenario's peak adhesion is the largest adhesion of the creep law in force over creep up to 0.3 on rail as found, at
68.7 kN and 100 km/h; mu0 follows from it.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from wheel_rail.adhesion_parameters import RailSurface
from wheel_rail.compiled import compiled
from wheel_rail.creep_laws import LawInForce
from wheel_rail.peak_adhesion import offered_adhesion
from wheel_rail.polach import SURFACES, Surface
from wheel_rail.recovery import CONDITION, DEGRADED, MU0, RECOVERED, TAU
from wheel_rail.sanding import SandEffect

REFERENCE_LOAD_N = 68.7e3
KMH_PER_MPS = 3.6
REFERENCE_SPEED_MPS = 100.0 / KMH_PER_MPS

# a row of curves: as a wheel's condition up to TAU (mu0 of the recovered curve: what does not scale with the degraded
# one; that of the degraded curve varies from place to place and is not in here), then
RATIO = 11  # of the recovered mu0 to the degraded one, where it scales with it
SANDED = 12  # mu0 of degraded (and, next, recovered) curve under plenty of sand
SAND_SCALE = 14  # g/m
SPEED_LAW = 15  # 1 where peak adhesion follows Curtius and Kniffler
SPEED_CORRECTION = 16  # from here on, at FIRST_SPEED_MPS k^2: factor of mu0 over Curtius and Kniffler's value
FIRST_SPEED_MPS = 0.2  # the correction bends most at low speed
SPEEDS = 29
CURVE = SPEED_CORRECTION + SPEEDS


@compiled
def curtius_kniffler(speed_kmh: float) -> float:
    """Adhesion of dry rail over speed, 0.161 + 7.5/(v + 44), v in km/h (Curtius and Kniffler)."""
    return 0.161 + 7.5 / (speed_kmh + 44.0)


@dataclass(frozen=True)
class PeakSearch:
    """Peak adhesion of a creep law on one contact ellipse at the reference load, and back to mu0."""

    law: LawInForce
    patch: np.ndarray
    shear_modulus_pa: float

    def peak(self, mu0: float, surface: Surface, speed_mps: float = REFERENCE_SPEED_MPS) -> float:
        """Largest adhesion over creep up to 0.3 on the friction curve of `surface` with this mu0."""
        condition = np.zeros(CONDITION)
        condition[DEGRADED:RECOVERED] = (mu0, *_shape(surface))
        law = self.law
        found, _ = offered_adhesion(
            law.number, law.address, law.extra, speed_mps, REFERENCE_LOAD_N, self.patch, condition,
            self.shear_modulus_pa, False,
        )  # fmt: skip
        return float(found)

    def mu0(self, peak: float, surface: Surface, speed_mps: float = REFERENCE_SPEED_MPS) -> float:
        """mu0 at which the peak adhesion is `peak`. Raises ValueError where no mu0 up to 5 gives it."""
        highest = self.peak(5.0, surface, speed_mps)
        if peak > highest:
            raise ValueError(f"this surface gives no peak adhesion above {highest:.3g}")

        def missing(log_mu0: float) -> float:
            return self.peak(float(np.exp(log_mu0)), surface, speed_mps) / peak - 1.0

        # friction is never below adhesion
        return float(np.exp(brentq(missing, np.log(0.99 * peak), np.log(5.0), xtol=1e-9, rtol=1e-9)))

    def mu0_of(self, peak: np.ndarray, surface: Surface) -> np.ndarray:
        """mu0 of many peak adhesions, any shape; interpolated in between where they differ."""
        lowest, highest = (self.mu0(float(value), surface) for value in (np.min(peak), np.max(peak)))
        if highest - lowest < 1e-9 * highest:
            return np.full(np.shape(peak), lowest)
        grid = np.geomspace(lowest, highest, 16)
        reached = [self.peak(float(mu0), surface) for mu0 in grid]
        return np.exp(np.interp(np.log(peak), np.log(reached), np.log(grid)))


@dataclass(frozen=True)
class RailKind:
    """A surface of the scenario made ready: the shape of its degraded curve, its own peak, and its row of `curves`."""

    surface: Surface
    nominal_peak: float
    recovered_peak: float | None
    row: np.ndarray


def rail_kind(parameters: RailSurface, search: PeakSearch, sand: SandEffect) -> RailKind:
    """The kind of rail that these parameters describe. Raises ValueError where its peak adhesion cannot be."""
    recovery = parameters.recovery
    row = np.zeros(CURVE)
    if recovery is not None:
        degraded, recovered = recovery.degraded.surface, recovery.recovered.surface
    elif parameters.surface is not None:
        degraded = recovered = SURFACES[parameters.surface]
    else:
        raise ValueError("surface: is missing, and so is recovery")
    if parameters.peak_adhesion is not None:
        peak = parameters.peak_adhesion
    elif parameters.speed_law is not None:
        peak = float(curtius_kniffler(KMH_PER_MPS * REFERENCE_SPEED_MPS))
    else:
        peak = search.peak(degraded.mu0, degraded)
    row[DEGRADED + 1 : RECOVERED] = _shape(degraded)
    row[RECOVERED + 1 : TAU] = _shape(recovered)
    recovered_peak = None
    if recovery is None:
        row[RATIO] = 1.0
    else:
        row[TAU] = recovery.tau_mpj
        if recovery.recovered_level == "relative":
            row[RATIO] = recovered.mu0 / degraded.mu0
        else:
            row[RECOVERED + MU0] = recovered.mu0
            recovered_peak = search.peak(recovered.mu0, recovered)
    row[SANDED] = search.mu0(sand.sanded_adhesion, degraded)
    row[SANDED + 1] = search.mu0(sand.sanded_adhesion, recovered)
    row[SAND_SCALE] = sand.effective_gpm
    if parameters.speed_law is not None:
        row[SPEED_LAW] = 1.0
        row[SPEED_CORRECTION:] = _speed_corrections(peak, degraded, search)
    return RailKind(degraded, peak, recovered_peak, row)


def _shape(surface: Surface) -> tuple[float, float, float, float]:
    return surface.falling_a, surface.falling_b_spm, surface.k_adhesion, surface.k_slip


def _speed_corrections(peak: float, surface: Surface, search: PeakSearch) -> np.ndarray:
    """mu0 for peak x CK(v)/CK(100 km/h), over mu0 for the peak at 100 km/h, over CK(v); (SPEEDS,)."""
    speed_mps = FIRST_SPEED_MPS * np.arange(SPEEDS) ** 2
    law = np.array([curtius_kniffler(KMH_PER_MPS * v) for v in speed_mps])
    wanted = peak * law / curtius_kniffler(KMH_PER_MPS * REFERENCE_SPEED_MPS)
    mu0 = np.array([search.mu0(float(p), surface, float(v)) for p, v in zip(wanted, speed_mps, strict=True)])
    return np.asarray(mu0 / search.mu0(peak, surface) / law)
