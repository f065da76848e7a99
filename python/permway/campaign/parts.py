"""What a campaign file is made of besides sensors and parameters: conditions, records, irregularity, groups."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, PositiveFloat, StrictBool, model_validator

from permway.arrays import COLDEST_C, HOTTEST_C, Reals
from permway.campaign.excitation import Dips, Push, Rolling, RoughBand, TrackLines, WheelLines
from permway.errors import InputError
from permway.model.faults import fault
from permway.model.irregularity_spectra import FASTEST_M_PER_S
from permway.recordings.passing_axles import PassingAxles
from permway.recordings.readers.hints import Hints
from permway.records import FrozenModel, Number

Statistic = Literal["frf", "csd", "psd", "bands", "decay", "transmissibility", "material", "modes", "passage"]

KIND_OF: dict[str, tuple[str, ...]] = {
    "frf": ("hammer", "shaker"),
    "csd": ("train",),
    "psd": ("train",),
    "bands": ("train", "table"),
    "decay": ("hammer", "table"),
    "transmissibility": ("shaker",),
    "material": ("table",),
    "modes": ("hammer", "shaker", "table"),
    "passage": ("passage",),
}
"""Kinds of condition that a statistic can be of."""

IN_TIME = ("csd", "psd", "passage")
"""Statistics of records that are samples over time."""


class Condition(FrozenModel):
    """What stayed the same while records were taken.

    Parameters
    ----------
    name : str
    kind : "hammer", "train", "shaker", "table" or "passage"
    temperature_C : float, optional
    speed_m_per_s : float, optional
        Of the train, or of the axles that pass.
    axles : PassingAxles, optional
        Of a passage.
    centre_m : float, optional
        Where the middle of the train stands in the model; by default as the model has it.
    wheels_m : sequence of float, optional
        Where the wheels stand in the model, the leading one first; by default as vehicle and `centre_m` say.
    level : float, optional
        How hard is driven: of a drive, a drop height, an amplitude, in the same unit wherever it is given.
    load_N, date, note : optional
    factors : dict of path to float
        Numbers of the model file that are others under this condition, and what they are multiplied by.
    """

    name: str = Field(min_length=1)
    kind: Literal["hammer", "train", "shaker", "table", "passage"]
    temperature_C: Number | None = Field(default=None, ge=COLDEST_C, le=HOTTEST_C)
    speed_m_per_s: Number | None = Field(default=None, gt=0.0, le=FASTEST_M_PER_S)
    centre_m: Number | None = None
    wheels_m: tuple[Number, ...] | None = Field(default=None, min_length=1)
    axles: PassingAxles | None = None
    level: PositiveFloat | None = None
    load_N: Number | None = None
    date: str | None = None
    note: str = ""
    factors: dict[str, Annotated[Number, Field(gt=0.0, le=1e6)]] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _read_speed(cls, table: Any) -> Any:
        if not isinstance(table, dict) or "speed_km_per_h" not in table:
            return table
        rest = dict(table)
        speed = rest.pop("speed_km_per_h")
        if "speed_m_per_s" in rest:
            raise fault("the speed is given twice: give speed_m_per_s or speed_km_per_h", "speed_km_per_h")
        if isinstance(speed, bool) or not isinstance(speed, int | float):
            raise fault("must be a number", "speed_km_per_h", value=speed)
        return {**rest, "speed_m_per_s": speed / 3.6}

    @model_validator(mode="after")
    def _check(self) -> Condition:
        train = (self.speed_m_per_s, self.centre_m, self.wheels_m)
        if self.kind == "train" and self.speed_m_per_s is None:
            raise fault("a train needs speed_m_per_s or speed_km_per_h", "speed_m_per_s")
        if self.kind == "passage" and self.speed_m_per_s is None:
            raise fault("axles need speed_m_per_s or speed_km_per_h", "speed_m_per_s")
        if (self.axles is not None) != (self.kind == "passage"):
            raise fault('goes with kind = "passage", which needs it', "axles")
        if self.kind == "passage" and train[1:] != (None, None):
            raise fault("wheels are of a train that stands; of a passage are the axles", "kind")
        if self.kind not in ("train", "passage") and train != (None, None, None):
            raise fault(f'speed and wheels are of a train, and the kind is "{self.kind}"', "kind")
        if self.wheels_m is not None and self.centre_m is not None:
            raise fault("give wheels_m or centre_m", "centre_m")
        if self.wheels_m is not None and any(
            b >= a for a, b in zip(self.wheels_m, self.wheels_m[1:], strict=False)
        ):
            raise fault("the leading wheel first, which is the one of largest x", "wheels_m", value=self.wheels_m)
        return self


def _labels(value: object) -> object:
    if isinstance(value, list | tuple) and all(isinstance(label, str) for label in value):
        if len(set(value)) < len(value):
            raise fault(f"{max(value, key=list(value).count)!r} stands twice", value=value)
        return {label: label for label in value}
    return value


Labels = Annotated[dict[str, str], BeforeValidator(_labels)]
"""File's labels to names; as a list where the labels are the names."""


