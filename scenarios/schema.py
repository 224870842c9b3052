"""The scenario as one validated object: the sections of a scenario file, composed of the packages' parameter models."""

import math
from typing import Self

from pydantic import BaseModel, ConfigDict, Field, SerializeAsAny, field_validator, model_validator

from estimators.interface import Estimator
from scenarios.cosimulation.driver import DriverParameters
from scenarios.cosimulation.fault_entries import FaultEntry
from scenarios.cosimulation.traction import TractionParameters
from scenarios.names import find_class, find_creep_law
from sensors import BaliseParameters, ImuParameters, TachometerParameters
from vehicle import CoachParameters
from wheel_rail import AdhesionParameters, TrackParameters
from wheel_rail.creep_laws import LawInForce
from wheel_rail.sanding import SandingParameters
from wsp import BrakeParameters, Controller

STEPS_S = (0.005, 0.0025, 0.002, 0.001, 0.0005)
TICK_S = 0.01
"""Period of tachometers and WSP; steps and record periods divide it."""


class Section(BaseModel):
    """A table of the scenario file: read-only, no unknown keys, finite numbers."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class ScenarioHead(Section):
    """[scenario]: what the run is called and the seeds of everything random in it."""

    name: str = Field(
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_.+-]*$",
        max_length=100,
        description="letters, digits, - _ . +; names the run folder",
    )
    title: str = ""
    world_seed: int = Field(default=1, ge=0, lt=2**63, description="shapes the truth: rail, tachometers in the loop")
    sensor_seed: int = Field(default=1, ge=0, lt=2**63, description="all that only the estimators see")


class SimulationParameters(Section):
    """[simulation]: step, recording, initial state and end."""

    step_s: float = Field(description=f"one of {', '.join(map(str, STEPS_S))}")
    record_period_s: float = Field(default=TICK_S, description="a whole multiple of step_s that divides 0.01")
    longest_s: float = Field(
        default=600.0, ge=1.0, le=36_000.0, description="the run ends here if the coach has not stopped"
    )
    initial_speed_kmh: float = Field(ge=0.0, le=400.0)
    initial_position_m: float = Field(default=50.0, ge=0.0, le=100_000.0, description="of the carbody's centre")

    @field_validator("step_s")
    @classmethod
    def _step_divides_tick(cls, step_s: float) -> float:
        if step_s not in STEPS_S:
            raise ValueError(f"must be one of {', '.join(map(str, STEPS_S))}")
        return step_s

    @model_validator(mode="after")
    def _record_period_fits(self) -> Self:
        if not (_divides(self.step_s, self.record_period_s) and _divides(self.record_period_s, TICK_S)):
            raise ValueError(
                f"record_period_s = {self.record_period_s}: "
                f"must be a whole multiple of step_s = {self.step_s} that divides {TICK_S}"
            )
        return self


class LineAdhesion(AdhesionParameters):
    """[adhesion]: adhesion of the line, and the state in which an earlier train has left its rails."""

    rail_state_file: str | None = Field(
        default=None, description="rail.parquet of an earlier run on the same line; clean rails without it"
    )


class CreepLawParameters(Section):
    """[creep_law]: the law by name, and its own parameters."""

    name: str
    parameters: SerializeAsAny[BaseModel]

    def in_force(self) -> LawInForce:
        """The law ready for the contact."""
        law: LawInForce = find_creep_law(self.name).in_force(self.parameters)
        return law


class WspParameters(Section):
    """[wsp]: the controller by name, and its own parameters."""

    controller: str
    parameters: SerializeAsAny[BaseModel]
    reference_estimator: str | None = Field(
        default=None, description="one of estimators.names, whose speed the controller gets as its reference"
    )


class EstimatorsParameters(Section):
    """[estimators]: which estimators run, and the parameters of each."""

    names: tuple[str, ...]
    parameters: dict[str, SerializeAsAny[BaseModel]]


class Scenario(Section):
    """Everything that determines a run."""

    scenario: ScenarioHead
    simulation: SimulationParameters
    coach: CoachParameters
    track: TrackParameters
    adhesion: LineAdhesion
    creep_law: CreepLawParameters
    sanding: SandingParameters
    driver: DriverParameters
    traction: TractionParameters
    brake: BrakeParameters
    wsp: WspParameters
    faults: tuple[FaultEntry, ...] = ()
    tachometers: TachometerParameters
    imu: ImuParameters
    balises: BaliseParameters
    estimators: EstimatorsParameters
    presets: dict[str, str] = Field(
        default={}, description="section -> preset that it was built on, for the record only"
    )

    @property
    def name(self) -> str:
        return self.scenario.name

    @property
    def brake_at_load(self) -> BrakeParameters:
        """The brake as the coach's load sets it. Raises ValueError where that asks for more than the air supplies."""
        return self.brake.at_load(self.coach.load_ratio)

    @property
    def onboard_seed(self) -> int:
        """Seed of IMU, balises and starting position: an estimator in the loop lets them shape the truth."""
        return self.scenario.sensor_seed if self.wsp.reference_estimator is None else self.scenario.world_seed

    def make_controller(self) -> Controller:
        """A new controller as the scenario has it."""
        controller: Controller = find_class("controller", self.wsp.controller)(self.wsp.parameters)
        return controller

    def make_estimators(self) -> dict[str, Estimator]:
        """New estimators by name, in the scenario's order."""
        parameters = self.estimators.parameters
        return {name: find_class("estimator", name)(parameters[name]) for name in self.estimators.names}


def _divides(part: float, whole: float) -> bool:
    count = whole / part
    return count > 0.5 and math.isclose(count, round(count), rel_tol=0.0, abs_tol=1e-6)
