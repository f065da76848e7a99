"""Files of a small campaign: the same seed and index give the same bytes."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from permway.challenge.weigh import whole
from permway.laws.toml import to_toml

_EPOCH = (2026, 1, 1, 0, 0, 0)


def write_tables(folder: Path, campaign: Mapping[str, Any], model: Mapping[str, Any]) -> Path:
    """Write `model.toml` and `campaign.toml`; the campaign's path."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(to_toml(model), encoding="utf-8")
    path = folder / "campaign.toml"
    path.write_text(to_toml(campaign), encoding="utf-8")
    for record in campaign["records"]:
        # Whoever reads a campaign file looks for the files that it names.
        (folder / record["file"]).touch()
    return path


def write_arrays(path: Path, content: Mapping[str, Any]) -> None:
    """An archive as numpy writes it, without the time of day."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, values in content.items():
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, np.asarray(values))
            entry = zipfile.ZipInfo(f"{name}.npy", date_time=_EPOCH)
            archive.writestr(entry, buffer.getvalue(), zipfile.ZIP_DEFLATED)


def write_truth(path: Path, truth: Mapping[str, Any]) -> str:
    """Write what is true of a campaign, last of all its files, and beside it its SHA-256, which is returned."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(truth, indent=1) + "\n"
    digest = hashlib.sha256(text.encode()).hexdigest()
    whole(path.with_name(path.name + ".sha256"), f"{digest}  {path.name}\n")
    whole(path, text)
    return digest
