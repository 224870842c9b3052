"""`slip-tracking`: the slip speed of every axle is led to a set-point that stays as it is."""

from typing import Annotated, Any

from pydantic import Field

from wsp.compiled import Record
from wsp.controllers.compiled_controller import CompiledController
from wsp.controllers.interface import AXLES
from wsp.controllers.requests import request
from wsp.controllers.slip_law import command_slips, observe_adhesion, slip_law_constants, slip_law_state
from wsp.controllers.slip_law_parameters import SlipLawControllerParameters
from wsp.controllers.supervision import known_reference
from wsp.controllers.supervision_parameters import Size

Slip = Annotated[float, Field(ge=0.0, le=0.3)]


class SlipTrackingParameters(SlipLawControllerParameters):
    """Set-point of slip speed = offset + share * reference speed, an axle each for the share."""

    slip_offset_mps: Size = Field(default=0.1, description="what the tachometers' noise asks for")
    slip_share: tuple[Slip, Slip, Slip, Slip] = Field(
        default=(0.008, 0.008, 0.008, 0.008),
        description="axles 1..4; just beyond the peak of Polach's curves, 0.15 for rails with a flat curve",
    )


def _tick(record: Record, t_s: float) -> int:
    """One tick, see wsp.controllers.compiled_controller."""
    s, c, inputs, output = record.state, record.constants, record.inputs, record.output
    at_work = observe_adhesion(s, c, inputs)
    for axle in range(AXLES):
        s.slip_set_mps[axle] = c.slip_offset_mps + c.slip_share[axle] * s.reference_mps
    command_slips(s, c, output.valve, at_work)
    output.reference_speed_mps = known_reference(s)
    request(s, c, output, at_work)
    return 0


class SlipTracking(CompiledController):
    """Slip set-point approached on a sliding line, valve pulses to measure, their dead time predicted.

    Needs no pressure sensor. An axle whose speed is not known gets a share of what the other one of its bogie gets.
    """

    Parameters = SlipTrackingParameters
    _tick = staticmethod(_tick)

    def _own_constants(self, p: SlipTrackingParameters) -> dict[str, Any]:
        return {
            "slip_offset_mps": p.slip_offset_mps,
            "slip_share": p.slip_share,
            **slip_law_constants(p, self.period_s),
        }

    def _own_state(self) -> dict[str, Any]:
        return slip_law_state()
