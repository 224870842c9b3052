"""The coach: parameters and presets, suspension and forces, the Exudyn system, modes.

Conventions: coach frame x forward, y left, z up, pitch positive nose down; wheelsets 1..4 from the front; a brake's
torque is a capacity >= 0, a drive torque is positive forwards. SI units; forces act on the body named.
"""

from vehicle.coach import Coach, SolveReport, SolverFailure
from vehicle.interface import Actuation, CoachState, Plant
from vehicle.observation import OBSERVATION, POWERS
from vehicle.parameters import COACH_PRESETS, GRAVITY_MPS2, CoachParameters

__all__ = [
    "COACH_PRESETS",
    "GRAVITY_MPS2",
    "OBSERVATION",
    "POWERS",
    "Actuation",
    "Coach",
    "CoachParameters",
    "CoachState",
    "Plant",
    "SolveReport",
    "SolverFailure",
]
