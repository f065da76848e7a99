"""The campaign file: recordings with their conditions and sensors, and the model as the user believes it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pydantic import Field, ValidationError

from permway.campaign.checks import check_campaign
from permway.campaign.excitation import About
from permway.campaign.parameters import Parameter
from permway.campaign.parts import Condition, HeldOut, IrregularityKnown, Record
from permway.campaign.rolls import how_trains_run, rolling_stated
from permway.campaign.values import ParameterSet
from permway.errors import InputError
from permway.formats.model_file import read_model
from permway.model.faults import model_error, refuse_coercion
from permway.notebook import Shown
from permway.problem.model import Model
from permway.reading import inside, read_toml
from permway.recordings.channel import Point, Sensor
from permway.records import FrozenModel

if TYPE_CHECKING:
    from permway.campaign.load import Dataset
    from permway.recordings.record import TimeRecord

Named = TypeVar("Named", Sensor, Point, Condition)


class CampaignFile(FrozenModel):
    """A campaign file, as it states it.

    Parameters
    ----------
    format : 1
        Version of the file format.
    title : str
    model : str
        Name of the model file, beside the campaign file or in a folder below it.
    allow_outside : bool
        States that `model` or the files of records lie outside the campaign's folder on purpose. It allows
        nothing: whoever reads the campaign does.
    parameters : sequence of Parameter
    sensors : sequence of Sensor
    forces : sequence of Point
    conditions : sequence of Condition
    irregularity : IrregularityKnown, optional
    records : sequence of Record
    held_out : sequence of HeldOut
    """

    format: Literal[1] = 1
    title: str = ""
    model: str = Field(min_length=1)
    allow_outside: bool = False
    parameters: tuple[Parameter, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    forces: tuple[Point, ...] = ()
    conditions: tuple[Condition, ...] = Field(min_length=1)
    irregularity: IrregularityKnown = IrregularityKnown()
    records: tuple[Record, ...] = Field(min_length=1)
    held_out: tuple[HeldOut, ...] = ()


@dataclass(frozen=True)
class Campaign(Shown):
    """A campaign that was read and checked.

    Attributes
    ----------
    stated : Stated
        The file.
    model : Model
        As the user believes it.
    folder : Path
        Where the campaign file lies.
    parameters : ParameterSet
        Resolved against the model.
    file : str
        Name of the campaign file in the folder.
    """

    stated: CampaignFile
    model: Model
    folder: Path
    parameters: ParameterSet = field(repr=False, compare=False)
    file: str = field(default="campaign.toml", compare=False)

    def sensor(self, name: str) -> Sensor:
        """The sensor of that name."""
        return _named(self._sensors, name, "sensors")

    def point(self, name: str) -> Point:
        """The force point of that name."""
        return _named(self._points, name, "forces")

    def condition(self, name: str) -> Condition:
        """The condition of that name."""
        return _named(self._conditions, name, "conditions")

    @cached_property
    def _sensors(self) -> dict[str, Sensor]:
        return {sensor.name: sensor for sensor in self.stated.sensors}

    @cached_property
    def _points(self) -> dict[str, Point]:
        return {point.name: point for point in self.stated.forces}

    @cached_property
    def _conditions(self) -> dict[str, Condition]:
        return {condition.name: condition for condition in self.stated.conditions}

    def path(self, record: Record) -> Path:
        """Where the file of a record lies."""
        return self.folder / record.file

    def samples(self, record: Record) -> Iterator[TimeRecord]:
        """The samples of a record over time, in blocks, in the units that its sensors state."""
        from permway.recordings.readers import time_blocks

        return time_blocks(
            self.path(record),
            channels=list(record.channels),
            units={label: self.sensor(name).unit for label, name in record.channels.items()},
            sampling_Hz=record.sampling_Hz,
            format=record.format,
            part=record.part,
            hints=record.hints,
        )

    def model_with(self, values: Mapping[str, float]) -> Model:
        """The model with other values of parameters; those not named keep their nominal.

        Raises
        ------
        InputError
            For a name that is no parameter, a value out of its bounds, or one that the model refuses.
        """
        return self.parameters.changed(values)[0]

    def with_values(self, values: Mapping[str, float]) -> Campaign:
        """The campaign with other values, also of sensors' chains and of conditions.

        Its `parameters` stay those of the file, so values count from the nominal belief as before.

        Raises
        ------
        InputError
            As :meth:`model_with`.
        """
        model, stated = self.parameters.changed(values)
        return replace(self, stated=stated, model=model)

    def with_model(self, model: Model) -> Campaign:
        """The campaign with another model, as an amendment makes it of the nominal.

        Parameters keep their names, nominals and priors, and act on the new model; one whose numbers it no longer
        has (of a law that was replaced) acts no more.
        """
        return replace(self, model=model, parameters=self.parameters.on(model))

    def rolling_about(self, other: Campaign) -> Campaign:
        """The campaign whose trains roll over the supports of another's line, at its speeds; see :class:`About`.

        One whose trains stand stays as it is.
        """
        known = self.stated.irregularity
        if known.rolls is None:
            return self
        warm = other.model.temperature_C
        runs = {
            c.name: (c.speed_m_per_s, warm if c.temperature_C is None else c.temperature_C)
            for c in other.stated.conditions
            if c.kind == "train" and c.speed_m_per_s
        }
        rolling = known.rolls.model_copy(update={"about": About(other.model.line, runs)})
        irregularity = known.model_copy(update={"rolling": rolling})
        stated = self.stated.model_copy(update={"irregularity": irregularity})
        return replace(self, stated=stated, parameters=self.parameters.restated(stated))

    def with_records(self, records: Sequence[Record]) -> Campaign:
        """The campaign with some of its records, or of their channels, alone."""
        stated = self.stated.model_copy(update={"records": tuple(records)})
        return replace(self, stated=stated)

    def summary(self) -> dict[str, str | int]:
        """What there is, for people and machines."""
        runs = how_trains_run(self.stated, self.model)
        return {
            "campaign": str(self.folder / self.file),
            "title": self.stated.title,
            "records": len(self.stated.records),
            "sensors": len(self.stated.sensors),
            "parameters": len(self.stated.parameters),
            "held_out": len(self.stated.held_out),
            **({} if runs is None else {"trains": runs}),
        }

    def load(self) -> list[Dataset]:
        """Read all records into labelled datasets; see :mod:`permway.campaign.load`."""
        from permway.campaign.load import load

        return load(self)


def read_campaign(path: str | Path, *, allow_outside: bool = False) -> Campaign:
    """Read and check a campaign file; the records are only seen to be there.

    Parameters
    ----------
    path : path
        TOML; see `docs/campaign-file.md`.
    allow_outside : bool
        Whether the model and the records may lie outside the campaign's folder: of one's own campaigns, not of
        those that others sent.

    Raises
    ------
    InputError
        With file, place in the file, value and remedy.
    """
    if not isinstance(path, str | Path):
        raise InputError(f"must be the path of a campaign file, not a {type(path).__name__}", where="path")
    path = Path(path)
    table = read_toml(path, "name a campaign file (TOML)")
    try:
        read = campaign_from_dict(table, folder=path.parent, allow_outside=allow_outside)
    except InputError as error:
        raise InputError(
            error.what, where=f"{path}: {error.where}", value=error.value, remedy=error.remedy
        ) from error
    return replace(read, file=path.name)


def campaign_from_dict(table: Mapping[str, Any], *, folder: Path, allow_outside: bool = False) -> Campaign:
    """Build a campaign from a table, as TOML gives it.

    Parameters
    ----------
    table : mapping
    folder : path
        Where the model file and the records lie.
    allow_outside : bool
        As of :func:`read_campaign`.

    Raises
    ------
    InputError
        With the place in the table.
    """
    try:
        stated = CampaignFile.model_validate(dict(table))
    except ValidationError as error:
        raise model_error(error, table, "") from error
    refuse_coercion(table, stated, "")
    model_path = beside(stated.model, folder, "model", outside=allow_outside)
    try:
        model = read_model(model_path)
    except InputError as error:
        raise InputError(
            error.what, where=f"model: {error.where}", value=error.value, remedy=error.remedy
        ) from error
    for index, record in enumerate(stated.records):
        for key, name in (("file", record.file), ("loss_file", record.loss_file)):
            where = f"records[{index}].{key}"
            if name is not None and not beside(name, folder, where, outside=allow_outside).is_file():
                raise InputError("there is no such file", where=where, value=name)
    check_campaign(stated, model)
    stated = rolling_stated(stated, model)
    raw = read_toml(model_path, "name a model file (TOML)")
    read = Campaign(stated, model, folder, ParameterSet(stated.parameters, model, raw, stated, model_path.parent))
    return read.rolling_about(read)


def beside(name: str, folder: Path, where: str, *, outside: bool) -> Path:
    """The path of a file that a campaign names.

    Raises
    ------
    InputError
        For a name that leads out of the folder, unless that is allowed.
    """
    remedy = "put it beside the campaign file, or allow it: --allow-outside, in Python allow_outside=True"
    return inside(name, folder, where=where, of="the campaign's", remedy=remedy, outside=outside)


def _named(items: Mapping[str, Named], name: str, where: str) -> Named:
    if name not in items:
        raise InputError("there is none of that name", where=where, value=name)
    return items[name]
