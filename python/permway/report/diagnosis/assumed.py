"""What the verdict rests on without having been tested: model, tolerances, noise, versions, data left out."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import Any

from permway import _core
from permway.campaign.rolls import how_trains_run
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.compare import KIND
from permway.diagnosis.result import Diagnosis
from permway.report.compare.tables import calibration_rows, decibels

LIBRARIES = ("numpy", "scipy", "xarray")


def assumed(diagnosis: Diagnosis) -> dict[str, Any]:
    """Facts by heading: `model`, `records`, `smooth`, `noise`, `left_out`, `ruled_out`, `held_out`, how made."""
    campaign, comparison = diagnosis.comparison.campaign, diagnosis.comparison
    line = campaign.model.line
    runs = how_trains_run(campaign.stated, campaign.model)
    layers = dict.fromkeys(f"{layer.law} ({layer.between[0]} on {layer.between[1]})" for layer in line.joints)
    return {
        "model": [
            ("Model file", campaign.stated.model),
            ("Bodies", ", ".join(line.bodies)),
            ("Joints", f"{line.joint_table().x.size}: {', '.join(layers)}"),
            ("Parameters with tolerances", str(len(campaign.parameters.known))),
            *([] if runs is None else [("Trains", runs)]),
        ],
        "records": [
            (row["kind"], row["records"], row["channels"], decibels(row["noise_dB_rms"]))
            for row in comparison.fits()
        ],
        "smooth": calibration_rows(comparison),
        "noise": _noise(diagnosis),
        "left_out": list(comparison.left_out.items()),
        "ruled_out": list(diagnosis.verdict.ruled_out),
        "held_out": [f"{group.name} ({group.axis})" for group in campaign.stated.held_out],
        "versions": [
            ("permway", _core.__version__),
            ("Python", platform.python_version()),
            *((name, version(name)) for name in LIBRARIES),
        ],
        "seconds": [(stage, f"{seconds:.1f} s") for stage, seconds in diagnosis.seconds.items()],
    }


def _noise(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """How the noise of each kind of record was had."""
    words = []
    observations = diagnosis.base.observations
    if any(isinstance(block, FrfBlock) for block in observations.blocks):
        words.append((KIND["frf"], "of each line by coherence and averages"))
    kinds = dict.fromkeys(d.record.statistic for d in observations.datasets)
    if "csd" in kinds or "psd" in kinds:
        words.append((KIND["psd"], "by the effective number of averages"))
    for kind in kinds:
        if kind == "modes":
            words.append((KIND[kind], "as the table states it"))
        elif kind not in ("frf", "csd", "psd"):
            words.append((KIND.get(kind, kind), "an assumed scatter"))
    return words
