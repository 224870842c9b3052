"""The coach as an Exudyn system: rigid bodies and four spinning wheelsets, solved in one run with a callback.

Exudyn holds masses and coordinates and integrates (generalised-alpha); all forces come from the compiled routine of
`vehicle.forces`. Each step is one linearised solve (no Newton iteration): `vehicle.implicit` makes of the forces at the
predictor those with which Exudyn's solve for the masses alone is the implicit step, by a Jacobian that is renewed when
it has aged. As a reference Exudyn iterates by itself with such Jacobians (`newton`). The spectral radius is low on
purpose: creep is stiff, and at 0.9 the algorithmic accelerations of the spins ring for dozens of steps and a stale
Jacobian makes false creep forces and chatter at standstill; at 0.1 they are gone after two steps, while body and bogie
modes, slow against the step, stay undamped.

The callback has a period of its own, a whole multiple of the step. At each of its instants t_k the state of t_k is
handed to `on_step`; what that returns acts from t_k until the next instant. So the actuation answers a state with no
delay beyond its period; any delay of valves or controllers is the callback's own. What has to happen more often than
Python should be asked is a `Plant`, called by the compiled code between the steps.
"""

import gc
import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicle.exudyn_system import assemble, load_exudyn, solver_settings
from vehicle.forces import coach_force
from vehicle.implicit import room_for_response
from vehicle.interface import Actuation, CoachState, OnStep, Plant
from vehicle.jacobian import coach_jacobian
from vehicle.parameters import CoachParameters
from vehicle.pre_step import pre_step
from vehicle.start import start_state
from vehicle.stepping import LOST, REFUSED
from wheel_rail import Contact, Track
from wheel_rail.adhesion_state import RailTables
from wheel_rail.compiled import address_of


class SolverFailure(RuntimeError):
    """The integration did not reach its end: when, where and with which step."""


@dataclass(frozen=True)
class SolveReport:
    """How a run went: simulated and wall time, the step, the Exudyn build, and counts of steps and Jacobians."""

    simulated_s: float
    wall_s: float
    step_s: float
    exudyn_build: str
    steps: int
    jacobians: int


class Coach:
    """A coach on a track; see the module's description for how a run proceeds.

    `rail` is what its wheels run on: the coach leaves its marks there (energy, sand), so that whatever runs on the same
    tables later meets them.
    """

    def __init__(self, parameters: CoachParameters, contact: Contact, track: Track, rail: RailTables) -> None:
        self.parameters = parameters
        self._track = track
        self._rail = rail
        self._contact = contact

    def run(
        self,
        step_s: float,
        longest_s: float,
        initial_position_m: float,
        initial_speed_mps: float,
        on_step: OnStep,
        period_s: float,
        newton: bool = False,
        plant: Plant | None = None,
    ) -> SolveReport:
        """Integrate from the place and speed given until `on_step` returns None or `longest_s` is over.

        `on_step` is called every `period_s`, a whole multiple of `step_s`; `plant` works after it where both are due.
        The coach starts at rest in its suspension, its wheels rolling. `newton`: iterate every step until its forces
        are in balance, at several times the cost, as a reference for the linearised steps. Exceptions of `on_step` end
        the run and are raised again here. Raises SolverFailure when the state stops being finite or the solver gives
        up.
        """
        exu = load_exudyn()
        record, q, v = start_state(
            self.parameters, self._contact, self._track, self._rail, initial_position_m, initial_speed_mps
        )
        container = exu.SystemContainer()  # owns the system: it must outlive the solve
        mbs = container.AddSystem()
        system = assemble(mbs, record, q, v)
        solver = exu.MainSolverImplicitSecondOrder()
        every = _steps_of(period_s, step_s)
        if plant is not None:
            record[0]["plant_every"] = _steps_of(plant.period_s, step_s)
            record[0]["plant_at"] = plant.function, plant.argument
        run = _Run(mbs, system, solver, record, self._track.table, self._rail, step_s, on_step, every, newton, plant)
        settings = solver_settings(exu, step_s, longest_s, newton)
        collecting = gc.isenabled()
        gc.disable()  # a callback makes no cycles, and the collector would look through everything again and again
        try:
            wall = time.perf_counter()
            reached = solver.SolveSystem(mbs, settings)
            wall = time.perf_counter() - wall
        finally:
            if collecting:
                gc.enable()
            run.let_go()
        run.raise_what_happened(bool(reached))
        return SolveReport(
            simulated_s=run.steps * step_s,
            wall_s=wall,
            step_s=step_s,
            exudyn_build=exu.config.Version(True),
            steps=run.steps,
            jacobians=int(record[0]["jacobians"]),
        )


def _steps_of(period_s: float, step_s: float) -> int:
    every = round(period_s / step_s)
    if every < 1 or abs(every * step_s - period_s) > 1e-9:
        raise ValueError(f"period_s = {period_s}: must be a whole multiple of step_s = {step_s}")
    return every


