"""What an effect leaves as it was is not predicted again, and comes out as if it had been."""

from __future__ import annotations

import numpy as np
import pytest
from effects.trains import campaign_in, drawn
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.compete import Ring
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.locate import scanned
from permway.diagnosis.refit import untouched
from permway.errors import InputError, SolveError


@pytest.fixture(scope="module")
def ring(tmp_path_factory: pytest.TempPathFactory) -> Ring:
    """About a campaign with hammer tests and runs."""
    campaign = campaign_in(tmp_path_factory.mktemp("kept"))
    return Ring(untouched(gather(campaign, drawn(campaign, 4), threads=1)))


def test_every_effect_is_seen_as_if_all_were_predicted(ring: Ring) -> None:
    """Each effect of the catalogue at each of its starts: deviations, what explains them, slopes."""
    evidence, kept, seen = ring.evidence, set(), set()
    for hypothesis in hypotheses(Situation(ring.fit, scanned(ring.fit)), ()):
        if hypothesis.about or hypothesis.entry in seen:
            continue
        low, high = np.array([f.limits for f in hypothesis.free]).T
        z = np.clip(np.array(hypothesis.starts[-1], dtype=np.float64), low, high)
        values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
        try:
            campaign = hypothesis.amend(ring.fit.campaign, values)
            whole = evidence.predicted(campaign)
        except (InputError, SolveError):
            continue
        near = evidence.predicted(campaign, ring._solved)
        kept |= {
            (hypothesis.domain, block.dataset.record.statistic)
            for block, new, old in zip(evidence.blocks, near.datasets, ring._solved.datasets, strict=True)
            if new is old
        }
        seen.add(hypothesis.entry)
        expected, found = ring._seen(evidence.deviations(whole.datasets)), ring._amended(hypothesis, z)
        assert found is not None
        for name in ("deviations", "reduced", "slope"):
            mine, theirs = getattr(found, name), getattr(expected, name)
            size = float(np.abs(theirs).max())
            np.testing.assert_allclose(mine, theirs, atol=1e-9 * size, err_msg=f"{hypothesis.entry}: {name}")
    # Hammer tests do not hear what excites trains, nor runs what is wrong with a sensor on the line.
    assert {("irregularity", "frf"), ("vehicle", "frf"), ("measurement", "frf"), ("measurement", "csd")} <= kept
    assert len(seen) > 30
