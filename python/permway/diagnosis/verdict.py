"""The verdict of a diagnosis as data: what, where, how sure, how large, how proved, what to measure next.

The file `verdict.json` is this record. Its schema is published: `docs/verdict.schema.json`, explained in
`docs/verdict.md`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final, Literal, Self

from pydantic import Field, ValidationError, model_validator

from permway.diagnosis.verdict_parts import ClassMember as ClassMember
from permway.diagnosis.verdict_parts import Doubt as Doubt
from permway.diagnosis.verdict_parts import Effect as Effect
from permway.diagnosis.verdict_parts import Estimate as Estimate
from permway.diagnosis.verdict_parts import HeldOutGain as HeldOutGain
from permway.diagnosis.verdict_parts import Mechanics as Mechanics
from permway.diagnosis.verdict_parts import Moved as Moved
from permway.diagnosis.verdict_parts import NextMeasurement as NextMeasurement
from permway.diagnosis.verdict_parts import Place as Place
from permway.diagnosis.verdict_parts import Recalibrated as Recalibrated
from permway.diagnosis.verdict_parts import Share, VerdictPart
from permway.diagnosis.verdict_parts import Smallest as Smallest
from permway.diagnosis.verdict_parts import Weight as Weight
from permway.errors import InputError
from permway.files import write_text
from permway.model.faults import fault, model_error, refuse_coercion

FORMAT: Final = 1
"""Version of the schema. Another number when a key is removed or means something else."""

NOVEL = "novel"
"""The member of a class that stands for physics that the catalogue does not hold."""

Status = Literal[
    "recalibrated",
    "outside_tolerance",
    "measurement",
    "named",
    "ambiguous",
    "described",
    "located",
    "insufficient",
]
RIGHT: tuple[Status, ...] = ("recalibrated", "outside_tolerance")
"""Statuses of a model that fits without any effect."""

UNPROVED: tuple[Status, ...] = (*RIGHT, "insufficient")
"""Statuses that call nothing missing."""


class Verdict(VerdictPart):
    """What a diagnosis says."""

    format: Literal[1] = FORMAT
    """Version of the schema."""
    status: Status
    """How far the diagnosis got."""
    effects: tuple[Effect, ...] = ()
    """What is missing, strongest first; what is suspected, if the status is "insufficient"."""
    evidence: Weight = Weight()
    """How strongly the records support it."""
    held_out: dict[str, HeldOutGain] = Field(default_factory=dict)
    """By axis (speeds, channels, places, bands, repeats, ...): the gain on records that were not fitted."""
    placebo: dict[str, HeldOutGain] = Field(default_factory=dict)
    """The same of an effect with as many parameters at another place, which must not gain."""
    explained_gap: Share | None = None
    """Share of what separated the recalibrated base from the noise ceiling that the amendment closes."""
    recalibrated: Recalibrated = Recalibrated()
    """The nominal parameters before and after the amendment."""
    next: tuple[NextMeasurement, ...] = ()
    """Measurements that would separate rivals, the most decisive first."""
    detectable: dict[str, Smallest] = Field(default_factory=dict)
    """By effect: the smallest size that this campaign would have shown."""
    ruled_out: tuple[str, ...] = ()
    """Effects of the catalogue that were not considered, for somebody had ruled them out."""
    blunders: tuple[Doubt, ...] = ()
    """What is probably stated wrongly in the campaign, the surest first: to be put right before all else."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.status in RIGHT and self.effects:
            raise fault(f'the status "{self.status}" has no effects', "effects")
        if self.status not in UNPROVED and not self.effects:
            raise fault(f'the status "{self.status}" needs an effect', "effects")
        if self.evidence.unmet and self.status != "insufficient":
            raise fault('only the status "insufficient" has conditions that are not met', "evidence", "unmet")
        if self.status == "named" and self.effects[0].name is None:
            raise fault('the status "named" needs a name', "effects", 0, "name")
        if self.status == "ambiguous" and all(effect.name is not None for effect in self.effects):
            raise fault('the status "ambiguous" needs an effect without a name', "effects")
        return self

    @property
    def amended(self) -> bool:
        """Whether the verdict has an amended model: of what is missing, or of a suspicion."""
        return self.explained_gap is not None

    @property
    def sentence(self) -> str:
        """The verdict in one plain sentence."""
        from permway.diagnosis.verdict_words import sentence

        return sentence(self)

    def _repr_html_(self) -> str:
        from permway.diagnosis.verdict_table import html_table

        return html_table(self)

    def to_json(self) -> str:
        """As JSON: every key, in the schema's order, finite numbers or null."""
        table = self.model_dump(mode="json", by_alias=True)
        return json.dumps(table, allow_nan=False, ensure_ascii=False, indent=2) + "\n"

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Read what :meth:`to_json` wrote.

        Raises
        ------
        InputError
            If the text is not JSON, not of this version, or holds what the schema does not allow.
        """
        try:
            table = json.loads(text, parse_constant=_refuse)
        except (ValueError, RecursionError) as error:
            raise InputError(f"is not JSON: {error}", where="verdict") from error
        if not isinstance(table, dict):
            raise InputError("must be a table", where="verdict")
        if table.get("format") != FORMAT:
            remedy = f"this version of permway reads format {FORMAT}"
            raise InputError("of another version", where="format", value=table.get("format"), remedy=remedy)
        try:
            found = cls.model_validate(table)
        except ValidationError as error:
            raise model_error(error, table, "") from error
        refuse_coercion(table, found, "")
        return found

    def write(self, path: Path) -> Path:
        """Write `verdict.json`, whole or not at all.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        return write_text(Path(path), self.to_json())

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read `verdict.json`.

        Raises
        ------
        InputError
            With the file, as :meth:`from_json`.
        """
        try:
            text = Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"cannot be read: {error}", where=str(path)) from error
        try:
            return cls.from_json(text)
        except InputError as error:
            where = f"{path}: {error.where}"
            raise InputError(error.what, where=where, value=error.value, remedy=error.remedy) from error


def json_schema() -> dict[str, Any]:
    """The published schema (JSON Schema, draft 2020-12)."""
    schema = Verdict.model_json_schema(by_alias=True, mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _refuse(text: str) -> None:
    raise ValueError(f"{text} is no number")