class _Run:
    """The callbacks of one solve and what they share."""

    def __init__(
        self,
        mbs: Any,
        system: int,
        solver: Any,
        record: np.ndarray,
        track: np.ndarray,
        rail: RailTables,
        step_s: float,
        on_step: OnStep,
        every: int,
        newton: bool,
        plant: Plant | None,
    ) -> None:
        self._mbs = mbs
        self._raised: BaseException | None = None
        self._lost: str | None = None
        self._step_s = step_s
        self._actuation: Actuation | None = None  # kept alive: the coach reads it by its address
        coordinates = int(record[0]["coordinates"])
        force = np.zeros(coordinates)
        self._response = room_for_response(coordinates)  # kept alive, like the actuation

        def takes_its_turn() -> bool:
            try:
                answer = on_step(float(coach["begin_s"]), state)
            except BaseException as error:  # nothing may pass through the solver's own code
                self._raised = error
                return False
            if answer is None:
                return False
            if answer is not self._actuation:
                self._actuation = answer
                coach["actuation_at"] = address_of(answer.numbers)
                coach["sanders_at"], coach["sander_count"] = address_of(answer.sanders), len(answer.sanders)
            return True

        def copes() -> bool:
            condition, t_s = int(coach["began"]), float(coach["begin_s"])
            if condition == REFUSED and plant is not None:
                try:
                    plant.refused(t_s, int(coach["plant_said"]))
                except BaseException as error:
                    self._raised = error
                return False
            if condition == LOST:
                self._lost = f"state, actuation or forces not finite at t = {t_s:.4f} s"
                return False
            convergence = solver.conv  # of a solver that iterates
            convergence.jacobianUpdateRequested = True
            solver.conv = convergence
            return True

        set_parameter = mbs.SetObjectParameter
        hand_over = system, "forceVector", force
        mbs.Assemble()
        q = mbs.systemData.GetODE2Coordinates(copy=False)
        v = mbs.systemData.GetODE2Coordinates_t(copy=False)
        a = mbs.systemData.GetODE2Coordinates_tt(copy=False)
        self._coach = coach = record[0]
        coach["solver_at"] = [address_of(array) for array in (q, v, a, force)]
        coach["response_at"], coach["iterates"] = address_of(self._response), newton
        coach["track_at"], coach["track_nodes"] = address_of(track), len(track)
        coach["step_s"], coach["steps_per_turn"] = step_s, every
        nothing: tuple[()] = ()
        self._called: tuple[Any, ...] = takes_its_turn, set_parameter, hand_over, copes, nothing  # kept alive
        coach["turn_at"], coach["copes_at"] = (id(takes_its_turn), id(nothing)), (id(copes), id(nothing))
        coach["hand_over_at"] = id(set_parameter), id(hand_over)
        state = CoachState(q, v, record)
        self._state = state
        coach_force(q, v, force, record, track, rail)
        set_parameter(*hand_over)
        mbs.SetPreStepUserFunction(pre_step(address_of(record)))

        if not newton:
            return

        jacobian = np.zeros((coordinates, coordinates))
        container = sys.modules["exudyn"].MatrixContainer

        def newton_jacobian(
            _mbs: Any, _t: float, _item: int, _q: np.ndarray, _v: np.ndarray, factor_q: float, factor_v: float
        ) -> Any:
            coach["jacobians"] += 1
            coach["regaining"] = 1.0  # secants: tangents beyond the peak would send iterations to and fro
            coach_jacobian(q, v, factor_q, factor_v, record, jacobian)
            sparse = container()
            sparse.SetWithDenseMatrix(jacobian, False)
            return sparse

        def pre_residual(_mbs: Any, _t: float, _iteration: int, _discontinuous: int) -> bool:
            coach_force(q, v, force, record, track, rail)
            set_parameter(*hand_over)
            return True

        set_parameter(system, "jacobianUserFunction", newton_jacobian)
        mbs.SetPreNewtonResidualUserFunction(pre_residual)

    def let_go(self) -> None:
        """The callbacks know the system and it knows them, where no collector looks: all would stay for ever."""
        self._mbs.SetPreStepUserFunction(0)
        self._mbs.SetPreNewtonResidualUserFunction(0)
        self._called = ()

    @property
    def steps(self) -> int:
        """How many have begun."""
        return int(self._coach["steps"])

    def raise_what_happened(self, reached: bool) -> None:
        """Raise what a callback raised, or SolverFailure when the integration broke off by itself."""
        if self._raised is not None:
            raise self._raised
        if self._lost is None and not reached:
            self._lost = f"the solver gave up after t = {self.steps * self._step_s:.4f} s"
        if self._lost is not None:
            raise SolverFailure(
                f"{self._lost}, at s = {self._state.position_m:.1f} m, with a step of {1000 * self._step_s:g} ms: "
                "a smaller simulation.step_s, or a track and coach without such kinks, may help"
            )