def _band(value: object) -> object:
    if isinstance(value, list | tuple) and len(value) == 2:
        low, high = value
        if isinstance(low, int | float) and isinstance(high, int | float) and not 0.0 <= low < high:
            raise fault("must run from low to high", value=value)
    return value


Band = Annotated[tuple[Number, Number], BeforeValidator(_band)]
"""From and to, Hz."""


_HINTS = ("header_row", "skip_rows", "time_column", "decimal", "encoding", "unit", "axes", "pairs")


class Record(FrozenModel):
    """A file, what is in it, and what is made of it.

    Parameters
    ----------
    name : str
    file : str
        Beside the campaign file, or in a folder below it.
    format : str, optional
        By default reported from the file's content and name.
    part : str, optional
        Group or array of a file that holds several.
    condition : str
    statistic : "frf", "csd", "psd", "bands", "decay", "transmissibility", "material", "modes"
        or "passage"
    repeat : int
        Number of this repeat, from 1.
    channels : dict of file's label to sensor
        Of records in time and of tables; of modes the sensors that they were seen at.
    responses, references : dict of file's label to sensor, and to force point
        Of frequency responses; the force points are in [[forces]]. Labels that are names may be a list.
    averages : float, optional
        Averages behind an FRF, if the file does not say. Of "csd" and "psd" it states that the file holds spectra,
        not samples, and how many independent averages are behind them.
    noise : "coherence" or "scatter"
        What states the noise of an FRF: coherence and averages, or how far neighbouring lines scatter
        (:mod:`permway.recordings.line_scatter`), where the file has no coherence.
    lines_per_frequency : float
        Of an FRF: lines within its own frequency that a diagnosis uses at most. A resonance of loss factor eta is
        seen with 2 / eta of them and more.
    band_Hz : (low, high), optional
        What of the record is used; by default all.
    sampling_Hz : float, optional
        Of a record in time whose file does not say it. It wins over a remark in a text; with times or a rate of
        the file's own the two must agree, but for `time_column = "none"`.
    header_row, skip_rows, time_column, decimal, encoding, unit, axes, pairs
        What the file does not say or states wrongly, and wins over it; see
        :class:`permway.recordings.readers.hints.Hints`.
    segment_s : float
        Length of a Welch segment, which for Hann's window sets the lines apart by its inverse.
    interpolated_Hz : sequence of (from, step), optional
        For records that were computed: the lines between which their transfer functions were interpolated
        linearly, as [[0, 0.5], [30, 1]] for every 0.5 Hz up to 30 Hz and every 1 Hz above. Between lines what
        comes late is weakened.
    window_s : float, optional
        Of a passage: how long its prediction is, in which the line must come to rest; by default longer than
        record and passage by a passage, and by six times the decay of the slowest mode.
    spacing_m : float, optional
        Of decay rates by EN 15461: distance of the fasteners, which sets the places of the blows.
    select : dict
        Of a table: what its rows must say, as {rail = "li", dir = "v"}.
    loss_file : str, optional
        Of a material whose storage modulus is in `file` and whose loss factor is in another.
    law : str, optional
        Of a material's table: path of the law in the model file, as "line.laws.pad.material".
    within_dB : float, optional
        Of a transmissibility or a material: two standard deviations of what its instruments get wrong, smoothly
        over frequency. By default nobody knows, and a diagnosis learns it.
    """

    name: str = Field(min_length=1)
    file: str = Field(min_length=1)
    format: str | None = None
    part: str | None = None
    condition: str
    statistic: Statistic
    repeat: int = Field(default=1, ge=1, strict=True)
    channels: Labels = Field(default_factory=dict)
    responses: Labels = Field(default_factory=dict)
    references: Labels = Field(default_factory=dict)
    averages: PositiveFloat | None = None
    noise: Literal["coherence", "scatter"] = "coherence"
    lines_per_frequency: PositiveFloat | None = None
    band_Hz: Band | None = None
    sampling_Hz: PositiveFloat | None = None
    segment_s: PositiveFloat = 1.0
    interpolated_Hz: tuple[tuple[Number, Number], ...] | None = Field(default=None, min_length=1)
    window_s: PositiveFloat | None = None
    spacing_m: PositiveFloat | None = None
    select: dict[str, str | Number | bool] = Field(default_factory=dict)
    loss_file: str | None = None
    law: str | None = None
    within_dB: PositiveFloat | None = None
    header_row: int | None = Field(default=None, ge=0, strict=True)
    skip_rows: int | None = Field(default=None, ge=0, strict=True)
    time_column: str | None = Field(default=None, min_length=1)
    decimal: Literal[".", ","] | None = None
    encoding: str | None = None
    unit: str | dict[str, str] | None = None
    axes: tuple[str, str, str] | None = None
    pairs: dict[str, tuple[str, str]] | None = None

    @property
    def sampled(self) -> bool:
        """Whether its file holds samples over time."""
        return self.statistic in IN_TIME and self.averages is None

    @property
    def spectral(self) -> bool:
        """Whether it holds power and cross spectra, of a run or computed."""
        return self.statistic in ("csd", "psd")

    @property
    def hints(self) -> Hints:
        """What is stated about how its file is read."""
        return Hints(**{key: getattr(self, key) for key in _HINTS})

    @model_validator(mode="after")
    def _check(self) -> Record:
        frf = self.statistic == "frf"
        self._check_hints()
        if frf and self.channels:
            raise fault("an FRF has responses and references", "channels")
        if not frf and (self.responses or self.references):
            what = f'responses and references are of an FRF; a record of "{self.statistic}" has channels'
            raise fault(what, "responses" if self.responses else "references")
        for key, wanted in (("responses", frf), ("references", frf), ("channels", self._needs_channels)):
            if wanted and not getattr(self, key):
                raise fault("missing: say which of the file's labels is what", key)
        for key in ("channels", "responses", "references"):
            names = list(getattr(self, key).values())
            twice = [name for name in names if names.count(name) > 1]
            if twice:
                raise fault(f"{twice[0]!r} stands twice", key)
        if (self.law is not None) != (self.statistic == "material"):
            raise fault('goes with statistic = "material", which needs it', "law")
        if (self.spacing_m is not None) != (self.statistic == "decay"):
            raise fault('goes with statistic = "decay", which needs it', "spacing_m")
        if self.loss_file is not None and self.law is None:
            raise fault('goes with statistic = "material"', "loss_file")
        if self.averages is not None and self.statistic not in ("frf", "csd", "psd"):
            raise fault('goes with statistic "frf", or with "csd" or "psd" of a file of spectra', "averages")
        if self.noise == "scatter" and (not frf or self.averages is not None):
            raise fault('"scatter" goes with statistic = "frf", and without averages', "noise")
        if self.lines_per_frequency is not None and not frf:
            raise fault('goes with statistic = "frf"', "lines_per_frequency")
        if not frf and self.averages is not None and self.sampling_Hz is not None:
            raise fault("averages say that the file holds spectra, which have no sampling_Hz", "averages")
        if self.within_dB is not None and self.statistic not in ("transmissibility", "material"):
            raise fault('goes with statistic "transmissibility" or "material"', "within_dB")
        _check_lines(self.interpolated_Hz or ())
        if self.interpolated_Hz is not None and not self.spectral:
            raise fault('goes with statistic "csd" or "psd"', "interpolated_Hz")
        if self.sampling_Hz is not None and self.statistic not in IN_TIME:
            raise fault('goes with statistic "csd", "psd" or "passage"', "sampling_Hz")
        if self.window_s is not None and self.statistic != "passage":
            raise fault('goes with statistic = "passage"', "window_s")
        if self.statistic == "passage" and self.band_Hz is None:
            raise fault("missing: a passage is predicted up to the end of its band", "band_Hz")
        return self

    def _check_hints(self) -> None:
        try:
            _ = self.hints
        except InputError as error:
            raise fault(f"{error.what}; {error.remedy}", error.where, value=error.value) from error
        for key in _HINTS:
            of_frf = key in ("axes", "pairs")
            wanted = ("frf",) if of_frf else IN_TIME if key == "time_column" else ("frf", *IN_TIME)
            if getattr(self, key) is not None and self.statistic not in wanted:
                raise fault(f"goes with statistic {' or '.join(map(repr, wanted))}", key)

    @property
    def _needs_channels(self) -> bool:
        return self.statistic in ("csd", "psd", "bands", "transmissibility", "decay", "modes", "passage")


