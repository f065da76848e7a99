"""The verdict as data: the published schema, the file, and the verdict in words."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.diagnosis.hypothesis import Where
from permway.diagnosis.tolerances import limit
from permway.diagnosis.verdict import (
    ClassMember,
    Effect,
    Estimate,
    HeldOutGain,
    Mechanics,
    NextMeasurement,
    Place,
    Smallest,
    Verdict,
    Weight,
    json_schema,
)
from permway.diagnosis.verdict_numbers import span
from permway.diagnosis.verdict_parts import Condition, Moved, Recalibrated
from permway.diagnosis.verdict_words import smallest
from permway.errors import InputError
from permway.model.line import Line
from scipy.special import ndtr
from simulated import MODEL

DOCS = Path(__file__).parents[2] / "docs"

LOST = Effect(
    domain="path",
    place=Place(joint="pad", x=(20.3, 22.4), within=(20.0, 22.6)),
    bands=((40.0, 120.0),),
    name="fastener_loss",
    class_=(ClassMember(name="fastener_loss", probability=0.97), ClassMember(name="novel", probability=0.02)),
    law=Mechanics(words="0.05 of the stiffness is left", type="scaled", parameters={"factor": 0.05}),
    parameters={"factor": Estimate(value=0.05, unit="1", low=0.03, high=0.08)},
)
SURE = {"factor": Estimate(value=0.05, unit="1", low=0.0499, high=0.0501)}
"""Known better than its digits say."""
BETTER = {
    "band": HeldOutGain(gain_nats=20.0, standard_error=4.0, db_before=1.9, db_after=1.1),
    "place": HeldOutGain(gain_nats=140.0, standard_error=9.0, db_before=3.1, db_after=0.4),
}
SMALLEST = {
    "fastener_loss": Smallest(parameter="factor", value=0.62, unit="1", none=1.0),
    "deck_attachment": Smallest(parameter="mass_kg", value=400.0, unit="kg"),
    "girder_crack": Smallest(parameter="length_m", value=None, unit="m"),
}
ADVICE = NextMeasurement(
    measurement="a blow on the slab at 21 m",
    separates=("fastener_loss", "mortar_void"),
    separation_before=4.0,
    separation_after=31.0,
)


def verdict(status: str, **more: Any) -> Verdict:
    return Verdict.model_validate({"status": status, **more})


NAMED = verdict("named", effects=(LOST,), held_out=BETTER, evidence=Weight(bic_gain=300.0), detectable=SMALLEST)


def unnamed(*rivals: tuple[str, float], **more: Any) -> Effect:
    members = tuple(ClassMember(name=name, probability=p) for name, p in rivals)
    return LOST.model_copy(update={"name": None, "class_": members, **more})


def test_a_verdict_comes_back_from_its_file_as_it_was(tmp_path: Path) -> None:
    path = NAMED.write(tmp_path / "verdict.json")
    assert Verdict.read(path) == NAMED
    assert path.read_text(encoding="utf-8") == NAMED.to_json()
    assert [p.name for p in tmp_path.iterdir()] == ["verdict.json"]


def test_every_key_of_the_design_is_in_the_file_in_its_order() -> None:
    table = json.loads(verdict("recalibrated").to_json())
    assert list(table) == [
        "format",
        "status",
        "effects",
        "evidence",
        "held_out",
        "placebo",
        "explained_gap",
        "recalibrated",
        "next",
        "detectable",
        "ruled_out",
        "blunders",
    ]
    assert list(table["evidence"]) == [
        "bic_gain",
        "log10_bayes_factor",
        "e_value",
        "false_alarm_threshold",
        "misfit_before",
        "misfit_after",
        "unmet",
    ]
    assert table["evidence"].pop("unmet") == []
    assert set(table["evidence"].values()) == {None}
    (effect,) = json.loads(NAMED.to_json())["effects"]
    assert list(effect) == ["domain", "place", "bands", "name", "class", "law", "parameters", "size"]
    assert list(effect["place"]) == ["body", "joint", "x", "within", "channels"]


def test_numbers_of_numpy_are_written_as_numbers() -> None:
    one = Estimate(value=np.float64(0.5), unit="1", low=np.float32(0.25), high=np.int64(1))
    assert json.loads(one.model_dump_json()) == {"value": 0.5, "unit": "1", "low": 0.25, "high": 1.0}


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_refused(value: float) -> None:
    with pytest.raises(InputError, match="finite"):
        Estimate(value=value, unit="m")
    with pytest.raises(InputError, match="finite"):
        Weight(e_value=value)


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("0.97", "NaN", "not JSON"),
        ("0.97", '"0.97"', r"effects\[0\]\.class\[0\]\.probability"),
        ("0.97", "true", r"effects\[0\]\.class\[0\]\.probability"),
        ("0.97", "1.5", r"effects\[0\]\.class\[0\]\.probability"),
        ("0.97", "0.99", r"effects\[0\]\.class: the probabilities sum"),
        ("20.3", "30", r"effects\[0\]\.place\.x: must run from low to high"),
        ('"body": null', '"body": "rail"', r"effects\[0\]\.place: is a body or a joint"),
        ('"bands"', '"bandz"', r"effects\[0\]\.bandz: unknown key"),
        ('"format": 1', '"format": 2', "this version of permway reads format 1"),
        ('"status": "named"', '"status": "recalibrated"', "has no effects"),
        ('"name": "fastener_loss",\n      "class"', '"name": null,\n      "class"', "needs a name"),
    ],
)
def test_a_file_that_breaks_the_schema_is_refused_with_the_place(
    tmp_path: Path, old: str, new: str, where: str
) -> None:
    text = NAMED.to_json()
    assert old in text
    path = tmp_path / "verdict.json"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError, match=where) as caught:
        Verdict.read(path)
    assert str(path) in str(caught.value)


def test_statuses_ask_for_what_they_state() -> None:
    for status in ("named", "ambiguous", "described", "located", "measurement"):
        with pytest.raises(InputError, match="needs an effect"):
            Verdict(status=status)
    with pytest.raises(InputError, match="without a name"):
        Verdict(status="ambiguous", effects=(LOST,))
    with pytest.raises(InputError, match="has no effects"):
        Verdict(status="recalibrated", effects=(LOST,))
    assert Verdict(status="insufficient", effects=(LOST,)).effects == (LOST,)
    with pytest.raises(InputError, match="conditions that are not met"):
        Verdict(status="named", effects=(LOST,), evidence=Weight(unmet=("placebo",)))


def test_a_file_that_is_not_there_is_reported(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        Verdict.read(tmp_path / "none.json")


def test_the_published_schema_is_current() -> None:
    published = json.loads((DOCS / "verdict.schema.json").read_text(encoding="utf-8"))
    assert published == json_schema(), "run `python docs/make_schema.py`"


def keys(schema: dict[str, Any]) -> set[str]:
    parts = [schema, *schema["$defs"].values()]
    return {key for part in parts for key in part["properties"]}


def test_the_schema_asks_for_every_key_and_explains_it() -> None:
    schema = json_schema()
    for part in (schema, *schema["$defs"].values()):
        assert set(part["required"]) == set(part["properties"])
        assert part["additionalProperties"] is False
        for name, key in part["properties"].items():
            target = key.get("$ref", "").rpartition("/")[2]
            assert key.get("description") or schema["$defs"][target]["description"], name


def test_the_documentation_explains_every_key_and_status() -> None:
    text = (DOCS / "verdict.md").read_text(encoding="utf-8")
    explained = set(re.findall(r"`(\w+)`", text))
    assert keys(json_schema()) <= explained
    for status in json_schema()["properties"]["status"]["enum"]:
        assert f'| "{status}" |' in text


def test_a_place_is_distinguished_from_a_hypothesis() -> None:
    line = Line.model_validate(MODEL["line"])
    pads = Place.of(Where("pad", (3.0, 4.2)), line, within=(2.4, 4.8))
    assert (pads.joint, pads.body, pads.x, pads.within) == ("pad", None, (3.0, 4.2), (2.4, 4.8))
    assert pads.label == "pad from 3 to 4.2 m"
    deck = Place.of(Where("deck", (6.0, 6.0)), line)
    assert (deck.joint, deck.body) == (None, "deck")
    assert deck.label == "deck at 6 m"
    sensor = Place.of(Where(channels=("deck@3",)), line)
    assert (sensor.joint, sensor.body, sensor.label) == (None, None, "deck@3")


def test_a_named_effect_in_one_sentence() -> None:
    assert NAMED.sentence == (
        "Lost fasteners at pad from 20.3 to 22.4 m: 0.05 of the stiffness is left, probability 0.97; "
        "the prediction of held-out records improves from 2.6 to 0.8 dB."
    )


def test_a_size_is_seen_on_the_side_away_from_no_effect() -> None:
    mount = Smallest(parameter="mount_Hz", value=900.0, unit="Hz", none=None)
    assert smallest("sensor_mounting", mount) == "mounting of a sensor (mount below 900 Hz)"
    assert smallest("fastener_loss", SMALLEST["fastener_loss"]) == "lost fasteners (a change of 38 %)"
    assert smallest("deck_attachment", SMALLEST["deck_attachment"]).endswith("(mass above 400 kg)")
    stiffer = Smallest(parameter="factor", value=1.01, unit="1", none=1.0)
    assert smallest("bearing_stiffness", stiffer).endswith("(a change of 1.0 %)")


@pytest.mark.parametrize("status", ["named", "measurement", "described", "located"])
def test_a_model_that_leaves_something_states_that_it_is_not_all(status: str) -> None:
    open_end = Weight(bic_gain=300.0, misfit_before=90.0, misfit_after=74.4)
    words = "this is not all of it: what is left has 74.4 times the mean square that errors explain."
    found = verdict(status, effects=(LOST,), evidence=open_end).sentence
    assert found.endswith(words) == (status != "located")
    assert "no physics is missing" not in found
    fits = open_end.model_copy(update={"misfit_after": 1.2})
    assert "not all of it" not in verdict(status, effects=(LOST,), evidence=fits).sentence


def test_the_ends_of_an_interval_differ_as_they_are_written() -> None:
    assert span(0.0499, 0.0501) == "0.0499 to 0.0501"
    assert span(0.04999, 0.05001) == "0.04999 to 0.05001"
    assert span(12345.6, 12345.9) == "12345.6 to 12345.9"
    assert span(-1e-5, 1e-5) == "−1e−5 to 1e−5"
    assert span(2.0, 2.0) == "2 to 2"


def test_a_parameter_that_nobody_would_believe_is_reported() -> None:
    near = Moved(value=1.05e9, prior=1e9, z=1.2)
    far = {"level": Moved(value=7.0, prior=0.0, z=7.0), "pad.k": Moved(value=2e7, prior=6e7, z=-4.4, unit="N/m")}
    words = (
        "; level has to be 7.00 for it, 7 standard deviations from the nominal 0"
        " and pad.k has to be 20.0 MN/m for it, 4.4 standard deviations from the nominal 60 MN/m."
    )
    recalibrated = Recalibrated(before={"slab.E": near, **far})
    found = verdict("located", effects=(LOST,), recalibrated=recalibrated).sentence
    assert found.endswith(words)
    assert "slab.E" not in found
    # A wrong stated value is stated by its own effect.
    member = ClassMember(name="owner_value", probability=1.0)
    stated = Effect(domain="path", place=Place(body="pad.k"), name="owner_value", class_=(member,))
    assert "pad.k has to be" not in verdict("named", effects=(stated,), recalibrated=recalibrated).sentence
    # What an amendment brings back is off no more.
    back = Recalibrated(before=far, after=dict.fromkeys(far, near))
    assert "has to be" not in verdict("named", effects=(LOST,), recalibrated=back).sentence


def test_a_model_that_fits_outside_a_tolerance_states_so() -> None:
    far = Moved(value=2.1e7, prior=3e7, z=-4.4, low=2e7, high=2.2e7, unit="N/m")
    near = Moved(value=1.05e9, prior=1e9, z=1.2)
    recalibrated = Recalibrated(before={"slab.E": near, "pad.k": far, "level": Moved(value=7.0, prior=0.0, z=7.0)})
    assert verdict("outside_tolerance", recalibrated=recalibrated).sentence == (
        "The model fits only with level at 7.00, in place of the stated 0 and 7 standard deviations of its "
        "tolerance away and pad.k at 21.0 MN/m (90 %: 20.0 to 22.0 MN/m), 30 % below the stated 30 MN/m and 4.4 "
        "standard deviations of its tolerance away: what is stated there is wrong, or something is missing that "
        "acts like it."
    )
    with pytest.raises(InputError, match="has no effects"):
        Verdict(status="outside_tolerance", effects=(LOST,))
    # Nor is physics ruled out where a measurement is at fault beside it.
    faulty = LOST.model_copy(update={"domain": "measurement"})
    for moved, ruled_out in ((near, True), (far, False)):
        words = verdict(
            "measurement", effects=(faulty,), recalibrated=Recalibrated(after={"pad.k": moved})
        ).sentence
        assert ("no physics is missing" in words) is ruled_out


def test_the_tolerance_of_one_parameter_is_two_deviations() -> None:
    assert limit(1) == pytest.approx(2.0, abs=1e-3)
    # As often of many parameters as of one, some lies beyond: exactly, and not only by the bound that is used.
    for count in (2, 5, 36):
        assert 1.0 - (2.0 * ndtr(limit(count)) - 1.0) ** count == pytest.approx(0.045, abs=0.001)


def test_nothing_missing_in_one_sentence() -> None:
    assert verdict("recalibrated", detectable=SMALLEST).sentence == (
        "Nothing is missing beyond what the stated tolerances allow; would have been seen: lost fasteners (a "
        "change of 38 %), deck attachment (mass above 400 kg)."
    )
    assert verdict("recalibrated").sentence == "Nothing is missing beyond what the stated tolerances allow."


def test_rivals_and_the_measurement_that_parts_them_in_one_sentence() -> None:
    effect = unnamed(("fastener_loss", 0.55), ("mortar_void", 0.4))
    assert verdict("ambiguous", effects=(effect,), next=(ADVICE,)).sentence == (
        "At pad from 20.3 to 22.4 m, 40 to 120 Hz, physics is missing that these records allow to be "
        "lost fasteners (0.55) or void below the slab (0.40); to tell lost fasteners from void below the "
        "slab, measure: a blow on the slab at 21 m."
    )


def unmet(*names: Condition, **changed: Any) -> Weight:
    """What a suspicion falls short of."""
    known = {
        "bic_gain": 12.5,
        "false_alarm_threshold": 21.0,
        "e_value": 3.2,
        "misfit_before": 9.1,
        "misfit_after": 1.0,
    }
    return Weight(**{**known, **changed}, unmet=names)


@pytest.mark.parametrize(
    ("one", "message"),
    [
        (
            verdict("described", effects=(unnamed(("novel", 0.9), law=Mechanics(words="a resonator of 7 kg")),)),
            "a resonator of 7 kg",
        ),
        (verdict("located", effects=(unnamed(),)), "At pad from 20.3 to 22.4 m"),
        (
            verdict("measurement", effects=(Effect(domain="measurement", name="sensor_gain"),)),
            "The measurement is at fault",
        ),
        (verdict("insufficient", detectable=SMALLEST), "deck attachment (mass above 400 kg)"),
        (
            verdict("insufficient", effects=(LOST,)),
            "the suspicion is lost fasteners at pad from 20.3 to 22.4 m: 0.05",
        ),
        (
            verdict("insufficient", effects=(LOST,), evidence=unmet("bic_gain", "e_value")),
            "its gain of BIC is 12.5, 21 are asked and its e-value is 3.2, 20 are asked",
        ),
        (
            verdict("insufficient", effects=(LOST,), evidence=unmet("held_out")),
            "; records that were left out are not predicted better by it",
        ),
        (verdict("insufficient", evidence=unmet("placebo")), "as many parameters elsewhere gain half as much"),
        (
            verdict("insufficient", evidence=unmet("explained_gap"), explained_gap=0.31),
            "it explains 31 % of what is missing",
        ),
        (
            verdict("insufficient", evidence=unmet("misfit", misfit_after=None)),
            "what is left has 9.1 times the mean square",
        ),
        (
            verdict("insufficient", evidence=unmet("misfit", misfit_after=7.0)),
            "what is left has 7 times the mean square",
        ),
        (
            verdict("ambiguous", effects=(LOST, unnamed(("pad_frequency", 0.5), ("pad_preload", 0.4)))),
            "under load (0.40); beside that lost fasteners at pad from 20.3 to 22.4 m: 0.05 of the stiffness is",
        ),
        (
            verdict("named", effects=(LOST, unnamed(("pad_frequency", 0.5), ("pad_preload", 0.4)))),
            "beside that pads stiffer with frequency or pads that change under load at pad from 20.3",
        ),
        (
            verdict("named", effects=(LOST.model_copy(update={"size": "factor", "parameters": SURE}),)),
            "0.05 of the stiffness is left (90 %: factor 0.050), probability 0.97",
        ),
        (verdict("located", effects=(Effect(domain="irregularity"),)), "In irregularity physics is missing"),
        (verdict("named", effects=(LOST, LOST)), "beside that more lost fasteners at pad from 20.3"),
        (
            verdict("ambiguous", effects=(LOST, *[unnamed(("fastener_loss", 0.5), ("pad_preload", 0.4))] * 2)),
            "to be more lost fasteners (0.50) or pads that change under load (0.40); beside that lost fasteners "
            "at pad from 20.3 to 22.4 m: 0.05 of the stiffness is left, probability 0.97; and another of the same "
            "names at pad from 20.3",
        ),
        (
            verdict(
                "named",
                effects=(LOST,),
                held_out={"band": HeldOutGain(gain_nats=-2.0, db_before=1.0, db_after=1.5)},
            ),
            "does not improve: from 1.0 to 1.5 dB",
        ),
    ],
)
def test_every_status_has_its_sentence(one: Verdict, message: str) -> None:
    assert message in one.sentence
    assert one.sentence.endswith(".")
    assert one.sentence.count(". ") == 0


class Cells(HTMLParser):
    """Cells of a table as text."""

    def __init__(self) -> None:
        super().__init__()
        self.cells: list[str] = []
        self._open = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in ("td", "caption"):
            self.cells.append("")
            self._open = True

    def handle_endtag(self, tag: str) -> None:
        self._open = self._open and tag not in ("td", "caption")

    def handle_data(self, data: str) -> None:
        if self._open:
            self.cells[-1] += data


def test_a_notebook_shows_a_small_table() -> None:
    sly = LOST.model_copy(update={"place": Place(joint="<script>")})
    parser = Cells()
    html = verdict("named", effects=(sly,))._repr_html_()
    parser.feed(html)
    caption, domain, place, name, rivals, values = parser.cells
    assert "0.05 of the stiffness is left" in caption
    assert (domain, place, name) == ("track and structure", "<script>", "lost fasteners")
    assert rivals == "lost fasteners 0.97, something the catalogue does not hold 0.02"
    assert values == "factor 0.05 (0.03 to 0.08)"
    assert "<script>" not in html


def test_the_sentence_states_what_was_ruled_out() -> None:
    sentence = verdict("recalibrated", ruled_out=("wheel_flat", "wheel_polygon")).sentence
    assert sentence.endswith("; not considered, for somebody had ruled it out: wheel flat, polygonal wheel.")
    assert "ruled" not in verdict("recalibrated").sentence
