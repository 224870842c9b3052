"""Estimators: readings in, speed, position, orientation and gradient with bounds out. They never see truth.

Conventions
    Frames: carbody x forward, y left, z up; R_bs turns the IMU's components into the carbody's as the train believes.
    Specific force f = a - g. Pitch positive nose down, gradient positive uphill: gradient = -1000 tan(pitch) per mille.
    Speeds along the track positive forward; `direction` is that of the active cab.
    Samples come at a fixed period, first at t = period; means over (t - period, t], speeds at t.
    Bounds: of the Kalman filters `bound_sigmas` standard deviations from their own covariance, of `scmt` its own rule.
    "sound" and "printed" name the right form of an equation and the one that its source prints.
"""

from estimators.ins_odo import InsOdo
from estimators.ins_odo_parameters import InsOdoParameters
from estimators.interface import Estimate, EstimateStream, Estimator, Initial, Sample
from estimators.onboard import samples
from estimators.orientation import Orientation
from estimators.orientation_filter import OrientationParameters
from estimators.scmt import Scmt, ScmtParameters

ESTIMATORS: dict[str, type] = {"scmt": Scmt, "orientation": Orientation, "ins-odo": InsOdo}

__all__ = [
    "ESTIMATORS",
    "Estimate",
    "EstimateStream",
    "Estimator",
    "InsOdo",
    "InsOdoParameters",
    "Initial",
    "Orientation",
    "OrientationParameters",
    "Sample",
    "Scmt",
    "ScmtParameters",
    "samples",
]
