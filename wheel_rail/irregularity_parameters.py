"""Parameters of the track's irregularities."""

from typing import Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from wheel_rail.irregularity_spectra import SpectrumName

CELLS_PER_WAVE = 4.0


class IrregularityParameters(BaseModel):
    """Rails that deviate from the line's design: drawn from a spectrum by name, or measured ones from a file.

    They fade in over `fade_m` from `from_m` on and fade out before `to_m`. Wavelengths from `shortest_wavelength_m` to
    `longest_wavelength_m` are drawn in full; beyond, up to a fourth further, their amplitude falls to nothing.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    spectrum: SpectrumName | None = Field(default=None, description="erri-b176-low, erri-b176-high, aar-5 or aar-6")
    file: str | None = Field(default=None, description="measured ones, CSV or Parquet, in place of a spectrum")
    scale: float = Field(default=1.0, gt=0.0, le=5.0, description="factor on all amplitudes")
    from_m: float = Field(default=0.0, ge=0.0)
    to_m: float | None = Field(default=None, gt=0.0, description="the end of the line if it is not given")
    fade_m: float = Field(default=50.0, ge=1.0)
    shortest_wavelength_m: float = Field(default=3.0, gt=0.0)
    longest_wavelength_m: float = Field(default=100.0, le=500.0)
    cell_m: float = Field(default=0.25, ge=0.05, le=1.0, description="spacing of the drawn values")

    @model_validator(mode="after")
    def _can_be_drawn(self) -> Self:
        if (self.spectrum is None) == (self.file is None):
            raise ValueError("spectrum: either it or file must be given")
        if self.shortest_wavelength_m < CELLS_PER_WAVE * self.cell_m:
            raise ValueError(
                f"shortest_wavelength_m = {self.shortest_wavelength_m}: must be at least {CELLS_PER_WAVE:g} cells of "
                f"cell_m = {self.cell_m}"
            )
        if self.longest_wavelength_m < 1.5 * self.shortest_wavelength_m:
            raise ValueError(
                f"longest_wavelength_m = {self.longest_wavelength_m}: must be at least one and a half times "
                f"shortest_wavelength_m = {self.shortest_wavelength_m}"
            )
        return self

    def span_m(self, length_m: float) -> tuple[float, float]:
        """Where they begin and end on a line of that length.

        Raises ValueError if that is beyond its end, or too short to fade in and out.
        """
        end_m = length_m if self.to_m is None else self.to_m
        if end_m > length_m:
            raise ValueError(f"irregularities.to_m = {end_m}: beyond length_m = {length_m}")
        if end_m - self.from_m < 2.0 * self.fade_m:
            raise ValueError(
                f"irregularities.from_m = {self.from_m}: they end at {end_m:g} m, too soon to fade in and out over "
                f"fade_m = {self.fade_m}"
            )
        return self.from_m, end_m
