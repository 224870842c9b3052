"""The FMU's shared library: compiled from `native/` by the C compiler that comes with the package ziglang.

It is built for 64-bit Linux alone, wherever the export runs: starting and ending the Python process has been written
for Linux and tried there only.
"""

import hashlib
import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

from scenarios.coach_fmu.variables import SET, VARIABLES, interface_digest
from scenarios.compile_cache import user_cache_folder
from scenarios.errors import BadInput, Fault
from scenarios.schema import TICK_S

NATIVE = Path(__file__).parent / "native"
TARGET = "x86_64-linux-gnu.2.17"
"""With the oldest C library that it shall run on."""
FLAGS = ("-shared", "-fPIC", "-O2", "-std=gnu11", "-Wall", "-Wextra", "-Werror", "-fvisibility=hidden", "-s")


def shared_library() -> bytes:
    """The library's bytes, from the user's cache if these very sources have been compiled before.

    Raises BadInput where fmpy (for the standard's headers) or ziglang is not installed.
    """
    headers = _folder_of("fmpy") / "c-code"
    _folder_of("ziglang")
    sources = sorted(NATIVE.glob("*.c"))
    table = variables_header()
    digest = hashlib.sha256(f"{TARGET} {FLAGS} {table}".encode())
    for path in (*sources, *sorted(NATIVE.glob("*.h")), *sorted(headers.glob("fmi[23]*.h"))):
        digest.update(path.read_bytes())
    kept = user_cache_folder() / "railslide" / "coach-fmu" / f"{digest.hexdigest()[:20]}.so"
    if kept.is_file():
        return kept.read_bytes()
    library = _compiled(sources, headers, table)
    _keep(kept, library)
    return library


def variables_header() -> str:
    """The table of variables for the C code."""
    kinds = "".join(variable.kind[0] for variable in VARIABLES)
    starts = ", ".join(repr(float(variable.start or 0.0)) for variable in VARIABLES)
    parameters = sum(variable.causality == "parameter" for variable in VARIABLES)
    return (
        f'#define TOKEN "{interface_digest()}"\n'
        f'#define VARIABLE_KINDS "{kinds}"\n'
        f"#define VARIABLE_STARTS {starts}\n"
        f"#define PARAMETERS {parameters}\n"
        f"#define SET {len(SET)}\n"
        f"#define VALUES {len(VARIABLES)}\n"
        f"#define TICK_S {TICK_S!r}\n"
    )


def _compiled(sources: list[Path], headers: Path, table: str) -> bytes:
    with tempfile.TemporaryDirectory(prefix="railslide-") as name:
        folder = Path(name)
        (folder / "variables.h").write_text(table, encoding="utf-8")
        library = folder / "library.so"
        command = [
            *(sys.executable, "-m", "ziglang", "cc", "-target", TARGET, *FLAGS),
            *("-I", str(folder), "-isystem", str(headers), *map(str, sources), "-lm", "-o", str(library)),
        ]
        caches = {"ZIG_GLOBAL_CACHE_DIR": str(folder / "global"), "ZIG_LOCAL_CACHE_DIR": str(folder / "local")}
        done = subprocess.run(command, env={**os.environ, **caches}, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"ziglang could not compile the FMU's library:\n{done.stderr}")
        return library.read_bytes()


def _keep(place: Path, library: bytes) -> None:
    """Put it into the cache; where that cannot be written, it is compiled again next time."""
    partial = place.with_suffix(f".{os.getpid()}")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(library)
        partial.replace(place)
    except OSError:
        with suppress(OSError):
            partial.unlink()


def _folder_of(package: str) -> Path:
    spec = find_spec(package)
    if spec is None or spec.origin is None:
        message = f"needs the package {package}, which is not installed: pip install 'railslide[fmu]'"
        raise BadInput(Fault("", "export-fmu", message))
    return Path(spec.origin).parent
