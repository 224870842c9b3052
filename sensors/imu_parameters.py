"""Parameters of an IMU, and its presets by name."""

import itertools
import math
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_validator

IMU_PRESETS: dict[str, Path] = {path.stem: path for path in sorted((Path(__file__).parent / "presets").glob("*.toml"))}

Degrees = Annotated[float, Field(ge=-180.0, le=180.0)]
SmallShare = Annotated[float, Field(ge=0.0, le=0.2)]


class _Strict(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def _check_points(abscissa: str, at: tuple[float, ...], ordinates: dict[str, tuple[float, ...]]) -> None:
    if not at or any(b <= a for a, b in itertools.pairwise(at)) or not all(map(math.isfinite, at)):
        raise ValueError(f"{abscissa}: {list(at)}, wanted at least one point, rising")
    for name, values in ordinates.items():
        if len(values) != len(at):
            raise ValueError(f"{name}: {len(values)} values where {abscissa} has {len(at)}")


class TemperatureProfile(_Strict):
    """Temperature of the chip over time, straight between the points and level beyond them."""

    t_s: tuple[float, ...] = (0.0,)
    temperature_degc: tuple[Annotated[float, Field(ge=-60.0, le=125.0)], ...] = (20.0,)

    @model_validator(mode="after")
    def _points(self) -> "TemperatureProfile":
        _check_points("t_s", self.t_s, {"temperature_degc": self.temperature_degc})
        return self


class AccelerometerCurve(_Strict):
    """Error of each axis over temperature, straight between the points and level beyond them."""

    temperature_degc: tuple[float, ...] = (20.0,)
    x_mps2: tuple[float, ...] = (0.0,)
    y_mps2: tuple[float, ...] = (0.0,)
    z_mps2: tuple[float, ...] = (0.0,)

    @model_validator(mode="after")
    def _points(self) -> "AccelerometerCurve":
        axes = {"x_mps2": self.x_mps2, "y_mps2": self.y_mps2, "z_mps2": self.z_mps2}
        _check_points("temperature_degc", self.temperature_degc, axes)
        return self


class GyroscopeCurve(_Strict):
    """Error of each axis over temperature, straight between the points and level beyond them."""

    temperature_degc: tuple[float, ...] = (20.0,)
    x_radps: tuple[float, ...] = (0.0,)
    y_radps: tuple[float, ...] = (0.0,)
    z_radps: tuple[float, ...] = (0.0,)

    @model_validator(mode="after")
    def _points(self) -> "GyroscopeCurve":
        axes = {"x_radps": self.x_radps, "y_radps": self.y_radps, "z_radps": self.z_radps}
        _check_points("temperature_degc", self.temperature_degc, axes)
        return self


class AccelerometerParameters(_Strict):
    """Errors of the accelerometer; zero switches one off.

    The noise density is sigma sqrt(Ts), the coefficient N of the Allan deviation. A data sheet's density is usually
    that of the one-sided spectrum: divide it by sqrt(2).
    """

    noise_density_mps2_per_rthz: float = Field(ge=0.0, le=1.0)
    offset_mps2: float = Field(default=0.0, ge=0.0, le=50.0, description="largest constant offset, uniform")
    drift_sd_mps2: float = Field(default=0.0, ge=0.0, le=10.0, description="of the Gauss-Markov drift")
    drift_time_s: float = Field(default=1000.0, gt=0.0, description="correlation time of the drift")
    scale_sd_share: SmallShare = Field(default=0.0, description="standard deviation of the scale factor error")
    cross_axis_sd_share: SmallShare = Field(default=0.0, description="standard deviation of each cross coefficient")
    temperature: AccelerometerCurve = AccelerometerCurve()
    resolution_mps2: float = Field(default=0.0, ge=0.0, le=1.0, description="one count; 0 for none")
    range_mps2: float = Field(gt=0.0, le=1000.0, description="readings saturate at plus and minus this")


class GyroscopeParameters(_Strict):
    """Errors of the gyroscope; zero switches one off. The noise density is sigma sqrt(Ts), as for the accelerometer."""

    noise_density_radps_per_rthz: float = Field(ge=0.0, le=1.0)
    offset_radps: float = Field(default=0.0, ge=0.0, le=1.0, description="largest constant offset, uniform")
    drift_sd_radps: float = Field(default=0.0, ge=0.0, le=1.0, description="of the Gauss-Markov drift")
    drift_time_s: float = Field(default=1000.0, gt=0.0, description="correlation time of the drift")
    scale_sd_share: SmallShare = Field(default=0.0, description="standard deviation of the scale factor error")
    cross_axis_sd_share: SmallShare = Field(default=0.0, description="standard deviation of each cross coefficient")
    temperature: GyroscopeCurve = GyroscopeCurve()
    resolution_radps: float = Field(default=0.0, ge=0.0, le=1.0, description="one count; 0 for none")
    range_radps: float = Field(gt=0.0, le=100.0, description="readings saturate at plus and minus this")


class ImuParameters(_Strict):
    """An IMU: place, mounting, rates, and the errors of its two triads.

    Mounting: sensor = Rx(roll) Ry(pitch) Rz(yaw) carbody, proper rotations. The angles are the true ones; what the
    train knows of them comes from `gravity_calibration`. The lever arm leads from the carbody's centre of mass.
    """

    rate_hz: float = Field(default=100.0, gt=0.0, le=10000.0, description="a whole fraction of the truth's rate")
    bandwidth_hz: float = Field(gt=0.0, description="second-order Butterworth low-pass; below half the truth's rate")
    lever_arm_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mounting_roll_deg: Degrees = 0.0
    mounting_pitch_deg: Degrees = Field(default=0.0, gt=-90.0, lt=90.0)
    mounting_yaw_deg: Degrees = 0.0
    calibration_residual_rad: float = Field(
        default=0.0, ge=0.0, le=0.2, description="standard deviation of roll and pitch left by the gravity calibration"
    )
    temperature_resolution_k: float = Field(default=0.0, ge=0.0, le=10.0)
    temperature: TemperatureProfile = TemperatureProfile()
    accelerometer: AccelerometerParameters
    gyroscope: GyroscopeParameters
