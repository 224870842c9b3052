"""Whether the wheel may be trusted: agreement asked for over consecutive ticks, distrust at once."""


class Confirmation:
    """Counts consecutive ticks of agreement."""

    def __init__(self, period_s: float, confirmation_s: float) -> None:
        self._wanted = max(round(confirmation_s / period_s), 1)
        self._count = 0

    def restart(self) -> None:
        """Forget what was counted."""
        self._count = 0

    def agreed(self, agrees: bool) -> bool:
        """Take in one tick; True once agreement has lasted."""
        self._count = self._count + 1 if agrees else 0
        return self._count >= self._wanted
