"""Compiled code of the tests goes where the command's own goes: one folder per state of the sources."""

import importlib.util
import os
import time
from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import settings

from scenarios.compile_cache import use_compile_cache

use_compile_cache()

# how long an example takes is the machine's affair
settings.register_profile("railslide", deadline=None)
settings.load_profile("railslide")

EXAMPLES = Path(__file__).parents[1] / "docs" / "controllers"
MISBEHAVING = Path(__file__).parent / "wsp" / "misbehaving_controller.c"
BUILD_LIMIT_S = 300.0


def imported(file: Path) -> ModuleType:
    """A module from a file outside of any package."""
    spec = importlib.util.spec_from_file_location(file.stem, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def built_controllers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the examples of docs/controllers and a misbehaving one as C libraries and FMUs, all built here.

    Compiling takes longer than any test, so the workers of a parallel run share one build.
    """
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "controllers"
    try:
        folder.mkdir()
    except FileExistsError:
        give_up_s = time.monotonic() + BUILD_LIMIT_S
        while not (folder / "done").exists():
            assert time.monotonic() < give_up_s, "the other worker has not built the controllers"
            time.sleep(0.1)
        return folder
    try:
        _build(imported(EXAMPLES / "build.py"), folder)
    finally:
        (folder / "done").touch()
    return folder


def _build(build: ModuleType, folder: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        for name in ("ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR"):
            patch.setenv(name, str(folder / "zig"))
        source = EXAMPLES / "example_controller.c"
        build.library([source], folder / "example.so")
        build.fmu(2, source, "example2", folder)
        build.fmu(3, source, "example3", folder)
        build.library([MISBEHAVING], folder / "misbehaving.so")
        build.library([MISBEHAVING], folder / "another_version.so", "-DVERSION=7")
        build.fmu(2, MISBEHAVING, "misbehaving2", folder, {"deed": 0.0, "at_s": 0.0})
