"""Parameters of degraded adhesion that recovers, in files: two friction curves and what leads from one to the other."""

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, WrapValidator, model_validator

from wheel_rail.polach import Surface

RECOVERY_PRESETS: dict[str, Path] = {
    name: Path(__file__).parent / "presets" / f"{name}.toml"
    for name in ("allotta-2014", "low-recovering", "malvezzi-degraded")
}


class FrictionCurve(BaseModel):
    """mu(w) = mu0 ((1 - A) exp(-B w) + A), with Polach's factors of the areas of adhesion and slip."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    mu0: float = Field(gt=0.0, le=1.5)
    falling_a: float = Field(ge=0.0, le=1.0)
    falling_b_spm: float = Field(ge=0.0)
    k_adhesion: float = Field(gt=0.0, le=1.0)
    k_slip: float = Field(gt=0.0, le=1.0)

    @property
    def surface(self) -> Surface:
        """The curve in the form of `SURFACES`."""
        return Surface(**self.model_dump())


class RecoveryParameters(BaseModel):
    """Two friction curves and the energy that leads from one to the other.

    Where the scenario gives a peak adhesion, the degraded curve's mu0 follows from it; the recovered curve then keeps
    its own mu0 (`absolute`) or its ratio to the degraded one (`relative`).
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    tau_mpj: float = Field(gt=0.0, le=1.0, description="lambda = 1 - exp(-tau W), W in J/m; published 1.9e-4")
    recovered_level: Literal["absolute", "relative"] = "absolute"
    degraded: FrictionCurve
    recovered: FrictionCurve

    @model_validator(mode="after")
    def _recovers(self) -> Self:
        if self.recovered.mu0 < self.degraded.mu0:
            raise ValueError(
                f"recovered.mu0 = {self.recovered.mu0}: must not lie below degraded.mu0 = {self.degraded.mu0}"
            )
        return self


def load_recovery(name_or_path: str) -> RecoveryParameters:
    """The preset of that name, or the parameters in a .toml file.

    Raises ValueError for an unknown name, an unreadable file or bad parameters.
    """
    path = RECOVERY_PRESETS.get(name_or_path)
    if path is None:
        if not name_or_path.endswith(".toml"):
            raise ValueError(f"must be one of {', '.join(RECOVERY_PRESETS)}, or a path to a .toml file")
        path = Path(name_or_path)
    try:
        return RecoveryParameters.model_validate(tomllib.loads(path.read_text(encoding="utf-8")), strict=True)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ValueError(f"cannot be read: {error}") from None
    except ValidationError as error:
        faults = "; ".join(f"{'.'.join(map(str, e['loc']))}: {e['msg']}" for e in error.errors(include_url=False))
        raise ValueError(f"{path}: {faults}") from None


def _by_name(value: Any, handler: Any) -> Any:
    return load_recovery(value) if isinstance(value, str) else handler(value)


NamedRecovery = Annotated[RecoveryParameters | None, WrapValidator(_by_name)]
"""A field that takes a preset's name, a path or the parameters themselves, and holds the parameters."""
