"""Parameters of the adhesion along the line: stretches, patches laid over them, and what gives the peak adhesion."""

from itertools import pairwise
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from wheel_rail.adhesion_memory import FrictionMemoryParameters
from wheel_rail.recovery_parameters import NamedRecovery

Rails = Literal["left", "right", "both"]


class RailSurface(BaseModel):
    """What lies on the rail: the shape of the friction curve, its peak, and what changes it."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    surface: Literal["dry", "wet", "low", "very-low"] | None = Field(
        default=None, description="Polach's friction curve; the alternative is recovery"
    )
    recovery: NamedRecovery = Field(
        default=None, description="friction that cleaning restores: a preset's name, a .toml file or a table"
    )
    peak_adhesion: float | None = Field(
        default=None, gt=0.0, le=1.0, description="at 68.7 kN a wheel and 100 km/h; a share of the load: 7 % is 0.07"
    )
    speed_law: Literal["curtius-kniffler"] | None = Field(
        default=None, description="peak adhesion follows 0.161 + 7.5/(v_kmh + 44), scaled to peak_adhesion if given"
    )

    @model_validator(mode="after")
    def _has_one_shape(self) -> Self:
        if (self.surface is None) == (self.recovery is None):
            found = "neither is given" if self.surface is None else f"surface = {self.surface!r} and recovery are given"
            raise ValueError(f"surface: exactly one of surface and recovery gives the friction curve, here {found}")
        return self


class AdhesionStretch(RailSurface):
    """One stretch of rail from `from_m` to the next stretch (or the end of the line).

    Its peak adhesion comes from `peak_adhesion` (with a random field if `spread` > 0), from `file`, from the speed law,
    or else from the surface's own published curve.
    """

    from_m: float = Field(ge=0.0)
    spread: float = Field(default=0.0, ge=0.0, le=0.5, description="half-range of the random field about the peak")
    correlation_length_m: float = Field(default=30.0, ge=1.0, le=10_000.0)
    rails_correlation: float = Field(
        default=1.0, ge=0.0, le=1.0, description="of the two rails' random fields before bounding; 1: both rails alike"
    )
    file: str | None = Field(
        default=None, description="CSV file of position_m, left, right: the peak adhesion of either rail"
    )

    @model_validator(mode="after")
    def _has_one_peak(self) -> Self:
        if self.file is not None and self.peak_adhesion is not None:
            raise ValueError(f"peak_adhesion = {self.peak_adhesion}: must not stand beside file, which gives the peak")
        if self.spread > 0.0:
            if self.peak_adhesion is None:
                raise ValueError(f"spread = {self.spread}: a random field needs peak_adhesion, about which it varies")
            if not self.spread < self.peak_adhesion or self.peak_adhesion + self.spread > 1.0:
                raise ValueError(
                    f"spread = {self.spread}: peak_adhesion +- spread must stay within 0..1, "
                    f"here {self.peak_adhesion} +- {self.spread}"
                )
        return self


class AdhesionPatches(RailSurface):
    """Patches of one kind laid over the stretches: at the places `starts_m`, or every `spacing_m` in `from_m`..`to_m`.

    Each is `length_m` long. Only whole patches are laid by spacing.
    """

    length_m: float = Field(ge=1.0)
    rails: Rails = "both"
    starts_m: tuple[float, ...] | None = Field(default=None, min_length=1, description="where each patch begins")
    from_m: float | None = Field(default=None, ge=0.0)
    to_m: float | None = Field(default=None, gt=0.0)
    spacing_m: float | None = Field(default=None, gt=0.0, description="from the start of a patch to that of the next")

    @model_validator(mode="after")
    def _has_places(self) -> Self:
        row = {"from_m": self.from_m, "to_m": self.to_m, "spacing_m": self.spacing_m}
        if self.starts_m is not None:
            for name, value in row.items():
                if value is not None:
                    raise ValueError(f"{name} = {value}: must not stand beside starts_m")
            if self.starts_m[0] < 0.0:
                raise ValueError(f"starts_m.0 = {self.starts_m[0]}: must not be negative")
            for k, (one, other) in enumerate(pairwise(self.starts_m)):
                if other < one + self.length_m:
                    raise ValueError(
                        f"starts_m.{k + 1} = {other}: overlaps the patch before, which reaches to {one + self.length_m}"
                    )
            return self
        for name, value in row.items():
            if value is None:
                raise ValueError(f"{name}: is missing; patches need starts_m, or from_m, to_m and spacing_m")
        if self.from_m is None or self.to_m is None or self.spacing_m is None:
            return self  # refused above
        if self.to_m < self.from_m + self.length_m:
            raise ValueError(f"to_m = {self.to_m}: no patch of {self.length_m} m fits between {self.from_m} and this")
        if self.spacing_m < self.length_m:
            raise ValueError(f"spacing_m = {self.spacing_m}: patches overlap, they are {self.length_m} m long")
        return self

    @property
    def spans_m(self) -> list[tuple[float, float]]:
        """Begin and end of each patch."""
        if self.starts_m is not None:
            return [(start, start + self.length_m) for start in self.starts_m]
        if self.from_m is None or self.to_m is None or self.spacing_m is None:
            return []  # validation refuses it
        count = int((self.to_m - self.from_m - self.length_m) / self.spacing_m + 1e-9) + 1
        return [(start, start + self.length_m) for start in (self.from_m + k * self.spacing_m for k in range(count))]

    @property
    def sides(self) -> tuple[int, ...]:
        """Rails that carry them: 0 left, 1 right."""
        return {"left": (0,), "right": (1,), "both": (0, 1)}[self.rails]


class AdhesionParameters(BaseModel):
    """Adhesion of the whole line."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    stretches: tuple[AdhesionStretch, ...] = Field(min_length=1)
    patches: tuple[AdhesionPatches, ...] = ()
    memory: FrictionMemoryParameters | None = None

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

    @model_validator(mode="after")
    def _patches_apart(self) -> Self:
        for side in (0, 1):
            spans = sorted((*span, k) for k, patches in enumerate(self.patches) if side in patches.sides
                           for span in patches.spans_m)  # fmt: skip
            for (_, end, one), (start, _, other) in pairwise(spans):
                if start < end:
                    raise ValueError(
                        f"patches.{other}: overlaps patches.{one} on the {('left', 'right')[side]} rail "
                        f"between {start} and {end} m"
                    )
        return self
