"""What a solve is made of, each part measured alone: the wheels' contacts, all forces, and Exudyn without any."""

import time
from dataclasses import replace

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.schema import Scenario
from vehicle.coach import SolverFailure
from vehicle.exudyn_system import assemble, load_exudyn, solver_settings
from vehicle.forces import coach_force, wheels_on_rails
from vehicle.layout import SPIN
from vehicle.start import start_state
from wheel_rail.adhesion_state import RailTables
from wheel_rail.compiled import Array, Record, compiled
from wheel_rail.creep_laws import CREEP_LAWS

SPEED_MPS, SLIP = 30.0, 0.01
_FORCE_CALLS = 5_000
_CONTACT_CALLS = {"polach": 20_000, "fastsim": 1_000}
_SOLVER_STEPS = 5_000


class BenchCoach:
    """A coach that slides a little at one place of a scenario's line, under a creep law, ready for compiled loops."""

    def __init__(self, scenario: Scenario, line: Line, position_m: float, law: str = "polach") -> None:
        contact = replace(line.contact, law=CREEP_LAWS[law].in_force())
        self._line = line
        self._calls = _CONTACT_CALLS[law]
        self.record, self.q, self.v = start_state(scenario.coach, contact, line.track, line.rail, position_m, SPEED_MPS)
        self.v[SPIN : SPIN + 4] *= 1.0 - SLIP
        self.force_s(1)  # rail condition, frames and rotations are those of the place from here on
        _contacts(1, self.q, self.v, self.record)

    def force_s(self, calls: int = _FORCE_CALLS) -> float:
        """Time of one evaluation of all forces."""
        line = self._line
        f = np.empty(len(self.q))
        start = time.perf_counter()
        _forces(calls, self.q, self.v, f, self.record, line.track.table, line.rail)
        return (time.perf_counter() - start) / calls

    def contacts_s(self) -> float:
        """Time of the contacts of all eight wheels, read from the table, with the creep forces."""
        start = time.perf_counter()
        _contacts(self._calls, self.q, self.v, self.record)
        return (time.perf_counter() - start) / self._calls

    def solver_s(self, step_s: float) -> float:
        """Time of one step of Exudyn for this system: no forces, a callback that does nothing."""
        exu = load_exudyn()
        container = exu.SystemContainer()  # owns the system: it must outlive the solve
        mbs = container.AddSystem()
        assemble(mbs, self.record, self.q, self.v)
        mbs.Assemble()
        mbs.SetPreStepUserFunction(lambda _mbs, _end_s: True)
        solver = exu.MainSolverImplicitSecondOrder()
        settings = solver_settings(exu, step_s, _SOLVER_STEPS * step_s)
        start = time.perf_counter()
        reached = solver.SolveSystem(mbs, settings)
        wall_s = time.perf_counter() - start
        if not reached:
            raise SolverFailure("Exudyn gave up on a coach without forces")
        return wall_s / _SOLVER_STEPS


@compiled
def _forces(count: int, q: Array, v: Array, f: Array, record: Record, track: Array, rail: RailTables) -> None:
    for _ in range(count):
        coach_force(q, v, f, record, track, rail)


@compiled
def _contacts(count: int, q: Array, v: Array, record: Record) -> None:
    for _ in range(count):
        wheels_on_rails(q, v, record[0])
