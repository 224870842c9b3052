"""WSP controllers by name; see wsp.controllers.interface for what one is."""

from wsp.controllers.interface import Controller, ControllerOutput
from wsp.controllers.none import NoProtection
from wsp.controllers.replay import Replay
from wsp.controllers.rule_table import RuleTable

CONTROLLERS: dict[str, type] = {"none": NoProtection, "rule-table": RuleTable, "replay": Replay}

__all__ = ["CONTROLLERS", "Controller", "ControllerOutput", "NoProtection", "Replay", "RuleTable"]