def _check_lines(ranges: Sequence[tuple[float, float]]) -> None:
    for index, (start, step) in enumerate(ranges):
        if not step > 0.0:
            raise fault("the step must be above 0 Hz", "interpolated_Hz", index, value=step)
        if index == 0 and start != 0.0:
            raise fault("the first step counts from 0 Hz", "interpolated_Hz", 0, value=start)
        if index and not start > ranges[index - 1][0]:
            raise fault("must ascend", "interpolated_Hz", index, value=start)
        before = (start - ranges[index - 1][0]) / ranges[index - 1][1] if index else 0.0
        if abs(before - round(before)) > 1e-9:
            raise fault(
                "must lie a whole number of steps above the one before", "interpolated_Hz", index, value=start
            )


class IrregularityKnown(FrozenModel):
    """What is known of the irregularity that the model file names.

    Parameters
    ----------
    knowledge : "known", "within" or "unknown"
        "within": to `within_dB`, two standard deviations; "unknown": its level and slope are free.
    within_dB : float, optional
    level_dB : float
        Added to the model's density, 10 lg.
    slope_dB_per_octave : float
        Added per doubling of the wavenumber, about 1 rad/m.
    shape_dB : sequence of (float, float)
        Added at wavelengths, m, the shortest first: dB, straight between logarithms, and beyond as at the ends.
    level_by_condition_dB : dict of str to float
        Added to the density under some conditions, by name.
    contact_patch_m : float
        Half length a of the patch that filters short waves: density over 1 + pi/4 (k a)^3, k the wavenumber.
    bands : sequence of RoughBand
    dips : sequence of Dips
    series : sequence of TrackLines
    wheels : sequence of WheelLines
    wheel_radius_m : float
        Rolling radius, which sets where the lines of `wheels` lie.
    pushes : sequence of Push
    rolling : Rolling or bool, optional
        By default trains roll over the model's own supports where these repeat and the rail reaches far enough
        (:mod:`permway.campaign.rolls`). True: they do, or it is an error; false: they stand. A campaign that is
        read has, for default and true, the supports that were found, or none where trains stand.
    """

    knowledge: Literal["known", "within", "unknown"] = "known"
    within_dB: PositiveFloat | None = None
    level_dB: Number = Field(default=0.0, ge=-60.0, le=60.0)
    slope_dB_per_octave: Number = Field(default=0.0, ge=-20.0, le=20.0)
    shape_dB: tuple[tuple[PositiveFloat, Annotated[Number, Field(ge=-60.0, le=60.0)]], ...] = ()
    level_by_condition_dB: dict[str, Annotated[Number, Field(ge=-60.0, le=60.0)]] = Field(default_factory=dict)
    contact_patch_m: float = Field(default=0.0, ge=0.0, le=1.0)
    bands: tuple[RoughBand, ...] = ()
    dips: tuple[Dips, ...] = ()
    series: tuple[TrackLines, ...] = ()
    wheels: tuple[WheelLines, ...] = ()
    wheel_radius_m: float = Field(default=0.43, gt=0.1, lt=1.5)
    pushes: tuple[Push, ...] = ()
    rolling: Rolling | StrictBool | None = None

    @property
    def rolls(self) -> Rolling | None:
        """What trains roll over; None where they stand."""
        return self.rolling if isinstance(self.rolling, Rolling) else None

    @model_validator(mode="after")
    def _check(self) -> IrregularityKnown:
        if (self.within_dB is not None) != (self.knowledge == "within"):
            raise fault('goes with knowledge = "within", which needs it', "within_dB")
        for index, ((shorter, _), (longer, _)) in enumerate(pairwise(self.shape_dB), start=1):
            if longer <= shorter:
                raise fault("must be longer than the wavelength before", "shape_dB", index, 0, value=longer)
        return self

    def shape_at(self, wavelength_m: Reals) -> Reals:
        """What `shape_dB` adds at wavelengths, dB."""
        if not self.shape_dB:
            return np.zeros(np.shape(wavelength_m))
        at_m, added = np.array(self.shape_dB).T
        return np.asarray(np.interp(np.log(wavelength_m), np.log(at_m), added))


