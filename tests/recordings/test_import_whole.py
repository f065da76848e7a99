"""An import that fails, wherever it fails, leaves what was there before and nothing else."""

from __future__ import annotations

import inspect
import os
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import permway
import pytest
from folders import make_decay, make_pads, make_rig
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.importers import writing
from permway.campaign.importers.pad_materials import import_pad_materials
from permway.campaign.importers.rubber_rig import import_rubber_rig
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.importers.track_decay import import_track_decay
from permway.errors import InputError
from permway.files import LEFT_BEHIND_S
from sheets import make_folder

Run = Callable[[Path, Path], Any]

IMPORTERS: dict[str, Run] = {
    "sheet": import_sheet,
    "rubber-rig": lambda folder, out: import_rubber_rig(folder, out, copy=True, law="constant"),
    "pad-materials": lambda folder, out: import_pad_materials(folder, out, copy=True),
    "track-decay": lambda folder, out: import_track_decay(folder, out, copy=True),
}
LAST = {
    "sheet": "run_252kmh.npz",
    "rubber-rig": "second/shaker/1g_253g.csv",
    "pad-materials": "pu/loss_factor.tsv",
    "track-decay": "tdr_reference_section.csv",
}
"""The file that each reads last."""

STEPS = 12
"""Calls of an import that are failed in turn, spread over all of them."""

PACKAGE = str(Path(permway.__file__).parent)

SPARED = ("staged.py", "kept.py")
"""Files whose calls are not failed: what puts files back is failed by the tests below, through what it calls of
the system; what a cache forgets is called by Python itself, at any time, which leaves errors there unraised."""


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("given")
    return {
        "sheet": make_folder(folder / "team"),
        "rubber-rig": make_rig(folder / "rig", ("01g_253g", "1g_253g"), ("first", "second")),
        "pad-materials": make_pads(folder / "pads"),
        "track-decay": make_decay(folder / "decay"),
    }


def tree(folder: Path) -> dict[str, bytes | None]:
    """All files with their content, and all folders."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None for path in folder.rglob("*")
    }


def before(which: str, given: dict[str, Path], folder: Path, older: bool) -> Path:
    """Where to import to: a folder that is not there, or one that holds an older import and a file of its own."""
    out = folder / "out"
    if older:
        IMPORTERS[which](given[which], out)
        for path in [*out.rglob("*.toml")]:
            path.write_text(path.read_text() + "# older\n")
        (out / "notes.txt").write_text("of the user\n")
    return out


class BrokenError(Exception):
    """Made by a test."""


class FailsAt:
    """Counts calls of the package's functions, and fails one of them."""

    def __init__(self, number: int | None = None) -> None:
        self.number, self.seen = number, 0

    def __call__(self, frame: FrameType, event: str, _: Any) -> None:
        if event != "call" or not frame.f_code.co_filename.startswith(PACKAGE):
            return
        # A generator that is let go of before its end is called once more, by Python itself.
        if frame.f_code.co_filename.endswith(SPARED) or frame.f_code.co_flags & inspect.CO_GENERATOR:
            return
        self.seen += 1
        if self.seen == self.number:
            raise BrokenError


def profiled(run: Callable[[], Any], hook: FailsAt) -> None:
    sys.setprofile(hook)
    try:
        run()
    finally:
        sys.setprofile(None)


@pytest.mark.parametrize("older", [False, True], ids=["new", "older"])
@pytest.mark.parametrize("which", IMPORTERS)
def test_whatever_call_fails(which: str, older: bool, given: dict[str, Path], tmp_path: Path) -> None:
    out = before(which, given, tmp_path, older)
    was = tree(tmp_path)
    # The first of two imports fills caches, too.
    for count in (FailsAt(), FailsAt()):
        profiled(lambda: IMPORTERS[which](given[which], tmp_path / "counted"), count)
        shutil.rmtree(tmp_path / "counted")
    for number in np.unique(np.linspace(1, count.seen, STEPS).round()).astype(int):
        with pytest.raises((BrokenError, InputError)) as failed:
            profiled(lambda: IMPORTERS[which](given[which], out), FailsAt(int(number)))
        # Whatever fails while a file is read, its reader states that the file cannot be read, and why.
        assert isinstance(failed.value, BrokenError) or "BrokenError" in str(failed.value)
        assert tree(tmp_path) == was, f"after call {number} of {count.seen}"


SYSTEM = [(os, "replace"), (os, "mkdir"), (shutil, "copyfile")]


