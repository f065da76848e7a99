"""Verdicts about records that are wrong themselves: labels mixed up, bad channels."""

from __future__ import annotations

from collections.abc import Sequence

from permway.campaign.bad_channels import BadChannel
from permway.diagnosis.fit import Fit
from permway.diagnosis.labels import Mislabelled
from permway.diagnosis.recalibrated_values import recalibrated_of
from permway.diagnosis.verdict import RIGHT, Status, Verdict
from permway.diagnosis.verdict_parts import Effect, Mechanics, Place, Recalibrated

LABELS = "sensor_labels"
"""Name of the fault that channels carry each other's labels."""


def mixed_up(base: Fit, mixed: Mislabelled) -> Verdict:
    """Of records whose labels are wrong: nothing else can be concluded from them."""
    effect = Effect(
        domain="measurement",
        place=Place(channels=mixed.channels),
        name=LABELS,
        law=Mechanics(words=mixed.words),
    )
    return Verdict(
        status="measurement", effects=(effect,), recalibrated=Recalibrated(before=recalibrated_of(base))
    )


def with_bad_channels(verdict: Verdict, bad: Sequence[BadChannel]) -> Verdict:
    """The verdict with channels whose samples are no measurement, which nothing was estimated from."""
    if not bad:
        return verdict
    faults: dict[tuple[str, str], list[BadChannel]] = {}
    for one in bad:
        faults.setdefault((one.channel, one.kind), []).append(one)
    effects = tuple(
        Effect(
            domain="measurement",
            place=Place(channels=(channel,)),
            name=kind.replace(" ", "_"),
            law=Mechanics(words="; ".join(f"{one.record}: {one.what}" for one in ones) + "; left out"),
        )
        for (channel, kind), ones in faults.items()
    )
    status: Status = "measurement" if verdict.status in RIGHT else verdict.status
    # Through a check: a copy would not be.
    return Verdict.model_validate(
        verdict.model_dump(by_alias=True) | {"status": status, "effects": [*verdict.effects, *effects]}
    )
