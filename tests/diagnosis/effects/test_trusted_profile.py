"""What the owner says of the irregularity is believed: what differs by more is sought, and is no error."""

from __future__ import annotations

from pathlib import Path

import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._excite import with_irregularity
from permway.diagnosis.gather import gather
from permway.diagnosis.learning import TRUSTED
from permway.diagnosis.recalibrate import recalibrate
from trains import campaign_in, drawn

WITHIN_DB = 2.0


@pytest.fixture(scope="module")
def owner(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return campaign_in(Path(tmp_path_factory.mktemp("profile")))


@pytest.mark.parametrize("slope", [0.0, 4.0])
@pytest.mark.parametrize("knowledge", ["within", "unknown"])
def test_an_irregularity_that_is_known_differs_by_no_more(owner: Campaign, knowledge: str, slope: float) -> None:
    truth = with_irregularity(owner, slope_dB_per_octave=slope)
    within = WITHIN_DB if knowledge == "within" else None
    believed = with_irregularity(owner, knowledge=knowledge, within_dB=within)
    learnt = recalibrate(gather(believed, drawn(truth, 7), threads=1)).evidence.sizes["irregularity"]
    stated = 0.5 * WITHIN_DB / 4.343
    if slope == 0.0:
        assert learnt < stated
    elif knowledge == "within":
        assert learnt == pytest.approx(TRUSTED * stated)
    else:
        assert learnt > 1.5 * TRUSTED * stated
