"""Parameters of the brake plant, and the presets by name."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

BRAKE_PRESETS: dict[str, Path] = {
    path.stem: path for path in sorted((Path(__file__).parent / "presets").glob("*.toml"))
}
"""Name of a preset -> its TOML file, whose keys are those of BrakeParameters."""

LONGEST_CURVE = 8
"""Most points of a curve."""

Factor = Annotated[float, Field(gt=0.0, le=3.0)]
Speeds = Annotated[tuple[Annotated[float, Field(ge=0.0, le=600.0)], ...], Field(min_length=1, max_length=LONGEST_CURVE)]
Factors = Annotated[tuple[Factor, ...], Field(min_length=1, max_length=LONGEST_CURVE)]
Temperatures = Annotated[
    tuple[Annotated[float, Field(ge=-100.0, le=1500.0)], ...], Field(min_length=1, max_length=LONGEST_CURVE)
]


class _Parameters(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def _require_curve(self, places: str, values: str) -> None:
        """Refuse a curve whose places do not rise or that has not one value for each."""
        x, y = getattr(self, places), getattr(self, values)
        if any(right <= left for left, right in pairwise(x)):
            raise ValueError(f"{places} = {x}: must rise from each to the next")
        if len(x) != len(y):
            raise ValueError(f"{values} has {len(y)} values, {places} has {len(x)}: one for each is needed")


class FrictionCurve(_Parameters):
    """Friction of pads or blocks over its mean, linear between points, constant beyond the first and last."""

    sliding_speed_mps: Speeds = Field(default=(0.0,), description="at the friction radius, rising")
    speed_factor: Factors = Field(default=(1.0,), description="friction over its mean at these speeds")
    temperature_degc: Temperatures = Field(default=(20.0,), description="of disc or wheel, rising")
    temperature_factor: Factors = Field(default=(1.0,), description="multiplies the former at these temperatures")

    @model_validator(mode="after")
    def _points_match(self) -> Self:
        self._require_curve("sliding_speed_mps", "speed_factor")
        self._require_curve("temperature_degc", "temperature_factor")
        return self


class HeatParameters(_Parameters):
    """Lumped heat balance of the discs (or tread-braked wheels) of one axle, from ambient temperature on.

    C dT/dt = M |omega| - (k0 + k1 |v|) (T - Ta) - eps A sigma (T^4 - Ta^4), temperatures absolute in the last term.
    """

    heat_capacity_jpk: float = Field(gt=0.0, le=1e7, description="C of all discs of an axle (or its two wheels)")
    cooling_wpk: float = Field(ge=0.0, le=1e5, description="k0, convection at standstill")
    cooling_speed_wspkm: float = Field(ge=0.0, le=1e4, description="k1, its growth per m/s of the train's speed")
    radiating_area_m2: float = Field(default=0.0, ge=0.0, le=100.0, description="eps A, emissivity included")
    ambient_degc: float = Field(default=20.0, ge=-60.0, le=80.0, description="Ta")


class DynamicBrakeParameters(_Parameters):
    """Dynamic brake of the bogies, blended: the pneumatics of a bogie supply what it does not.

    Torque of an axle = the smallest of what the distributor asks for (less its return spring), torque limit, and power
    limit over the speed of rotation; the limit fades out linearly between two speeds of the axle's own wheels. While a
    hold or vent valve of the bogie is energised it is cut.
    """

    bogies: tuple[bool, bool] = Field(default=(True, True), description="which of the two bogies have it")
    torque_limit_nm: float = Field(gt=0.0, le=1e5, description="per axle, at the wheelset")
    power_limit_kw: float = Field(gt=0.0, le=1e4, description="per axle")
    wheel_radius_m: float = Field(gt=0.0, le=1.0, description="turns the following speeds into speeds of rotation")
    fade_from_kmh: float = Field(gt=0.0, le=200.0, description="all of it above this speed of the wheels")
    fade_to_kmh: float = Field(ge=0.0, le=200.0, description="nothing of it below")
    cut_nmps: float = Field(
        gt=0.0, le=1e7, description="fall of the torque per second, per axle: when the WSP cuts it or less is asked"
    )
    return_nmps: float = Field(gt=0.0, le=1e7, description="its rise per second, per axle")

    @model_validator(mode="after")
    def _fades(self) -> Self:
        if self.fade_to_kmh >= self.fade_from_kmh:
            raise ValueError(
                f"fade_to_kmh = {self.fade_to_kmh}: must be below fade_from_kmh = {self.fade_from_kmh}, "
                "the brake fades out as the train slows down"
            )
        return self


class TrackBrakeParameters(_Parameters):
    """Magnetic track brake: force of a bogie = attraction * friction(speed), linear rise and fall when switched."""

    attraction_n: float = Field(gt=0.0, le=1e6, description="of the magnets of one bogie on both rails")
    speed_kmh: Speeds = Field(description="of the train, rising")
    friction: Factors = Field(description="pole shoes on rail at these speeds")
    rise_time_s: float = Field(gt=0.0, le=10.0, description="switched on (magnets lowered) to full force, and back")
    cut_out_kmh: float = Field(gt=0.0, le=200.0, description="off below this speed of the train")

    @model_validator(mode="after")
    def _points_match(self) -> Self:
        self._require_curve("speed_kmh", "friction")
        return self


class BrakeParameters(_Parameters):
    """Pneumatic disc or tread brake of a four-axle coach, the axles alike. Pressures gauge; conductances ISO 6358's.

    Friction torque of an axle = cylinders_per_axle * lever_ratio * cylinder_area_m2 * q * friction * friction_radius_m
    with the pad pressure q: p less return_spring_pressure_bar while p rises, up to (1 + linkage_hysteresis) times that
    while it falls (wsp.cylinder). Volume behind the valves of an axle = cylinder_volume_dm3 + clearance_volume_dm3
    (share of the clearance stroke done) + elastic_volume_dm3pbar * q.
    """

    full_service_pressure_bar: float = Field(
        gt=0.0, le=8.0, description="distributor (relay) output pressure at demand 1, coach empty"
    )
    weighs_load: bool = Field(
        default=True, description="whether the pressure beyond the return spring's grows with the mass to be braked"
    )
    application_time_s: float = Field(
        gt=0.0, le=60.0, description="distributor output from 0 to full service, at a constant rate"
    )
    release_time_s: float = Field(
        gt=0.0, le=120.0, description="distributor output from full service to 0, at a constant rate"
    )
    reservoir_volume_dm3: float = Field(gt=0.0, le=2000.0, description="auxiliary reservoir that all four axles share")
    feed_pressure_bar: float = Field(gt=0.0, le=12.0, description="of the feed pipe; the reservoir starts with it")
    feed_conductance_dm3psbar: float = Field(ge=0.0, le=100.0, description="feed pipe to reservoir, one way")
    valve_dead_time_s: float = Field(
        ge=0.0, le=0.2, description="command to first movement of hold and vent valve; rounded to whole base steps"
    )
    valve_opening_time_s: float = Field(gt=0.0, le=0.2, description="first movement to fully open or shut")
    safety_timer_s: float = Field(
        default=10.0,
        ge=0.1,
        le=60.0,
        description="hardware watchdog: hold or vent valve energised without a break for so long is switched off "
        "until its axle is commanded to fill; M: of the order of 10 s",
    )
    fill_conductance_dm3psbar: float = Field(
        gt=0.0, le=100.0, description="distributor to cylinder, both ways, hold valve open"
    )
    vent_conductance_dm3psbar: float = Field(gt=0.0, le=100.0, description="cylinder to atmosphere, vent valve open")
    leakage_dm3psbar: float = Field(default=0.0, ge=0.0, le=10.0, description="cylinder to atmosphere, per axle")
    critical_ratio: float = Field(
        gt=0.0, lt=1.0, description="pressure ratio below which the flow is choked, of all passages"
    )
    air_temperature_degc: float = Field(ge=-50.0, le=80.0, description="of the compressed air, constant (isothermal)")
    cylinder_volume_dm3: float = Field(
        gt=0.0, le=100.0, description="cylinders and pipes of one axle behind its valves, pistons at rest"
    )
    clearance_volume_dm3: float = Field(
        default=0.0, ge=0.0, le=100.0, description="its growth by the stroke until the pads touch"
    )
    elastic_volume_dm3pbar: float = Field(
        default=0.0, ge=0.0, le=20.0, description="its growth per bar of pad pressure, as linkage and pads give"
    )
    return_spring_preload_bar: float = Field(
        default=0.0, ge=0.0, le=2.0, description="cylinder pressure that starts the clearance stroke"
    )
    return_spring_pressure_bar: float = Field(ge=0.0, le=2.0, description="cylinder pressure that lays the pads on")
    linkage_hysteresis: float = Field(
        default=0.0,
        ge=0.0,
        le=0.5,
        description="friction of the linkage: force while the pressure falls over that while it rises, less 1",
    )
    cylinders_per_axle: int = Field(ge=1, le=8, description="disc brake: one per disc")
    cylinder_area_m2: float = Field(gt=0.0, le=1.0, description="piston area of one cylinder")
    lever_ratio: float = Field(
        gt=0.0,
        le=20.0,
        description="sum of the forces of pads or blocks over the piston force, pressure rising, efficiency included",
    )
    friction_radius_m: float = Field(gt=0.0, le=1.0, description="where the pads rub; tread brake: the wheel's radius")
    block_friction: Literal["curve", "karwatzki"] = Field(
        default="curve", description="pad_friction times friction_curve, or Karwatzki's formula for cast iron blocks"
    )
    pad_friction: float = Field(
        gt=0.0, le=1.0, description="mean over a stop; with karwatzki only what the blending reckons with"
    )
    blocks_per_axle: int = Field(default=4, ge=1, le=32, description="pads or blocks that share the force (karwatzki)")
    friction_curve: FrictionCurve = FrictionCurve()
    heat: HeatParameters | None = Field(default=None, description="none: discs stay at the first 20 degC")
    dynamic_brake: DynamicBrakeParameters | None = None
    track_brake: TrackBrakeParameters | None = None

    @property
    def force_per_bar_n(self) -> float:
        """Sum of the forces of all pads or blocks of an axle per bar of pad pressure."""
        return 1e5 * self.cylinders_per_axle * self.lever_ratio * self.cylinder_area_m2

    @property
    def largest_volume_dm3(self) -> float:
        """Volume behind the valves of one axle at full service."""
        pads_bar = max(0.0, self.full_service_pressure_bar - self.return_spring_pressure_bar)
        return self.cylinder_volume_dm3 + self.clearance_volume_dm3 + self.elastic_volume_dm3pbar * pads_bar

    def at_load(self, load_ratio: float) -> Self:
        """The brake of a coach whose mass to be braked, rotating parts included, is `load_ratio` of the empty one's.

        Raises ValueError where that pressure cannot be supplied.
        """
        if not self.weighs_load or load_ratio == 1.0:
            return self
        spring_bar = self.return_spring_pressure_bar
        full_bar = spring_bar + load_ratio * max(0.0, self.full_service_pressure_bar - spring_bar)
        if full_bar > self.feed_pressure_bar:
            raise ValueError(
                f"full_service_pressure_bar = {self.full_service_pressure_bar}: weighs the load up to {full_bar:.2f} "
                f"bar, more than feed_pressure_bar = {self.feed_pressure_bar} supplies"
            )
        return self.model_copy(update={"full_service_pressure_bar": full_bar})

    @model_validator(mode="after")
    def _pads_clear(self) -> Self:
        if self.clearance_volume_dm3 > 0.0 and self.return_spring_preload_bar >= self.return_spring_pressure_bar:
            raise ValueError(
                f"return_spring_preload_bar = {self.return_spring_preload_bar}: with a clearance stroke it must be "
                f"below return_spring_pressure_bar = {self.return_spring_pressure_bar}, the end of the stroke"
            )
        return self

    @model_validator(mode="after")
    def _reservoir_feeds_the_cylinders(self) -> Self:
        least = 4.0 * self.largest_volume_dm3
        if self.reservoir_volume_dm3 < least:
            raise ValueError(
                f"reservoir_volume_dm3 = {self.reservoir_volume_dm3}: must be at least the volume of the cylinders "
                f"of four axles, {least:.3g}"
            )
        if self.feed_pressure_bar < self.full_service_pressure_bar:
            raise ValueError(
                f"feed_pressure_bar = {self.feed_pressure_bar}: must be at least "
                f"full_service_pressure_bar = {self.full_service_pressure_bar}, which it has to supply"
            )
        return self
