"""Somebody outside of the program in the place of the scenario's controller: what he sees and what he is asked."""

from typing import Protocol

from sensors import Tachometers
from vehicle import CoachState
from wsp import Brake, ControllerOutput


class View:
    """What somebody outside sees of a run at a tick, the driver's part included.

    `demand` (0..1) and `traction_n` (whole coach) are as the driver has them in force; writing them overrules him until
    he acts again.
    """

    def __init__(self, tachometers: Tachometers, brake: Brake) -> None:
        self.tachometers = tachometers
        self.brake = brake
        self.state: CoachState
        self.demand = 0.0
        self.traction_n = 0.0


class Outside(Protocol):
    """Whoever works the valves from outside of the program, tick by tick."""

    def tick(self, t_s: float, view: View) -> ControllerOutput | None:
        """What is in force from t_s to the next tick; None ends the run, which a standstill then does not."""
