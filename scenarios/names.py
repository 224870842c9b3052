"""The one resolver of names: controllers, estimators and presets of all packages, and a user's own from a file.

Each package exports plain tables (name -> class, or name -> file of a preset). `path/to/file.py:Name` gives a class of
the user's own, `path/to/file.toml` a preset of the user's own; a controller may also be a C shared library or an FMU.
"""

import difflib
import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from pydantic import BaseModel

LIBRARY = Path(__file__).parent / "library"

FOREIGN_SUFFIXES = (".so", ".dylib", ".dll", ".fmu")
"""Files that may serve as a controller without being Python."""


class UnknownName(ValueError):
    """No entry of that name; the message tells the nearest ones."""


def _controllers() -> Mapping[str, Any]:
    from wsp import CONTROLLERS

    return CONTROLLERS


def _estimators() -> Mapping[str, Any]:
    from estimators import ESTIMATORS

    return ESTIMATORS


def _coach_presets() -> Mapping[str, Any]:
    from vehicle import COACH_PRESETS

    return COACH_PRESETS


def _brake_presets() -> Mapping[str, Any]:
    from wsp import BRAKE_PRESETS

    return BRAKE_PRESETS


def _imu_presets() -> Mapping[str, Any]:
    from sensors import IMU_PRESETS

    return IMU_PRESETS


def _creep_laws() -> Mapping[str, Any]:
    from wheel_rail.creep_laws import CREEP_LAWS

    return CREEP_LAWS


def _wheel_profiles() -> Mapping[str, Any]:
    from wheel_rail.profiles import WHEEL_PROFILES

    return WHEEL_PROFILES


def _rail_profiles() -> Mapping[str, Any]:
    from wheel_rail.profiles import RAIL_PROFILES

    return RAIL_PROFILES


def _recovery_presets() -> Mapping[str, Any]:
    from wheel_rail.recovery_parameters import RECOVERY_PRESETS

    return RECOVERY_PRESETS


def _scenarios() -> Mapping[str, Any]:
    return {path.stem: path for path in sorted(LIBRARY.glob("*.toml"))}


TABLES: dict[str, Callable[[], Mapping[str, Any]]] = {
    "scenario": _scenarios,
    "controller": _controllers,
    "estimator": _estimators,
    "coach preset": _coach_presets,
    "brake preset": _brake_presets,
    "IMU preset": _imu_presets,
    "creep law": _creep_laws,
    "wheel profile": _wheel_profiles,
    "rail profile": _rail_profiles,
    "recovery preset": _recovery_presets,
}
"""Kind -> its table, read on demand: reading one imports its package."""


def nearest(word: str, words: Iterable[str]) -> list[str]:
    """Up to three entries of `words` that a misspelt `word` may have meant, best first."""
    by_lower = {candidate.lower(): candidate for candidate in words}
    return [by_lower[match] for match in difflib.get_close_matches(word.lower(), by_lower, n=3, cutoff=0.5)]


def unknown(kind: str, name: str, table: Iterable[str]) -> UnknownName:
    """The refusal of `name`, with its nearest neighbours and all that there is."""
    known = list(table)
    best = nearest(name, known)
    hint = f", best matches are {', '.join(best)}" if len(best) > 1 else f", best match is {best[0]}" if best else ""
    return UnknownName(f"{kind} {name!r} not found{hint} (there are: {', '.join(known)})")


def find_class(kind: str, name: str) -> Any:
    """The class called `name` among the controllers or estimators, or the one in the user's `path/to/file.py:Name`.

    A controller that is a C shared library or an FMU gets a class of its own, which reads the file when instantiated.
    """
    if ".py:" in name:
        return _class_from_file(kind, name)
    if kind == "controller" and name.endswith(FOREIGN_SUFFIXES):
        return _foreign_class(name)
    table = TABLES[kind]()
    if name not in table:
        raise unknown(kind, name, table)
    return table[name]


def find_file(kind: str, name: str) -> Path:
    """The TOML file of the preset or scenario called `name`, or the user's own if `name` ends in .toml."""
    if name.endswith(".toml"):
        return Path(name)
    table = TABLES[kind]()
    if name not in table:
        raise unknown(kind, name, table)
    return Path(table[name])


def display_name(name: str) -> str:
    """A short name for tables and file names: `path/to/file.py:Name` is shown as `Name`, `path/to/x.fmu` as `x`."""
    return Path(name).stem if name.endswith(FOREIGN_SUFFIXES) else name.rpartition(".py:")[2]


def find_creep_law(name: str) -> Any:
    """The creep law called `name`, or the one made of the user's function `path/to/file.py:name`."""
    if ".py:" not in name:
        table = _creep_laws()
        if name not in table:
            raise unknown("creep law", name, table)
        return table[name]
    from wheel_rail.creep_laws import user_creep_law
    from wheel_rail.user_law import UnusableLaw

    module, function_name = _module_of("creep law", name)
    found = getattr(module, function_name, None)
    if not callable(found):
        functions = [key for key, value in vars(module).items() if inspect.isfunction(value)]
        raise unknown(f"creep law in {module.__file__}", function_name, functions)
    try:
        return user_creep_law(found, function_name)
    except UnusableLaw as error:
        raise UnknownName(f"creep law {name!r}: {error}") from None


def _module_of(kind: str, name: str) -> tuple[ModuleType, str]:
    """The module of the user's `path/to/file.py:Name`, imported once, and the name in it."""
    file_name, _, name_inside = name.rpartition(":")
    path = Path(file_name)
    if not path.is_file():
        raise UnknownName(f"{kind} {name!r} not found: there is no file {file_name}")
    module_name = f"railslide_user_{path.stem}_{_digest(path)}"
    module = sys.modules.get(module_name)
    if module is None:
        spec = importlib.util.spec_from_file_location(module_name, path)
        if spec is None or spec.loader is None:
            raise UnknownName(f"{kind} {name!r}: {file_name} cannot be imported")
        module = importlib.util.module_from_spec(spec)
        sys.modules[module_name] = module  # dataclasses and pickling look the module up by name
        try:
            spec.loader.exec_module(module)
        except Exception as error:
            del sys.modules[module_name]
            raise UnknownName(
                f"{kind} {name!r}: importing {file_name} failed with {type(error).__name__}: {error}"
            ) from error
    return module, name_inside


def _foreign_class(name: str) -> Any:
    from wsp.foreign.controller import foreign_controller

    path = Path(name)
    if not path.is_file():
        raise UnknownName(
            f"controller {name!r} not found: {'is a folder' if path.is_dir() else 'there is no such file'}"
        )
    return foreign_controller(path)


def _digest(path: Path) -> str:
    """The same in every process, so that what one has pickled another finds."""
    return hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:16]


def _class_from_file(kind: str, name: str) -> Any:
    """The class in the user's file, which must carry a pydantic model `Parameters` and a `step`."""
    module, class_name = _module_of(kind, name)
    found = getattr(module, class_name, None)
    if not isinstance(found, type):
        classes = [key for key, value in vars(module).items() if isinstance(value, type)]
        raise unknown(f"{kind} in {module.__file__}", class_name, classes)
    parameters = getattr(found, "Parameters", None)
    if not (isinstance(parameters, type) and issubclass(parameters, BaseModel)):
        raise UnknownName(f"{kind} {name!r} needs a nested pydantic model called Parameters")
    for method in ("reset", "step"):
        if not callable(getattr(found, method, None)):
            raise UnknownName(f"{kind} {name!r} needs a method called {method}")
    return found
