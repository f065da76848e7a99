"""The paper reproduced once for all tests here: it takes half a minute."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from permway.paper import report as paper
from permway.paper.reproduce import Reproduction


@dataclass(frozen=True)
class Report:
    """A report as written, and what it was written from."""

    folder: Path
    reported: dict[str, Any]
    steps: list[tuple[int, int]]
    result: Reproduction

    @property
    def tables(self) -> dict[str, Any]:
        def refuse(text: str) -> None:
            raise AssertionError(f"{text} in tables.json")

        return json.loads((self.folder / "tables.json").read_text(encoding="utf-8"), parse_constant=refuse)

    @property
    def page(self) -> str:
        return (self.folder / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Report:
    folder = tmp_path_factory.mktemp("paper") / "out"
    kept: list[Reproduction] = []
    steps: list[tuple[int, int]] = []
    reproduce = paper.reproduce

    def reproduce_and_keep(**options: Any) -> Reproduction:
        kept.append(reproduce(**options))
        return kept[0]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(paper, "reproduce", reproduce_and_keep)
        reported = paper.write_report(folder, progress=lambda done, total: steps.append((done, total)))
    return Report(folder, reported, steps, kept[0])
