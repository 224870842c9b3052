"""[wsp.parameters] of a foreign controller: names of its own, and how the process behind it is kept in bounds."""

from typing import Self

from pydantic import BaseModel, ConfigDict, Field, model_validator


class ProcessParameters(BaseModel):
    """[wsp.parameters.process]: the controller's period, and how long its process may take (wall time)."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    period_s: float = Field(default=0.01, gt=0.0, le=1.0, description="between two ticks, a whole multiple of 0.01")
    tick_limit_s: float = Field(default=2.0, gt=0.0, le=3600.0, description="longest time for a tick or a reset")
    start_limit_s: float = Field(default=30.0, gt=0.0, le=3600.0, description="longest time for loading it")


class ForeignParameters(BaseModel):
    """Whatever names the controller knows, with numbers or texts; `process` and `variables` are the program's."""

    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False)

    process: ProcessParameters = ProcessParameters()
    variables: dict[str, str] = Field(default={}, description="signal -> what the FMU calls it, where that differs")

    @model_validator(mode="after")
    def _are_numbers_or_texts(self) -> Self:
        for name, value in self.own.items():
            if not isinstance(value, int | float | str):
                raise ValueError(f"{name}: must be a number, true, false or a text")
            if "\0" in f"{name}{value}":
                raise ValueError(f"{name}: must be without null characters")
        return self

    @property
    def own(self) -> dict[str, float | str]:
        """The controller's own parameters."""
        return dict(self.__pydantic_extra__ or {})
