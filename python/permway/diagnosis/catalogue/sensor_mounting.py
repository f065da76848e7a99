"""A sensor on a soft mount: glue, a magnet, a bracket."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._excite import chain_with
from permway.diagnosis.catalogue._runs import likely
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free

ID = "sensor_mounting"
DOMAIN: Domain = "measurement"
FAMILY = "sensor dynamics"
SUMMARY = "One sensor reads (1 + i eta) / (1 + i eta - (f / f0)^2) of what is there."
PARAMETERS = {
    "mount_Hz": "Hz, 60 to 20000: f0, of the sensor on its mount",
    "loss_factor": "1, 0.01 to 0.6: eta",
}
SIGNATURE = (
    "One row of all frequency responses, or one channel of all runs: grows with frequency squared to a peak."
)
CONFUSED_WITH = {
    "sensor_gain": "a factor that does not depend on frequency",
    "sensor_delay": "the amplitude is right there",
    "axlebox_absorber": "other channels of the same wheelset",
}
SOURCE = "ISO 5348:2021, mechanical mounting of accelerometers"


def at_sensor(name: str, _: Mapping[str, float]) -> Where:
    """The place of a fault of one sensor."""
    return Where(channels=(name,))


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each of the sensors that fit worst and have an ideal mount so far."""
    for name in likely(situation):
        if situation.campaign.sensor(name).chain.mount_Hz is not None:
            continue

        def amend(campaign: Campaign, values: Mapping[str, float], name: str = name) -> Campaign:
            at = values["mount_Hz"]
            mount = {"mount_Hz": at, "mount_loss_factor": values["loss_factor"]} if np.isfinite(at) else {}
            return with_chain(campaign, name, chain_with(campaign.sensor(name).chain, **mount))

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(
                log_free("mount_Hz", "Hz", 600.0, 2.2, lowest=30.0),
                log_free("loss_factor", "1", 0.08, 2.2),
            ),
            amend=amend,
            locate=partial(at_sensor, name),
            starts=tuple((z, -0.5) for z in (0.0, -0.4, -0.8, -1.2, -1.8)),
            law=lambda v: f"resonates on its mount at {v['mount_Hz']:.3g} Hz, loss factor {v['loss_factor']:.2g}",
            size="mount_Hz",
            none=float("inf"),
        )
