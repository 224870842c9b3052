"""Track and rail, wheel-rail contact, creep laws and adhesion.

Conventions: s along the centreline at top of rail; y left, z up; curvature positive to the left; cant positive with
the right rail raised; gradient positive uphill. Creepage = sliding velocity of the wheel's material over the rail, over
max(|v|, |omega r|); longitudinal creepage is positive for a braked wheel, whose force on the wheel is negative.
SI units throughout; compiled functions take world vectors of three components.
"""

from wheel_rail.adhesion import REFERENCE_LOAD_N, REFERENCE_SPEED_MPS, Adhesion, AdhesionParameters
from wheel_rail.adhesion_state import RailState
from wheel_rail.contact_parameters import ContactParameters
from wheel_rail.contact_table import CONTACT, Contact
from wheel_rail.irregularities import Irregularities
from wheel_rail.polach import SURFACES
from wheel_rail.track import Track
from wheel_rail.track_parameters import TrackParameters

__all__ = [
    "CONTACT",
    "REFERENCE_LOAD_N",
    "REFERENCE_SPEED_MPS",
    "SURFACES",
    "Adhesion",
    "AdhesionParameters",
    "Contact",
    "ContactParameters",
    "Irregularities",
    "RailState",
    "Track",
    "TrackParameters",
]
