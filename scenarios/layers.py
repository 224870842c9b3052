"""Reading TOML and laying one file over another: `extends`, presets and `--set`, with the origin of every key.

Tables are merged key by key; any other value, an array included, replaces what was there. Two choices start their table
afresh when they change, because what stood there belongs to the old choice: `preset` in a section, and the
`controller` or the creep law's `name`, which drop the `parameters` beside them.
"""

import tomllib
from collections.abc import Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scenarios.errors import BadInput, Fault
from scenarios.names import UnknownName, find_file
from scenarios.relative_paths import anchor_paths

PRESET_KINDS = {"coach": "coach preset", "brake": "brake preset", "imu": "IMU preset"}
"""Section -> the kind of preset that its key `preset` names."""

Key = tuple[str, ...]
Tree = dict[str, Any]


@dataclass
class Layer:
    """One source of settings: a file or the command line. Relative paths in it count from `folder`."""

    tree: Tree
    source: str
    folder: Path


@dataclass
class Merged:
    """Layers laid over each other, and which source set which key.

    `presets`: section -> the preset it is built on; `without_preset`: sections whose preset could not be had.
    """

    tree: Tree = field(default_factory=dict)
    origins: dict[Key, str] = field(default_factory=dict)
    presets: dict[str, str] = field(default_factory=dict)
    without_preset: set[str] = field(default_factory=set)

    def origin(self, key: Sequence[str | int]) -> str:
        """The source that set `key` or the nearest table above it."""
        path = tuple(map(str, key))
        for end in range(len(path), -1, -1):
            if path[:end] in self.origins:
                return self.origins[path[:end]]
        return ""

    def add(self, layer: Layer) -> None:
        """Lay `layer` over what is there."""
        for section in PRESET_KINDS:
            before, after = self._choice(section, "preset"), _choice(layer.tree, section, "preset")
            if after is not None and before is not None and after != before:
                del self.tree[section]
        for section, key in (("wsp", "controller"), ("creep_law", "name")):
            after = _choice(layer.tree, section, key)
            if after is not None and after != self._choice(section, key) and isinstance(self.tree.get(section), dict):
                self.tree[section].pop("parameters", None)
                self.origins[(section, "parameters")] = layer.source  # what lacks there, lacks in this layer
        self._merge(self.tree, layer.tree, layer.source, ())

    def expand_presets(self) -> list[Fault]:
        """Put every named preset under the keys that the scenario gives itself."""
        faults = []
        for section, kind in PRESET_KINDS.items():
            name = self._choice(section, "preset")
            if name is None:
                continue
            key = f"{section}.preset"
            try:
                if not isinstance(name, str):
                    raise UnknownName(f"must be the name of a {kind} or a path to a .toml file, not {name!r}")
                file = find_file(kind, name)
                preset = read_toml(file)
            except UnknownName as error:
                faults.append(Fault(self.origin((section, "preset")), key, str(error)))
                self.without_preset.add(section)
                continue
            except BadInput as error:
                faults.extend(error.faults)
                self.without_preset.add(section)
                continue
            anchor_paths({section: preset}, file.parent)
            own = self.tree[section]
            del own["preset"]
            origins = {path: source for path, source in self.origins.items() if path[:1] == (section,)}
            self.tree[section] = preset
            self.origins = {path: source for path, source in self.origins.items() if path not in origins}
            self.origins[(section,)] = f"{kind} {name}"
            for path, value in _leaves(own, (section,)):
                self._put(path, value, _longest(origins, path))
            self.presets[section] = name
        return faults

    def _choice(self, section: str, key: str) -> Any:
        return _choice(self.tree, section, key)

    def _put(self, path: Key, value: Any, source: str) -> None:
        branch: Any = value
        for name in reversed(path):
            branch = {name: branch}
        self._merge(self.tree, branch, source, ())

    def _merge(self, base: Tree, over: Tree, source: str, path: Key) -> None:
        for name, value in over.items():
            here = (*path, name)
            old = base.get(name)
            if isinstance(value, dict) and isinstance(old, dict):
                self._merge(old, value, source, here)
            elif isinstance(value, dict) and isinstance(old, list) and value and all(key.isdigit() for key in value):
                self._merge_entries(old, value, source, here)
            else:
                base[name] = deepcopy(value)
                self.origins = {key: was for key, was in self.origins.items() if key[: len(here)] != here}
                self.origins[here] = source

    def _merge_entries(self, entries: list[Any], over: Tree, source: str, path: Key) -> None:
        """`--set track.curves.0.radius_m=900`: digits address the entries of an array, counted from 0."""
        for digits, value in over.items():
            index = int(digits)
            if index >= len(entries):
                where = ".".join((*path, digits))
                raise BadInput(Fault(source, where, f"there are {len(entries)} entries, counted from 0"))
            holder = {digits: entries[index]}
            self._merge(holder, {digits: value}, source, path)
            entries[index] = holder[digits]


def read_toml(path: Path) -> Tree:
    """The tables of a TOML file; BadInput says what is wrong with the file itself."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise BadInput(Fault(str(path), "", "there is no such file")) from None
    except IsADirectoryError:
        raise BadInput(Fault(str(path), "", "is a folder, a TOML file is wanted")) from None
    except UnicodeDecodeError as error:
        message = f"is not UTF-8 text (byte 0x{error.object[error.start]:02x} at offset {error.start})"
        raise BadInput(Fault(str(path), "", message)) from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        raise BadInput(Fault(str(path), "", f"cannot be read: {getattr(error, 'strerror', None) or error}")) from None
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise BadInput(Fault(str(path), "", f"is not valid TOML: {error}")) from None


LISTS = ("faults",)
"""Sections that are no tables but arrays of them: their key is the section itself."""


def parse_setting(setting: str) -> Tree:
    """`section.key=value` from the command line as a tree; the value is TOML, or text where it is not TOML."""
    key, equals, text = setting.partition("=")
    if not equals:
        raise BadInput(Fault("--set", setting, "must read section.key=value"))
    try:
        tree = tomllib.loads(f"{key.strip()} = 0")
        path = tuple(_path_of_only_leaf(tree))
    except (tomllib.TOMLDecodeError, ValueError):
        raise BadInput(Fault("--set", setting, f"{key!r} is not a key, it must read section.key=value")) from None
    if len(path) < 2 and path[0] not in LISTS:
        raise BadInput(Fault("--set", setting, "the key must begin with its section, as in simulation.step_s=0.001"))
    try:
        parsed = tomllib.loads(f"value = {text.strip()}")
        value = parsed["value"] if len(parsed) == 1 else text
    except (tomllib.TOMLDecodeError, RecursionError):
        value = text
    branch: Any = value
    for name in reversed(path):
        branch = {name: branch}
    return branch


def _path_of_only_leaf(tree: Tree) -> Iterator[str]:
    branch: Any = tree
    while isinstance(branch, dict):
        (name,) = branch  # ValueError where a line break smuggles in a second key
        yield name
        branch = branch[name]


def _leaves(tree: Tree, path: Key) -> Iterator[tuple[Key, Any]]:
    for name, value in tree.items():
        if isinstance(value, dict) and value:
            yield from _leaves(value, (*path, name))
        else:
            yield (*path, name), value


def _longest(origins: dict[Key, str], path: Key) -> str:
    for end in range(len(path), 0, -1):
        if path[:end] in origins:
            return origins[path[:end]]
    return ""


def _choice(tree: Tree, section: str, key: str) -> Any:
    table = tree.get(section)
    return table.get(key) if isinstance(table, dict) else None
