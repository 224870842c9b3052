"""WSP controllers by name; see wsp.controllers.interface for what one is."""

from wsp.controllers.adaptive import Adaptive
from wsp.controllers.interface import Controller, ControllerOutput
from wsp.controllers.none import NoProtection
from wsp.controllers.replay import Replay
from wsp.controllers.rule_table import RuleTable
from wsp.controllers.slip_tracking import SlipTracking

CONTROLLERS: dict[str, type] = {
    "none": NoProtection,
    "rule-table": RuleTable,
    "slip-tracking": SlipTracking,
    "adaptive": Adaptive,
    "replay": Replay,
}

__all__ = [
    "CONTROLLERS",
    "Adaptive",
    "Controller",
    "ControllerOutput",
    "NoProtection",
    "Replay",
    "RuleTable",
    "SlipTracking",
]
