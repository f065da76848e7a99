"""What a verdict is made of: effects with their places, and what supports them.

Docstrings of keys go into the published schema.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, ConfigDict, Field, model_validator

from permway.diagnosis.hypothesis import Domain, Where
from permway.model.faults import fault
from permway.model.line import Line
from permway.records import FrozenModel, Number


def _ascending(pair: tuple[float, float]) -> tuple[float, float]:
    if not pair[0] <= pair[1]:
        raise fault("must run from low to high", value=pair)
    return pair


def _rounded(pair: tuple[float, float] | None) -> tuple[float, float] | None:
    """To a micrometre: digits beyond are of the arithmetic."""
    return None if pair is None else (round(pair[0], 6), round(pair[1], 6))


Span = Annotated[tuple[Number, Number], AfterValidator(_ascending)]
Share = Annotated[float, Field(ge=0.0, le=1.0, strict=True)]
Positive = Annotated[float, Field(ge=0.0, strict=True)]
Named = Annotated[str, Field(min_length=1)]


class VerdictPart(FrozenModel):
    """A table of the verdict, whose keys' docstrings go into the schema."""

    model_config = ConfigDict(
        use_attribute_docstrings=True, populate_by_name=True, json_schema_serialization_defaults_required=True
    )


class Place(VerdictPart):
    """Where an effect is. Of `body` and `joint` at most one is not null."""

    body: str | None = None
    """Name of a body of the line, or of what is changed in the vehicle."""
    joint: str | None = None
    """Name of the law of a layer of joints."""
    x: Span | None = None
    """From and to along the line, m: the stretch that is changed."""
    within: Span | None = None
    """The stretch that holds the place with 90 %, m."""
    channels: tuple[str, ...] = ()
    """Sensors, of a fault in the measurement or of one wheelset."""

    @classmethod
    def of(cls, where: Where, line: Line, *, within: tuple[float, float] | None = None) -> Self:
        """The place that a hypothesis names, which is a law's joints or a body of the line."""
        joint = where.what in line.laws
        return cls(
            body=None if joint or not where.what else where.what,
            joint=where.what if joint else None,
            x=_rounded(where.x_m),
            within=_rounded(within),
            channels=where.channels,
        )

    @property
    def label(self) -> str:
        """For people; "" if there is none in particular."""
        return Where(self.body or self.joint or "", self.x, self.channels).label


class ClassMember(VerdictPart):
    """An effect that the data allow."""

    name: Named
    """An effect's id in the catalogue, or "novel"."""
    probability: Share
    """A posteriori, among all that was tried."""


class Mechanics(VerdictPart):
    """The law that was missing."""

    words: str = ""
    """Mechanical description."""
    type: str | None = None
    """Type of the law, as in a model file."""
    parameters: dict[str, Number | str | tuple[Number, ...]] = Field(default_factory=dict)
    """The law's parameters, as in a model file."""


class Estimate(VerdictPart):
    """A parameter of an effect."""

    value: Number
    """Most probable value."""
    unit: str
    """SI; "" or "1" of a ratio."""
    low: Number | None = None
    """Lower end of the 90 % interval."""
    high: Number | None = None
    """Upper end of the 90 % interval."""


