"""A run folder appears whole or not at all, and never in place of anything but a run."""

import json
import os
from pathlib import Path

import pytest

from scenarios.errors import BadInput
from scenarios.run_folder import RunFolder


def write_run(parent: Path, name: str, text: str) -> Path:
    with RunFolder(parent, name) as folder:
        (folder.path / "scenario.toml").write_text(text)
        folder.write_json("provenance.json", {"program": "railslide"})
        return folder.publish()


def test_nothing_has_the_name_before_it_is_whole(tmp_path: Path) -> None:
    with RunFolder(tmp_path / "runs", "one") as folder:
        (folder.path / "scenario.toml").write_text("a")
        assert not (tmp_path / "runs" / "one").exists()
        folder.write_json("provenance.json", {"program": "railslide"})
        place = folder.publish()
    assert place == tmp_path / "runs" / "one"
    assert sorted(os.listdir(tmp_path / "runs")) == ["one"]
    assert (place / "scenario.toml").read_text() == "a"


def test_an_error_leaves_nothing_not_even_the_folders_made_for_it(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), RunFolder(tmp_path / "deep" / "runs", "one") as folder:
        (folder.path / "scenario.toml").write_text("a")
        raise KeyboardInterrupt
    assert os.listdir(tmp_path) == []


def test_an_error_leaves_the_older_run_and_its_neighbours_alone(tmp_path: Path) -> None:
    write_run(tmp_path, "one", "old")
    write_run(tmp_path, "two", "neighbour")
    with pytest.raises(RuntimeError), RunFolder(tmp_path, "one") as folder:
        (folder.path / "scenario.toml").write_text("new")
        raise RuntimeError
    assert sorted(os.listdir(tmp_path)) == ["one", "two"]
    assert (tmp_path / "one" / "scenario.toml").read_text() == "old"


def test_an_older_run_is_replaced_whole(tmp_path: Path) -> None:
    old = write_run(tmp_path, "one", "old")
    (old / "metrics.json").write_text("{}")
    write_run(tmp_path, "one", "new")
    assert os.listdir(tmp_path) == ["one"]
    assert (old / "scenario.toml").read_text() == "new"
    assert not (old / "metrics.json").exists()


def test_a_failed_run_keeps_what_it_had_and_why_beside_the_older_run(tmp_path: Path) -> None:
    write_run(tmp_path, "one", "old")
    with RunFolder(tmp_path, "one") as folder:
        folder.write_json("provenance.json", {"program": "railslide"})
        (folder.path / "scenario.toml").write_text("new")
        place = folder.publish_failed("diverged at 3.2 s")
    assert place == tmp_path / "one.failed"
    assert (place / "failure.txt").read_text() == "diverged at 3.2 s\n"
    assert (place / "scenario.toml").read_text() == "new"
    assert (tmp_path / "one" / "scenario.toml").read_text() == "old"


def test_success_clears_an_older_failure_of_that_name(tmp_path: Path) -> None:
    with RunFolder(tmp_path, "one") as folder:
        folder.write_json("provenance.json", {"program": "railslide"})
        folder.publish_failed("diverged")
    write_run(tmp_path, "one", "new")
    assert os.listdir(tmp_path) == ["one"]


@pytest.mark.parametrize("suffix", ["", ".failed"])
def test_a_folder_that_is_no_run_is_refused_and_left_alone(tmp_path: Path, suffix: str) -> None:
    mine = tmp_path / f"one{suffix}"
    mine.mkdir()
    (mine / "thesis.tex").write_text("work of years")
    with pytest.raises(BadInput, match="thesis.tex"), RunFolder(tmp_path, "one"):
        pass
    assert (mine / "thesis.tex").read_text() == "work of years"
    assert os.listdir(tmp_path) == [mine.name]


def test_a_run_with_notes_of_the_user_in_it_is_refused(tmp_path: Path) -> None:
    place = write_run(tmp_path, "one", "old")
    (place / "notes.txt").write_text("look at axle 4")
    with pytest.raises(BadInput, match="notes.txt"), RunFolder(tmp_path, "one"):
        pass


@pytest.mark.parametrize("provenance", [None, "{", "[]", json.dumps({"program": "another"})])
def test_a_folder_that_only_looks_like_a_run_is_refused(tmp_path: Path, provenance: str | None) -> None:
    (tmp_path / "one").mkdir()
    if provenance is not None:
        (tmp_path / "one" / "provenance.json").write_text(provenance)
    with pytest.raises(BadInput, match="not a run folder"), RunFolder(tmp_path, "one"):
        pass


def test_a_link_or_file_of_that_name_is_refused(tmp_path: Path) -> None:
    real = write_run(tmp_path, "real", "old")
    (tmp_path / "link").symlink_to(real)
    (tmp_path / "file").write_text("")
    for name in ("link", "file"):
        with pytest.raises(BadInput, match="not a run folder"), RunFolder(tmp_path, name):
            pass


def test_a_parent_that_cannot_be_written_is_refused_before_anything_is_done(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="cannot be written"), RunFolder(tmp_path / "file" / "runs", "one"):
        pytest.fail("the context was entered")
    with pytest.raises(BadInput, match="cannot be written"), RunFolder(Path("/proc/no/such"), "one"):
        pytest.fail("the context was entered")
    assert os.listdir(tmp_path) == ["file"]


def test_ctrl_c_while_the_folder_is_being_made_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make = Path.mkdir

    def interrupted(self: Path, *arguments: object, **named: object) -> None:
        make(self, *arguments, **named)  # type: ignore[arg-type]
        if self.name == "readings":
            raise KeyboardInterrupt

    monkeypatch.setattr(Path, "mkdir", interrupted)
    with pytest.raises(KeyboardInterrupt), RunFolder(tmp_path / "deep" / "runs", "one"):
        pytest.fail("the context was entered")
    assert os.listdir(tmp_path) == []
