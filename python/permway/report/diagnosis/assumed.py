"""What the verdict rests on without having been tested: model, tolerances, noise, versions, data left out."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import Any

from permway import _core
from permway.campaign.compare import NEPER_DB
from permway.campaign.kinds import KINDS, kind_of
from permway.campaign.rolls import how_trains_run
from permway.diagnosis.result import Diagnosis
from permway.posterior.hyper import STRAINED
from permway.report.compare.tables import calibration_rows, decibels

LIBRARIES = ("numpy", "scipy", "xarray")


def assumed(diagnosis: Diagnosis) -> dict[str, Any]:
    """Facts by heading: `model`, `records`, `smooth`, `noise`, `left_out`, `ruled_out`, `held_out`, how made.

    `strained` is the size from which errors in `smooth` deserve a look.
    """
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
        # Of the model that the verdict rests on: before, errors may have stood in for what was missing.
        "smooth": calibration_rows(diagnosis.after or comparison),
        "strained": f"{STRAINED * NEPER_DB:.1f} dB",
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
    kinds = {kind_of(d.record) for d in diagnosis.base.observations.datasets}
    return [(kind.title, kind.noise) for kind in dict.fromkeys(KINDS.values()) if kind in kinds]
