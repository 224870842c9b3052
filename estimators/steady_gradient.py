"""Whether the pitch turns at all, while nothing but the gyroscope tells it.

A track's gradient is constant for most of its length, and the gyroscope's noise integrated over a long slide costs more
than anything else: 7.8e-4 rad/s at 10 Hz make 1.7 mrad, that is 1.7 per mille, in 50 s. So the pitch is held while the
angle that the gyroscope turned is no more than its noise, over a short window (a vertical curve of 10 km radius at
90 km/h has ten times its noise in 1 s) and over a long one. When it is more, the held angle is put back: nothing that
is noticed is lost. What goes unnoticed is below 4.5 times the noise of the long window, 2.5 mrad.
"""

import math
from collections import deque

_SHORT_S, _SHORT_SIGMAS = 1.0, 5.0
_LONG_S, _LONG_SIGMAS = 5.0, 4.5
_QUIET_S = 2.0  # of a rate within the short window's noise, before the pitch is held again


class SteadyGradient:
    """Decides, tick by tick, between holding and turning."""

    def __init__(self, period_s: float, rate_sd_radps: float) -> None:
        self._period_s = period_s
        self._turn_sd_rad = rate_sd_radps * period_s
        self._short = max(round(_SHORT_S / period_s), 1)
        self._quiet = max(round(_QUIET_S / period_s), 1)
        self._turned: deque[float] = deque(maxlen=max(round(_LONG_S / period_s), 1))
        self.restart()

    def restart(self) -> None:
        """Begin with the pitch held and nothing turned."""
        self.holds = True
        self._quiet_ticks = 0
        self._turned.clear()

    def step(self, pitch_rate_radps: float) -> float:
        """Take in the gyroscope's pitch rate of a tick; the angle to put back (0 unless turning begins here)."""
        self._turned.append(pitch_rate_radps * self._period_s)
        recent = list(self._turned)[-self._short :]
        turns = abs(sum(recent)) > _SHORT_SIGMAS * self._turn_sd_rad * math.sqrt(len(recent))
        if self.holds:
            whole = sum(self._turned)
            if turns or abs(whole) > _LONG_SIGMAS * self._turn_sd_rad * math.sqrt(len(self._turned)):
                self.holds = False
                self._quiet_ticks = 0
                return whole
        else:
            self._quiet_ticks = 0 if turns else self._quiet_ticks + 1
            if self._quiet_ticks >= self._quiet:
                self.restart()
        return 0.0
