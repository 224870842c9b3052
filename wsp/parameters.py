"""Parameters of the brake plant, and the presets by name."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

BRAKE_PRESETS: dict[str, Path] = {
    path.stem: path for path in sorted((Path(__file__).parent / "presets").glob("*.toml"))
}
"""Name of a preset -> its TOML file, whose keys are those of BrakeParameters."""


class BrakeParameters(BaseModel):
    """Pneumatic disc brake of a four-axle coach, the axles alike. Pressures are gauge; conductances are ISO 6358's.

    Friction torque of an axle = discs_per_axle * pad_friction * F * disc_effective_radius_m, with the force of both
    pads F = lever_ratio * cylinder_area_m2 * max(0, p - return_spring_pressure_bar).
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    full_service_pressure_bar: float = Field(
        gt=0.0, le=8.0, description="distributor (relay) output pressure at demand 1"
    )
    application_time_s: float = Field(
        gt=0.0, le=60.0, description="distributor output from 0 to full service, at a constant rate"
    )
    release_time_s: float = Field(
        gt=0.0, le=120.0, description="distributor output from full service to 0, at a constant rate"
    )
    valve_dead_time_s: float = Field(
        ge=0.0, le=0.2, description="command to first movement of hold and vent valve; rounded to whole base steps"
    )
    valve_opening_time_s: float = Field(gt=0.0, le=0.2, description="first movement to fully open or shut")
    fill_conductance_dm3psbar: float = Field(
        gt=0.0, le=100.0, description="distributor to cylinder, both ways, hold valve open"
    )
    vent_conductance_dm3psbar: float = Field(gt=0.0, le=100.0, description="cylinder to atmosphere, vent valve open")
    critical_ratio: float = Field(
        gt=0.0, lt=1.0, description="pressure ratio below which the flow is choked, of both passages"
    )
    cylinder_volume_dm3: float = Field(
        gt=0.0, le=100.0, description="cylinders and pipes of one axle behind its valves"
    )
    air_temperature_degc: float = Field(ge=-50.0, le=80.0, description="of the compressed air, constant (isothermal)")
    discs_per_axle: int = Field(ge=1, le=4)
    cylinder_area_m2: float = Field(gt=0.0, le=1.0, description="piston area of the cylinder of one disc")
    lever_ratio: float = Field(gt=0.0, le=20.0, description="force of both pads on their disc over the piston force")
    return_spring_pressure_bar: float = Field(ge=0.0, le=2.0, description="cylinder pressure that lays the pads on")
    pad_friction: float = Field(gt=0.0, le=1.0)
    disc_effective_radius_m: float = Field(gt=0.0, le=1.0)
