"""Where numba keeps compiled code on disk: one folder per state of the sources.

Numba's own index watches the file of the cached function alone. A compiled function that calls another one in a changed
file would be served stale, so the folder's name is a fingerprint of every source file of the project and of the
versions that compile it.
"""

import hashlib
import os
import platform
import shutil
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

PACKAGES = ("wheel_rail", "vehicle", "wsp", "sensors", "estimators", "scenarios")
KEPT_FOLDERS = 3
IN_USE_S = 600.0
"""A folder touched more recently than this may belong to a running process and is not pruned."""


def source_fingerprint() -> str:
    """Hexadecimal digest of all project sources and of the versions of Python, numba and numpy."""
    from importlib.metadata import version  # slow to import, and help does not need it

    digest = hashlib.sha256()
    digest.update(f"{platform.python_version()} {version('numba')} {version('numpy')}".encode())
    for package in PACKAGES:
        spec = find_spec(package)
        for folder in (spec.submodule_search_locations or ()) if spec else ():
            for path in sorted(Path(folder).rglob("*.py")):
                digest.update(f"\0{package}/{path.relative_to(folder).as_posix()}\0".encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()[:20]


def user_cache_folder() -> Path:
    """The user's cache folder by the custom of the platform (XDG_CACHE_HOME, Library/Caches, LOCALAPPDATA)."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")


def use_compile_cache() -> Path:
    """Set NUMBA_CACHE_DIR to this source state's folder and return it; to be called before numba is imported.

    NUMBA_CACHE_DIR, if the user has set it, names the parent folder instead of `<user cache>/railslide`. A folder that
    cannot be written is replaced by one in the temporary directory of the system.
    """
    fingerprint = source_fingerprint()
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen and Path(chosen).name == fingerprint:  # a child process has inherited the parent's setting
        return Path(chosen)
    folder = (Path(chosen) if chosen else user_cache_folder() / "railslide") / fingerprint
    if not _is_writable(folder):
        user = os.getuid() if hasattr(os, "getuid") else "user"
        folder = Path(tempfile.gettempdir()) / f"railslide-{user}" / fingerprint
        if not _is_writable(folder):
            folder = Path(tempfile.mkdtemp(prefix="railslide-"))
    os.environ["NUMBA_CACHE_DIR"] = str(folder)
    _prune(folder)
    return folder


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
        os.utime(folder)
    except OSError:
        return False
    return True


def _prune(current: Path) -> None:
    """Remove the folders of older source states, the most recently used few excepted."""
    others = []
    for folder in current.parent.iterdir():
        if folder != current and len(folder.name) == len(current.name) and folder.is_dir():
            others.append((folder.stat().st_mtime, folder))
    others.sort(reverse=True)
    for used_s, folder in others[KEPT_FOLDERS - 1 :]:
        if time.time() - used_s > IN_USE_S:
            shutil.rmtree(folder, ignore_errors=True)
