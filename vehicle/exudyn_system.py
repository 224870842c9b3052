"""What the coach is to Exudyn: its one node and object, and the settings of the solver."""

import contextlib
import io
import sys
from types import ModuleType
from typing import Any

import numpy as np

from vehicle.implicit import SPECTRAL_RADIUS
from vehicle.layout import masses


def load_exudyn() -> ModuleType:
    """Import Exudyn's build without range checks (a quarter faster; SolveReport tells which build ran)."""
    sys.exudynFast = True  # type: ignore[attr-defined]
    with contextlib.redirect_stdout(io.StringIO()):
        import exudyn
    exudyn.config.printToConsole = False
    return exudyn


def assemble(mbs: Any, record: np.ndarray, q: np.ndarray, v: np.ndarray) -> int:
    """Add one node of all coordinates, at q, v, and one object with all masses and forces; returns its number.

    The mass matrix is diagonal and constant: velocities are those of the bodies' own axes, and what remains of a rigid
    body, omega x J omega, is among the compiled forces. A node and an object for each body, and Exudyn's Lie-group
    nodes, say the same (`vehicle.layout`) at three times the cost of a step.
    """
    from exudyn.itemInterface import NodeGenericODE2, ObjectGenericODE2

    coach = record[0]
    node = mbs.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * len(q),
            initialCoordinates=[*q],
            initialCoordinates_t=[*v],
            numberOfODE2Coordinates=len(q),
        )
    )
    number: int = mbs.AddObject(
        ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag(masses(coach)), forceVector=np.zeros(len(q)))
    )
    return number


def solver_settings(exu: ModuleType, step_s: float, longest_s: float, newton: bool = False) -> Any:
    """Settings of Exudyn's implicit solver for linearised steps.

    With `newton` each step is iterated until the forces are in balance to a tenth of a newton, or to 1e-5 of what they
    lacked at first.
    """
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps = max(1, round(longest_s / step_s))
    integration.endTime = integration.numberOfSteps * step_s
    integration.generalizedAlpha.spectralRadius = SPECTRAL_RADIUS
    integration.adaptiveStep = False
    integration.verboseMode = 0
    integration.stepInformation = 0
    integration.newton.active = newton
    integration.newton.useModifiedNewton = True
    if newton:
        integration.newton.relativeTolerance = 1e-5
        integration.newton.absoluteTolerance = 0.1
        # the Jacobian is approximate: iterations go on while they come nearer at all; else it is renewed
        integration.newton.modifiedNewtonContractivity = 0.9
        integration.newton.maxModifiedNewtonIterations = 25
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.parallel.numberOfThreads = 1
    settings.solution.file.write = False
    settings.solution.sensors.active = False
    return settings
