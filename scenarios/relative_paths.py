"""Relative paths in a scenario file, or in a preset of the user's own, count from the folder of that file."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from scenarios.names import FOREIGN_SUFFIXES

Tree = dict[str, Any]
Change = Callable[[str], str]


def anchor_paths(tree: Tree, folder: Path) -> None:
    """Make the relative paths in the sections of `tree` absolute; names of what the program brings are left alone."""

    def anchored(path: str) -> str:
        try:
            return str((folder / path).resolve())
        except ValueError:  # a null character; whoever opens it says so
            return path

    change_paths(tree, anchored)


def change_paths(tree: Tree, change: Change) -> None:
    """Put `change(path)` in place of every path in the sections of `tree`; classes of a file are `file.py:Name`."""
    for section in ("coach", "brake", "imu"):
        _change(table_of(tree, section), "preset", change, _is_toml)
    wsp = table_of(tree, "wsp")
    _change(wsp, "controller", change, _is_controller_file)
    _change(wsp, "reference_estimator", change, _is_python)
    _change(table_of(wsp, "parameters"), "file", change)
    _change(table_of(tree, "creep_law"), "name", change, _is_python)
    profiles = table_of(table_of(table_of(tree, "coach"), "contact"), "profiles")
    for key in ("wheel_profile", "rail_profile"):
        _change(profiles, key, change, _is_profile_file)
    adhesion = table_of(tree, "adhesion")
    _change(adhesion, "rail_state_file", change)
    for rail in (*_entries(adhesion, "stretches"), *_entries(adhesion, "patches")):
        _change(rail, "file", change)
        _change(rail, "recovery", change, _is_toml)
    track = table_of(tree, "track")
    _change(track, "curves_file", change)
    _change(track, "gradients_file", change)
    _change(table_of(track, "irregularities"), "file", change)
    estimators = table_of(tree, "estimators")
    if isinstance(estimators.get("names"), list):
        estimators["names"] = [_changed(name, change, _is_python) for name in estimators["names"]]
    for name in [name for name in estimators if _is_python(name)]:
        estimators[_changed(name, change, _is_python)] = estimators.pop(name)


def table_of(tree: Tree, key: str) -> Tree:
    """The table that stands at `key`, or an empty one."""
    table = tree.get(key)
    return table if isinstance(table, dict) else {}


def _entries(tree: Tree, key: str) -> list[Tree]:
    """The tables of the array at `key`; `--set` addresses its entries by digits, as a table of tables."""
    value = tree.get(key)
    entries = list(value.values()) if isinstance(value, dict) else value
    return [entry for entry in entries if isinstance(entry, dict)] if isinstance(entries, list) else []


def _is_toml(text: str) -> bool:
    return text.endswith(".toml")


def _is_python(text: str) -> bool:
    return ".py:" in text


def _is_controller_file(text: str) -> bool:
    return _is_python(text) or text.endswith(FOREIGN_SUFFIXES)


def _is_profile_file(text: str) -> bool:
    """As `wheel_rail.profiles` tells a file from a name."""
    return Path(text).suffix != ""


def _change(table: Tree, key: str, change: Change, is_path: Callable[[str], bool] | None = None) -> None:
    if key in table:
        table[key] = _changed(table[key], change, is_path)


def _changed(value: Any, change: Change, is_path: Callable[[str], bool] | None) -> Any:
    """What comes of a path, anything else as it is; without `is_path` every text is a path."""
    if not isinstance(value, str) or not (is_path is None or is_path(value)):
        return value
    return change(value)
