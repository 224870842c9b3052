"""The folder of compiled code changes with the sources, survives a home that cannot be written, and is pruned."""

import os
import time
from pathlib import Path

import pytest

from scenarios import compile_cache
from scenarios.compile_cache import KEPT_FOLDERS, source_fingerprint, use_compile_cache


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of its own to take the fingerprint of."""
    folder = tmp_path / "path" / "cached_package"
    (folder / "inner").mkdir(parents=True)
    (folder / "__init__.py").write_text("")
    (folder / "inner" / "law.py").write_text("A = 1\n")
    monkeypatch.syspath_prepend(str(folder.parent))
    monkeypatch.setattr(compile_cache, "PACKAGES", ("cached_package",))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    return folder


def test_fingerprint_sees_contents_names_and_nothing_else(package: Path) -> None:
    first = source_fingerprint()
    os.utime(package / "inner" / "law.py", (1, 1))
    (package / "notes.txt").write_text("not code")
    assert source_fingerprint() == first
    (package / "inner" / "law.py").write_text("A = 2\n")
    second = source_fingerprint()
    (package / "inner" / "law.py").rename(package / "inner" / "laws.py")
    assert len({first, second, source_fingerprint()}) == 3


def test_cache_lies_in_the_users_cache_folder(package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_cache, "user_cache_folder", lambda: tmp_path / "cache")
    folder = use_compile_cache()
    assert folder == tmp_path / "cache" / "railslide" / source_fingerprint()
    assert folder.is_dir()
    assert os.environ["NUMBA_CACHE_DIR"] == str(folder)
    assert use_compile_cache() == folder  # a child process inherits the setting


def test_a_parent_folder_of_the_users_choice(package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "mine"))
    assert use_compile_cache() == tmp_path / "mine" / source_fingerprint()


def test_a_cache_folder_that_cannot_be_written_is_replaced(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(compile_cache, "user_cache_folder", lambda: tmp_path / "file")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    folder = use_compile_cache()
    assert folder.is_relative_to(tmp_path / "temporary")
    assert folder.name == source_fingerprint()


def test_old_source_states_are_pruned_except_the_last_few_and_fresh_ones(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compile_cache, "user_cache_folder", lambda: tmp_path)
    ages_s = {f"{k:020x}": 1000.0 * k for k in range(1, 6)}
    fresh = f"{9:020x}"
    for name, age_s in {**ages_s, fresh: 5.0}.items():
        folder = tmp_path / "railslide" / name
        folder.mkdir(parents=True)
        (folder / "code.nbc").write_text("")
        os.utime(folder, (time.time() - age_s,) * 2)
    (tmp_path / "railslide" / "other").mkdir()
    current = use_compile_cache()
    left = {folder.name for folder in (tmp_path / "railslide").iterdir()}
    youngest = sorted(ages_s, key=ages_s.__getitem__)[: KEPT_FOLDERS - 2]
    assert left == {current.name, fresh, "other", *youngest}