class HeldOut(FrozenModel):
    """A group of data that is not fitted, to hold what was fitted against.

    Parameters
    ----------
    name : str
    axis : "record", "speed", "temperature", "channel", "place" or "band"
    members : sequence of str or float
        Records or sensors by name; speeds in m/s; temperatures in degrees Celsius.
    band_Hz, from_to_m : (low, high), optional
        Instead of members, of a band and of a place.
    """

    name: str = Field(min_length=1)
    axis: Literal["record", "speed", "temperature", "channel", "place", "band"]
    members: tuple[str | Number, ...] = ()
    band_Hz: Band | None = None
    from_to_m: tuple[Number, Number] | None = None

    @model_validator(mode="after")
    def _check(self) -> HeldOut:
        has = {"members": bool(self.members), "band_Hz": self.band_Hz, "from_to_m": self.from_to_m}
        wanted = {"band": "band_Hz", "place": "from_to_m"}.get(self.axis, "members")
        for key, value in has.items():
            if key != wanted and value not in (None, False):
                raise fault(f"does not go with the axis {self.axis!r}, which has {wanted}", key)
        if has[wanted] in (None, False):
            raise fault(f"missing: the axis {self.axis!r} needs it", wanted)
        words = self.axis in ("record", "channel")
        for index, member in enumerate(self.members):
            if isinstance(member, str) != words:
                raise fault("must be a name" if words else "must be a number", "members", index, value=member)
        return self