class Effect(VerdictPart):
    """Something that the model lacks."""

    domain: Domain
    """What it is part of."""
    place: Place = Place()
    """Where it is."""
    bands: tuple[Span, ...] = ()
    """Bands in which it shows, each from and to in Hz."""
    name: Named | None = None
    """Its id in the catalogue, or what screening calls it; null if the data allow several, or none fits."""
    class_: tuple[ClassMember, ...] = Field(default=(), alias="class")
    """Effects that these data cannot separate, the most probable first."""
    law: Mechanics = Mechanics()
    """Its mechanics."""
    parameters: dict[str, Estimate] = Field(default_factory=dict)
    """Its parameters with 90 % intervals."""
    size: Named | None = None
    """The one of them that says how strong it is; null if none does, or none is known to."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.place.body is not None and self.place.joint is not None:
            raise fault("is a body or a joint, not both", "place", value=self.place.label)
        if sum(member.probability for member in self.class_) > 1.0 + 1e-6:
            raise fault("the probabilities sum to more than 1", "class")
        return self


E_VALUE = 20.0
"""From which an e-value supports an effect."""

Condition = Literal["bic_gain", "e_value", "held_out", "placebo", "explained_gap", "misfit"]
"""What a suspicion has to meet to be called missing."""


class Weight(VerdictPart):
    """How strongly the records support the effects together, against the recalibrated base."""

    bic_gain: Number | None = None
    """Gain of BIC."""
    log10_bayes_factor: Number | None = None
    """Common logarithm of the Bayes factor."""
    e_value: Positive | None = None
    """Split-likelihood e-value on records that were not fitted: 20 is the bar."""
    false_alarm_threshold: Number | None = None
    """Gain of BIC that 95 of 100 campaigns of this layout stay below if nothing is missing."""
    misfit_before: Positive | None = None
    """Mean square of what the recalibrated base leaves, over what noise and calibration errors explain: 1 fits."""
    misfit_after: Positive | None = None
    """The same of the amended model: well above 1 the effects are not all that is missing, or not quite it."""
    unmet: tuple[Condition, ...] = ()
    """Conditions that a suspicion does not meet; empty where something is called missing, or nothing is."""


class Doubt(VerdictPart):
    """Something that was probably stated wrongly, found before any physics; see `permway check`."""

    kind: Named
    """What kind of blunder, as "factor", "sign" or "labels"."""
    where: str
    """Record, and the sensors or points concerned."""
    what: str
    """In words."""
    remedy: str
    """What to write in the campaign file."""
    log_odds: Number | None = None
    """Natural logarithm of the odds that it is so; null where it does not rest on levels or phases."""
    asked: bool = False
    """Whether it is a question: it may be right as it is."""


class HeldOutGain(VerdictPart):
    """What the amendment gains on records that were not fitted."""

    gain_nats: Number
    """Gain of log predictive density."""
    standard_error: Positive | None = None
    """Of the gain, nats."""
    db_before: Positive | None = None
    """Root mean square error of levels as measured, line by line or band by band, recalibrated, dB."""
    db_after: Positive | None = None
    """The same of the amended model, dB."""


class Moved(VerdictPart):
    """A parameter of the nominal model as recalibration has it."""

    value: Number
    """Recalibrated value."""
    prior: Number
    """The nominal value."""
    z: Number
    """Value less prior in standard deviations of the tolerance."""
    low: Number | None = None
    """Lower end of the 90 % interval by the fit's covariance."""
    high: Number | None = None
    """Upper end of the 90 % interval."""
    unit: str = "1"
    """Of value and interval; "1" of a ratio, and where an older file does not say."""


class Recalibrated(VerdictPart):
    """The nominal parameters before and after the amendment."""

    before: dict[str, Moved] = Field(default_factory=dict)
    """Recalibrated without any amendment."""
    after: dict[str, Moved] = Field(default_factory=dict)
    """Recalibrated together with the amendment; empty without one."""


RECALIBRATED = "recalibrated"
"""What rivals a suspicion: that nothing is missing."""


class NextMeasurement(VerdictPart):
    """A measurement that would separate two rivals."""

    measurement: Named
    """What to measure, in words."""
    separates: tuple[Named, Named]
    """The two rivals; "recalibrated" is that nothing is missing."""
    separation_before: Number
    """Difference of their best fits in deviance, with the records there are."""
    separation_after: Number
    """The same with the measurement, as expected."""


class Smallest(VerdictPart):
    """The smallest size of an effect that these records would have shown."""

    parameter: Named
    """What says how strong the effect is."""
    value: Number | None
    """The smallest size; null if none within the effect's range would have been seen."""
    unit: str
    """SI; "" or "1" of a ratio."""
    none: Number | None = 0.0
    """Value without effect, null at infinity: what lies farther from it than `value` would have been seen."""
