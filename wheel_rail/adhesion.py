"""Adhesion along the rail: which friction law holds at which place.

A rail is a row of stretches, each with a surface (the shape of the friction curve) and a peak adhesion that is constant
or varies as a random field with a correlation length. The peak adhesion of a scenario is the law's largest adhesion at
68.7 kN and 100 km/h; the law's own mu0 follows from it.
"""

from typing import Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from wheel_rail.contact_table import Contact
from wheel_rail.polach import SURFACES, mu0_for_peak

REFERENCE_LOAD_N = 68.7e3
REFERENCE_SPEED_MPS = 100.0 / 3.6
CELL_M = 0.5


class AdhesionStretch(BaseModel):
    """One stretch of rail from `from_m` to the next stretch (or the end of the line)."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    from_m: float = Field(ge=0.0)
    surface: Literal["dry", "wet", "low", "very-low"]
    peak_adhesion: float = Field(gt=0.0, le=1.0)
    spread: float = Field(default=0.0, ge=0.0, le=0.5, description="half-range of the random field about the peak")
    correlation_length_m: float = Field(default=30.0, ge=1.0, le=10_000.0)

    @model_validator(mode="after")
    def _stays_physical(self) -> Self:
        if not self.spread < self.peak_adhesion or self.peak_adhesion + self.spread > 1.0:
            raise ValueError(
                f"spread = {self.spread}: peak_adhesion +- spread must stay within 0..1, "
                f"here {self.peak_adhesion} +- {self.spread}"
            )
        return self


class AdhesionParameters(BaseModel):
    """Adhesion of the whole line; both rails alike."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    stretches: tuple[AdhesionStretch, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        starts = [s.from_m for s in self.stretches]
        if starts[0] != 0.0:
            raise ValueError(f"stretches.0.from_m = {starts[0]}: the first stretch starts at 0")
        for k in range(1, len(starts)):
            if not starts[k] > starts[k - 1]:
                raise ValueError(
                    f"stretches.{k}.from_m = {starts[k]}: must lie beyond the stretch before ({starts[k - 1]})"
                )
        return self


def _random_field(n: int, correlation_length_m: float, rng: np.random.Generator) -> np.ndarray:
    """Random field with values within -1..1 and correlation exp(-(x/L)^2/2) before bounding, one value per cell."""
    reach = int(np.ceil(4.0 * correlation_length_m / CELL_M))
    # a Gaussian kernel of width L/sqrt 2 on white noise gives a Gaussian correlation of length L
    kernel = np.exp(-((np.arange(-reach, reach + 1) * CELL_M / correlation_length_m) ** 2))
    kernel /= np.sqrt(np.sum(kernel**2))
    white = rng.standard_normal(n + 2 * reach)
    size = 1 << int(np.ceil(np.log2(white.size + kernel.size)))
    smooth = np.fft.irfft(np.fft.rfft(white, size) * np.fft.rfft(kernel, size), size)[2 * reach : 2 * reach + n]
    # the normal distribution's own integral bounds the field and spreads it evenly over its range
    from scipy.special import erf

    return erf(smooth / np.sqrt(2.0))


class Adhesion:
    """Friction-law parameters over the rail, tabulated in cells of 0.5 m.

    `table` (2, n, 5): left and right rail; mu0, A, B (s/m), kA, kS, to be interpolated linearly at s = k * 0.5 m.
    `peak` (n,): the scenario's peak adhesion at 68.7 kN and 100 km/h.
    """

    def __init__(
        self,
        parameters: AdhesionParameters,
        length_m: float,
        contact: Contact,
        rng: np.random.Generator,
    ) -> None:
        patch = contact.at_load(REFERENCE_LOAD_N).patch
        shear_modulus_pa = contact.parameters.shear_modulus_pa
        n = int(np.ceil(length_m / CELL_M)) + 2
        s = np.arange(n) * CELL_M
        self.peak = np.empty(n)
        law = np.empty((n, 5))
        starts = [stretch.from_m for stretch in parameters.stretches] + [np.inf]
        # a stream for each stretch, and the field drawn over the whole line: changing one stretch, or moving its
        # border, leaves the rest of the rail alone
        streams = rng.spawn(len(parameters.stretches))
        for k, stretch in enumerate(parameters.stretches):
            inside = (s >= starts[k]) & (s < starts[k + 1])
            varies = stretch.spread > 0.0
            field = _random_field(n, stretch.correlation_length_m, streams[k]) if varies else np.zeros(n)
            peak = stretch.peak_adhesion + stretch.spread * field
            surface = SURFACES[stretch.surface]
            self.peak[inside] = peak[inside]
            law[inside, 0] = mu0_for_peak(
                peak[inside], surface, REFERENCE_SPEED_MPS, REFERENCE_LOAD_N, patch, shear_modulus_pa
            )
            law[inside, 1:] = (surface.falling_a, surface.falling_b_spm, surface.k_adhesion, surface.k_slip)
        self.cell_m = CELL_M
        self.s_m = s
        self.table = np.ascontiguousarray(np.stack([law, law]))