@pytest.mark.parametrize("older", [False, True], ids=["new", "older"])
@pytest.mark.parametrize("which", IMPORTERS)
@pytest.mark.parametrize(("owner", "name"), SYSTEM, ids=[name for _, name in SYSTEM])
def test_whatever_the_disk_refuses(
    which: str,
    older: bool,
    owner: Any,
    name: str,
    given: dict[str, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each call in turn, until none is left to refuse."""
    out = before(which, given, tmp_path, older)
    was = tree(tmp_path)
    true = getattr(owner, name)
    refused = 0
    while True:
        calls = 0

        def once(*arguments: Any, number: int = refused, **more: Any) -> Any:
            nonlocal calls
            calls += 1
            if calls == number + 1:
                raise OSError(28, "No space left on device", str(arguments[-1]))
            return true(*arguments, **more)

        with monkeypatch.context() as patch:
            patch.setattr(owner, name, once)
            try:
                IMPORTERS[which](given[which], out)
                break
            except InputError as error:
                stated = str(error)
        assert "No space left on device" in stated
        assert tree(tmp_path) == was, f"after call {refused} of {name}"
        refused += 1
    assert refused >= 1


@pytest.mark.parametrize("links", [True, False], ids=["second-names", "none"])
def test_all_is_put_back_that_was_in_its_place(
    links: bool, given: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last step fails; a file system may have no second names for files."""
    out = before("pad-materials", given, tmp_path, older=True)
    was = tree(tmp_path)
    placed = []

    def refused(*_: Any, **__: Any) -> None:
        raise OSError(95, "Operation not supported")

    def read(path: Path, *, allow_outside: bool) -> Campaign:
        if ".part" not in str(path):
            placed.append(path.read_text())
            raise BrokenError
        return read_campaign(path, allow_outside=allow_outside)

    monkeypatch.setattr(writing, "read_campaign", read)
    if not links:
        monkeypatch.setattr(os, "link", refused)
    with pytest.raises(BrokenError):
        import_pad_materials(given["pad-materials"], out, copy=True)
    assert "# older" not in placed[0]
    assert tree(tmp_path) == was


def test_stages_that_killed_imports_left_are_taken_away_after_a_while(
    given: dict[str, Path], tmp_path: Path
) -> None:
    left = {name: tmp_path / f".out.{name}.part" for name in ("fresh", "old", "keeps")}
    for path in left.values():
        (path / "new").mkdir(parents=True)
        (path / "replaced").mkdir()
    (left["keeps"] / "replaced" / "0").write_text("of the user\n")
    long_ago = time.time() - LEFT_BEHIND_S - 1.0
    for name in ("old", "keeps"):
        os.utime(left[name], (long_ago, long_ago))
    import_track_decay(given["track-decay"], tmp_path / "out")
    assert {name for name, path in left.items() if path.exists()} == {"fresh", "keeps"}


@pytest.mark.parametrize("which", IMPORTERS)
def test_a_record_that_cannot_be_read(which: str, given: dict[str, Path], tmp_path: Path) -> None:
    """It is the last of all, and is named as it was given."""
    folder = Path(shutil.copytree(given[which], tmp_path / "given"))
    last = folder / LAST[which]
    last.write_bytes(last.read_bytes()[:60])
    was = tree(tmp_path)
    with pytest.raises(InputError) as caught:
        IMPORTERS[which](folder, tmp_path / "out")
    assert str(last) in str(caught.value)
    assert ".part" not in str(caught.value)
    assert tree(tmp_path) == was


@pytest.mark.parametrize("which", IMPORTERS)
def test_what_is_beside_stays(which: str, given: dict[str, Path], tmp_path: Path) -> None:
    out = before(which, given, tmp_path, older=True)
    IMPORTERS[which](given[which], out)
    assert (out / "notes.txt").read_text() == "of the user\n"
    assert all("# older" not in path.read_text() for path in out.rglob("*.toml"))
    assert not [path for path in tmp_path.rglob("*") if path.name.endswith(".part")]


def test_records_that_lie_in_the_folder_stay_as_they_are(given: dict[str, Path], tmp_path: Path) -> None:
    folder = Path(shutil.copytree(given["sheet"], tmp_path / "team"))
    was = {path.name: path.stat().st_ino for path in folder.iterdir()}
    import_sheet(folder, folder)
    assert {name: (folder / name).stat().st_ino for name in was} == was
    assert {path.name for path in folder.iterdir()} == {*was, "campaign.toml", "model.toml"}


@pytest.mark.parametrize("which", IMPORTERS)
def test_no_place_to_write_is_reported_first(which: str, given: dict[str, Path], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder\n")
    for out, what in ((tmp_path / "no" / "out", "there is no such folder"), (tmp_path / "file", "is a file")):
        with pytest.raises(InputError, match=what):
            IMPORTERS[which](given[which] / "nowhere", out)
