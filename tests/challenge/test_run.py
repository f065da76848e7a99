"""The runner of a challenge: what is there is left alone, what fails is kept with its reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from permway.challenge.run import FAILED, VERDICT, run
from permway.errors import InputError


def test_done_cases_are_left_alone_and_broken_ones_state_why(tmp_path: Path) -> None:
    for name in ("null-1", "null-2"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "sheet.json").write_text("{ no json")
    done = tmp_path / "verdicts" / "null-1"
    done.mkdir(parents=True)
    (done / VERDICT).write_text("as it was")
    seen: list[tuple[int, int]] = []
    assert run(tmp_path, workers=2, progress=lambda *at: seen.append(at)) == {"verdicts": 1, "failed": 1}
    assert (done / VERDICT).read_text() == "as it was"
    reason = (tmp_path / "verdicts" / "null-2" / FAILED).read_text()
    assert "permway import sheet" in reason
    assert "sheet.json" in reason
    assert sorted(seen) == [(1, 2), (2, 2)]


def test_a_folder_without_campaigns_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no campaign"):
        run(tmp_path)
