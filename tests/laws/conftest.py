from __future__ import annotations

from pathlib import Path

import pytest

RECORDINGS = Path(__file__).resolve().parents[3] / "shared" / "recordings"


@pytest.fixture(scope="session")
def recordings() -> Path:
    """Folder of real recordings; they are not part of the repository."""
    if not RECORDINGS.is_dir():
        pytest.skip(
            f"the recordings are not here ({RECORDINGS.name} beside the repository); nothing to compare with"
        )
    return RECORDINGS
