"""What can go wrong with a run, as types: bad input, a failed solve, an interruption."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with the input: where it stands, which key, and what is allowed."""

    source: str
    key: str
    message: str

    def __str__(self) -> str:
        return ": ".join(part for part in (self.source, self.key, self.message) if part)


class BadInput(ValueError):
    """The input cannot be used; `faults` holds everything that was found, not just the first."""

    def __init__(self, *faults: Fault) -> None:
        self.faults = faults
        super().__init__("\n".join(map(str, faults)))


class SolveFailed(RuntimeError):
    """The solver or a foreign controller gave up: the message says when and why; `partial` is the truth until then."""

    def __init__(self, message: str, partial: object | None = None) -> None:
        super().__init__(message)
        self.partial = partial


class RunFailed(RuntimeError):
    """A run broke down; `folder` holds what it had, None if not even that could be kept."""

    def __init__(self, message: str, folder: Path | None) -> None:
        super().__init__(message)
        self.folder = folder


class RunInterrupted(Exception):
    """The user asked to stop; nothing is left of the run."""
