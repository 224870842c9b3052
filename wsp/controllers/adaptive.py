"""`adaptive`: the slip law of `slip-tracking`, its set-points searched for while braking."""

from typing import Any

from wsp.compiled import Record
from wsp.controllers.compiled_controller import CompiledController
from wsp.controllers.requests import request
from wsp.controllers.slip_law import command_slips, observe_adhesion, slip_law_constants, slip_law_state
from wsp.controllers.slip_law_parameters import SlipLawControllerParameters
from wsp.controllers.slip_search import search_slips, slip_search_constants, slip_search_state
from wsp.controllers.slip_search_parameters import SlipSearchParameters
from wsp.controllers.supervision import known_reference


class AdaptiveParameters(SlipLawControllerParameters):
    """Slip law and search."""

    search: SlipSearchParameters = SlipSearchParameters()


def _tick(record: Record, t_s: float) -> int:
    """One tick, see wsp.controllers.compiled_controller."""
    s, c, inputs, output = record.state, record.constants, record.inputs, record.output
    at_work = observe_adhesion(s, c, inputs)
    search_slips(s, c, at_work, inputs.direction)
    command_slips(s, c, output.valve, at_work)
    output.reference_speed_mps = known_reference(s)
    request(s, c, output, at_work)
    return 0


class Adaptive(CompiledController):
    """Seeks the slip that brakes best for each axle while it brakes, leading axles cleaning the rail if that pays.

    Needs no pressure sensor. With an axle whose speed is not known all others stay at the lowest slip level, and it
    gets a share of what the other one of its bogie gets.
    """

    Parameters = AdaptiveParameters
    _tick = staticmethod(_tick)

    def _own_constants(self, p: AdaptiveParameters) -> dict[str, Any]:
        return {**slip_search_constants(p.search, self.period_s), **slip_law_constants(p, self.period_s)}

    def _own_state(self) -> dict[str, Any]:
        return {**slip_search_state(self.parameters.search, self.period_s), **slip_law_state()}
