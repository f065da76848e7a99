"""What sensors can tell apart, and which measurement would, on small campaigns that the tool simulated itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import passages
import pytest
import tables_of_modes
from permway.campaign.campaign import Campaign, read_campaign
from permway.cli.campaign import _in_words
from permway.diagnosis.advise import MOST, advise, separation
from permway.diagnosis.catalogue._change import with_fields
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.gather import gather
from permway.diagnosis.menu import menu
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.separability import CLASS_DEVIANCE, Separability, separability
from permway.diagnosis.verdict import Verdict
from permway.diagnosis.verdict_words import _advice as _advised
from permway.model.bodies import BeamChange
from simulated import Simulated, simulate


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Simulated:
    return simulate(tmp_path_factory.mktemp("sensors") / "c", 3)


@pytest.fixture(scope="module")
def found(case: Simulated) -> Separability:
    return separability(case.campaign, threads=1)


def test_nothing_explains_an_effect_better_than_itself(found: Separability) -> None:
    own = np.diag(found.apart)
    # A prior holds an effect back from explaining the whole of itself.
    assert (own <= found.seen * (1.0 + 1e-9)).all()
    assert (found.apart <= found.seen[:, None] * (1.0 + 1e-9)).all()
    seen = found.seen > 100.0
    assert seen.any()
    assert np.median(own[seen] / found.seen[seen]) < 0.1


def test_a_lost_fastener_and_a_sensors_gain_are_not_alternatives(found: Separability) -> None:
    pairs = {frozenset(pair[:2]) for pair in found.inseparable()}
    assert frozenset(("fastener_loss", "sensor_gain")) not in pairs
    summary = found.summary()
    assert {row["effect"] for row in summary["effects"]} >= {"fastener_loss", "sensor_gain", "deck_attachment"}


def test_people_read_effects_by_what_engineers_call_them() -> None:
    """Of what is seen and of what cannot be separated, as `permway separability` prints both."""
    alike = np.array([[0.0, 2.0], [2.0, 0.0]])
    found = Separability(
        names=("fastener_loss pad", "mortar_void mortar"),
        entries=("fastener_loss", "mortar_void"),
        families=("stiffness", "stiffness"),
        size=("a half", "a half"),
        seen=np.array([90.0, 80.0]),
        apart=alike,
    )
    summary = _in_words(found.summary())
    assert summary["inseparable"] == [{"one": "lost fasteners", "other": "void below the slab", "deviance": 2.0}]
    assert {row["effect"] for row in summary["effects"]} == {"lost fasteners", "void below the slab"}


def test_measured_values_play_no_part(case: Simulated, found: Separability, tmp_path: Path) -> None:
    other = simulate(tmp_path / "c", 3, amend=lambda c: weakened(c, "pad", 7.5, 0.6, 0.5))
    again = separability(other.campaign, threads=1)
    # The noise that a record's coherence states is drawn with the record, and follows its level.
    np.testing.assert_allclose(np.log10(again.seen + 1.0), np.log10(found.seen + 1.0), atol=0.4)


def test_more_blows_and_more_sensors_separate_more(case: Simulated) -> None:
    base = recalibrate(gather(case.campaign, threads=1))
    right = type(base)(**{**vars(base), "campaign": weakened(base.campaign, "pad", 7.5, 0.6, 0.3)})
    items = {item.words: separation(item, right, base) for item in menu(case.campaign, base.observations.datasets)}
    assert all(value >= 0.0 for value in items.values())
    again = next(value for words, value in items.items() if words.endswith("4 times the blows"))
    one = max(value for words, value in items.items() if words.startswith("a sensor"))
    assert one > 10.0
    # All sensors and points again say more than one sensor more.
    assert again > one
    same = type(base)(**vars(base))
    assert all(separation(item, same, base) < 1e-6 for item in menu(case.campaign, base.observations.datasets))


def test_of_a_suspicion_it_is_reported_what_would_make_sure(case: Simulated) -> None:
    """Held against nothing missing."""
    base = recalibrate(gather(case.campaign, threads=1))
    fit = type(base)(**{**vars(base), "campaign": weakened(base.campaign, "pad", 7.5, 0.6, 0.9)})
    advised = advise(fit, base, ("fastener_loss", "recalibrated"))
    assert 0 < len(advised) <= MOST
    assert {one.separates for one in advised} == {("fastener_loss", "recalibrated")}
    assert all((one.separation_after or 0.0) > (one.separation_before or 0.0) for one in advised)
    words = _advised(Verdict(status="insufficient", next=advised))
    assert words == f"to be sure of lost fasteners, measure: {advised[0].measurement}"


@pytest.fixture(params=["passage", "modes"])
def bridge(request: pytest.FixtureRequest, tmp_path: Path) -> Campaign:
    """A beam held at its ends alone, by a passage or by a table of its modes."""
    if request.param == "modes":
        return read_campaign(tables_of_modes.write(tmp_path, tables_of_modes.rows_of(tables_of_modes.changed())))
    random, time = np.random.default_rng(4), passages.time_s()
    columns = {}
    for name in "wa":
        values = passages.history(name, time, 0.01)
        columns[name] = values + 1e-3 * np.abs(values).max() * random.standard_normal(time.size)
    table = passages.campaign("wa", high_Hz=10.0)
    return read_campaign(passages.write(tmp_path, columns, table=table, loss_factor=0.02))


def test_passages_and_modes_have_a_menu_that_separates(bridge: Campaign) -> None:
    base = recalibrate(gather(bridge, threads=1))
    cracked = BeamChange(from_m=8.0, to_m=10.0, bending_factor=0.85)
    right = type(base)(**{**vars(base), "campaign": with_fields(base.campaign, "deck", changes=(cracked,))})
    items = list(menu(bridge, base.observations.datasets))
    assert {item.kind for item in items} in ({"speed", "repeat", "sensor"}, {"repeat"})
    assert all(separation(item, right, base) > 10.0 for item in items)
    assert all(separation(item, type(base)(**vars(base)), base) < 1e-6 for item in items)


def test_a_beam_on_its_ends_has_places(bridge: Campaign) -> None:
    found = separability(bridge, threads=1)
    seen = {row["effect"]: row["deviance"] for row in found.summary()["effects"]}
    assert seen["girder_crack"] > CLASS_DEVIANCE
    assert seen["deck_attachment"] > CLASS_DEVIANCE
