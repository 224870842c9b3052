"""What can be wrong with a controller that the user brought along."""


class UnusableController(ValueError):
    """It cannot be started; the message begins with the key under [wsp] that is to blame."""


class ControllerFailed(RuntimeError):
    """It broke down during the run: crashed, hung, gave nonsense, or reported an error of its own."""
