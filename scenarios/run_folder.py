"""The folder of a run: written under a hidden name beside its place and renamed when whole.

A killed run leaves no half run, a failed one leaves `<name>.failed/`. An older run of the same name is replaced, and
only that: a folder that is not a run, or that holds files which no run writes, is refused before anything is computed.
"""

import json
import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from scenarios.errors import BadInput, Fault

PROGRAM = "railslide"


@dataclass(frozen=True)
class Contents:
    """What a command writes at the top of its folder: all `entries`, which `record` names the program, what to call it.

    `folders` are made at once.
    """

    entries: frozenset[str]
    record: str
    name: str
    folders: tuple[str, ...] = ()


RUN = Contents(
    frozenset(
        {
            "scenario.toml",
            "provenance.json",
            "metrics.json",
            "failure.txt",
            "truth.parquet",
            "wheelsets.parquet",
            "brake.parquet",
            "rail.parquet",
            "readings",
            "estimates",
            "figures",
        }
    ),
    "provenance.json",
    "run",
    ("readings", "estimates"),
)


class RunFolder:
    """Context of one command's output, a run's as a rule: write into `path`, then `publish` or `publish_failed`.

    Leaving the context without either (an error, Ctrl-C) removes everything that was written, the parent folders that
    were made for it included. Raises BadInput on entry if the folder cannot be written or must not be replaced.
    """

    def __init__(self, parent: Path, name: str, contents: Contents = RUN) -> None:
        self._contents = contents
        self.final = parent / name
        self.failed = parent / f"{name}.failed"
        self.path = parent / f".{name}.{os.getpid()}.partial"
        self._made: list[Path] = []

    def __enter__(self) -> Self:
        for place in (self.final, self.failed):
            refusal = why_not_replaceable(place, self._contents)
            if refusal:
                raise BadInput(Fault("--out", str(place), refusal))
        try:
            missing = [folder for folder in (self.path.parent, *self.path.parent.parents) if not folder.exists()]
            for folder in reversed(missing):
                self._made.append(folder)
                folder.mkdir()
            remove(self.path)
            self.path.mkdir()
            for folder_name in self._contents.folders:
                (self.path / folder_name).mkdir()
        except OSError as error:
            self._leave_nothing()
            raise BadInput(Fault("--out", str(self.path.parent), f"cannot be written: {error.strerror}")) from None
        except BaseException:  # Ctrl-C may come here as well, and then __exit__ is not called
            self._leave_nothing()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._leave_nothing()

    def publish(self) -> Path:
        """Give the whole run its name, in place of an older run; an older failure of that name is gone with it."""
        _replace(self.path, self.final)
        remove(self.failed)
        return self.final

    def publish_failed(self, reason: str) -> Path:
        """Keep what there is as `<name>.failed/`, with the reason in failure.txt."""
        (self.path / "failure.txt").write_text(reason.rstrip() + "\n", encoding="utf-8")
        _replace(self.path, self.failed)
        return self.failed

    def write_json(self, name: str, content: Mapping[str, Any]) -> None:
        text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
        (self.path / name).write_text(text + "\n", encoding="utf-8")

    def _leave_nothing(self) -> None:
        remove(self.path)
        for folder in reversed(self._made):
            try:
                folder.rmdir()
            except OSError:  # it holds the published run, or something of somebody else
                break


def why_not_replaceable(place: Path, contents: Contents) -> str:
    """Empty if nothing stands at `place` or an older folder of these contents; otherwise why it must be left alone."""
    alien = f"exists and is not a {contents.name} folder: choose another --out or scenario.name"
    if not os.path.lexists(place):
        return ""
    if place.is_symlink() or not place.is_dir():
        return alien
    strangers = sorted(entry.name for entry in place.iterdir() if entry.name not in contents.entries)
    if strangers:
        named = ", ".join(strangers[:3])
        return f"exists and holds what no {contents.name} wrote ({named}): move that or choose another --out"
    try:
        program = json.loads((place / contents.record).read_text(encoding="utf-8"))["program"]
    except (OSError, ValueError, KeyError, TypeError):
        program = None
    return "" if program == PROGRAM else alien


def remove(folder: Path) -> None:
    """Remove a folder of ours, if it is there."""
    if folder.is_dir() and not folder.is_symlink():
        shutil.rmtree(folder)


def _replace(new: Path, place: Path) -> None:
    old = new.with_suffix(".replaced")
    remove(old)
    if place.exists():
        place.rename(old)
    try:
        new.rename(place)
    except OSError:
        if old.exists():
            old.rename(place)
        raise
    remove(old)
