"""Units in which people are told of what the program knows in SI."""

from typing import Final

KMH_PER_MPS: Final = 3.6
"""Kilometres per hour that make one metre per second."""
