"""Records by the tool's own prediction of an amended campaign, with the hypotheses of its own catalogue.

The truth then is in the class of models that a diagnosis searches, and a wrong answer has no excuse.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.campaign.parameters import Parameter
from permway.campaign.predict import predict
from permway.campaign.values import ParameterSet
from permway.challenge.beams import Complexes, Reals
from permway.challenge.small.concealed import Concealed, displaced
from permway.challenge.small.layouts import Layout
from permway.challenge.small.outside_model import outside
from permway.challenge.small.places import BLOWS, RUN_BAND_HZ, RUN_S, Tests
from permway.challenge.small.stretches import lost
from permway.diagnosis.catalogue import entries
from permway.diagnosis.fit import Free
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.location import Location
from permway.diagnosis.recalibrate import recalibrate

STEP = 1e-3
"""Of slopes, in standard deviations of a prior."""

LINES_HZ = np.arange(4.0, 90.0, 2.0)
"""Of a run, as a diagnosis uses them."""

FINE_HZ, FINE_S = np.arange(0.5, 110.0, 0.25), 4.0
"""Of a run, from which it is made in time, and the segment that keeps lines apart there."""

USUAL, WIDEST = 1.0, 2.0
"""Standard deviations of an effect's priors within which its parameters are drawn, evenly; and of its size."""


class ByModel:
    """Predictions of one campaign with its true parameters.

    Parameters
    ----------
    campaign : Campaign
        As its file has it.
    tests : Tests
    layout : Layout
    values : mapping of str to float
        True values of its parameters.
    """

    name = "model"

    def __init__(self, campaign: Campaign, tests: Tests, layout: Layout, values: Mapping[str, float]) -> None:
        self.campaign, self.tests, self.layout = campaign, tests, layout
        self.true = campaign.with_values(values)
        self.values = dict(values)
        self._blank = [_blank(campaign, index, tests) for index in range(len(campaign.stated.records))]
        self.base = self._predicted(self.true)

    def responses(self, effects: Sequence[tuple[Concealed, float]]) -> list[Complexes]:
        """Hammer tests (tests, sensors, points, F), and the run's densities (F, channels, channels) if any."""
        return self._predicted(self._amended(effects)) if effects else self.base

    def at(self, values: Mapping[str, float]) -> list[Complexes]:
        """Responses with other values of the parameters and nothing concealed."""
        return self._predicted(self.campaign.with_values(values))

    def slopes(self) -> list[list[Complexes]]:
        """Responses one step away in each parameter."""
        found = []
        for name, known in self.campaign.parameters.known.items():
            beyond = (
                self.values[name] * np.exp(STEP * known.sigma)
                if known.log
                else self.values[name] + (STEP * known.sigma)
            )
            found.append(self._predicted(self.campaign.with_values({**self.values, name: float(beyond)})))
        return found

    def in_detail(self, effects: Sequence[tuple[Concealed, float]]) -> tuple[Reals, Complexes]:
        """Lines and densities of the run from which it can be made in time."""
        (index,) = [i for i, r in enumerate(self.campaign.stated.records) if r.statistic == "csd"]
        record = self._blank[index].record.model_copy(update={"segment_s": FINE_S})
        names = list(record.channels.values())
        fine = Dataset(record, self._blank[index].condition, _spectra(names, FINE_HZ))
        (found,) = predict(self._amended(effects), [fine], threads=1)
        return FINE_HZ, np.moveaxis(found["csd"].values, -1, 0)

    def draw(self, random: np.random.Generator, name: str | None) -> Concealed | None:
        """An effect of the catalogue, or of none; None if the layout or the tests do not allow it.

        Parameters
        ----------
        random : Generator
        name : str or None
            Entry of the catalogue; None for what is in no catalogue.
        """
        if name is None:
            return outside(random, self.true, self.layout)
        if name in ("fastener_loss", "mortar_void"):
            return lost(random, self.true, name, self._place(random))
        found = list(entries()[name].hypotheses(self._situation(random)))
        if not found:
            return None
        return self._concealed(random, found[int(random.integers(len(found)))])

    def _concealed(self, random: np.random.Generator, chosen: Hypothesis) -> Concealed | None:
        largest = {f.name: f.value(_drawn(random, f, chosen)) for f in chosen.free}
        if chosen.entry == "sensor_polarity":
            largest = {"sign": -1.0}
        nothing = {name: none for name in largest if (none := _nothing(chosen, name)) is not None}

        def at(share: float) -> dict[str, float]:
            return {n: displaced(v, nothing[n], share) if n in nothing else v for n, v in largest.items()}

        def place(share: float) -> dict[str, Any]:
            where = chosen.locate(at(share))
            joint = where.what in self.true.model.line.laws
            key = "joint" if joint else "body"
            found: dict[str, Any] = {key: where.what} if where.what else {}
            if where.x_m is not None:
                found["x_m"] = [round(float(v), 4) for v in where.x_m]
            if where.channels:
                found["channels"] = list(where.channels)
            return found

        def noise(share: float) -> dict[str, float]:
            changed = chosen.amend(self.true, at(share))
            return {s.name: s.chain.noise_factor for s in changed.stated.sensors if s.chain.noise_factor != 1.0}

        return Concealed(
            id=chosen.entry,
            kind=f"catalogue: {chosen.entry}",
            family=chosen.family,
            domain=chosen.domain,
            change=lambda campaign, share: chosen.amend(campaign, at(share)),
            parameters=at,
            place=place,
            scales=any(name == chosen.size or name in SIZES for name in nothing),
            mechanical=chosen.law(largest),
            noise=noise,
        )

    def _amended(self, effects: Sequence[tuple[Concealed, float]]) -> Campaign:
        campaign = self.true
        for effect, share in effects:
            campaign = effect.change(campaign, share)
        return campaign

    def _predicted(self, campaign: Campaign) -> list[Complexes]:
        found = predict(campaign, self._blank, threads=1)
        hammers = [p["frf"].values for p in found if "frf" in p]
        runs = [np.moveaxis(p["csd"].values, -1, 0) for p in found if "csd" in p]
        return [np.stack(hammers), *runs]

    def _place(self, random: np.random.Generator) -> float:
        """Where an effect of the line is: anywhere, or right at a hammer point."""
        forces = [f["x_m"] for f in self.tests.forces]
        if random.random() < AT_A_POINT:
            return float(forces[int(random.integers(len(forces)))])
        return float(random.uniform(0.0, self.layout.length_m))

    def _situation(self, random: np.random.Generator) -> Situation:
        """What the catalogue makes its hypotheses from: records without effect, and places drawn at random."""
        datasets = [_filled(d, p) for d, p in zip(self._blank, self._as_datasets(), strict=True)]
        observations = gather(self._with_a_parameter(), datasets, threads=1)
        fit = recalibrate(observations, most_steps=0)
        return Situation(fit, self._locations(random))

    def _with_a_parameter(self) -> Campaign:
        """The campaign, or, if it states no parameter, with one: a base has something to recalibrate."""
        campaign = self.campaign
        if campaign.parameters.known:
            return campaign
        law = next(iter(campaign.model.line.laws))
        one = Parameter(name="k", paths=(f"line.laws.{law}.stiffness",), tolerance_2sigma=0.1)
        stated = campaign.stated.model_copy(update={"parameters": (one,)})
        known = ParameterSet(stated.parameters, campaign.model, self.tests.model, stated, campaign.folder)
        return Campaign(stated, campaign.model, campaign.folder, known)

    def _as_datasets(self) -> list[xr.Dataset]:
        return predict(self.true, self._blank, threads=1)

    def _locations(self, random: np.random.Generator) -> tuple[Location, ...]:
        line = self.campaign.model.line
        table, laws, first = line.joint_table(), list(line.laws), self._place(random)
        drawn = [int(j) for j in random.permutation(table.x.size)]
        order = [j for j in drawn if abs(table.x[j] - first) < 0.5] + drawn
        found = [Location("joint", laws[table.law[j]], float(table.x[j])) for j in dict.fromkeys(order)]
        for _, segment in line.beams():
            x = round(min(max(first, segment.start + 0.1), segment.stop - 0.1), 3)
            found.insert(int(random.integers(3)), Location("body", segment.name, x))
        return tuple(found)


AT_A_POINT = 0.3
"""Share of effects of the line that stand right at a hammer point, where they are hardest to place."""


SIZES = {"rise": 0.0, "share": 0.0, **{f"wave{order}": 0.0 for order in range(1, 11)}}
"""Parameters of forms of an effect without a size of their own, and what they are where there is nothing."""

ALONG = {"rest": 1.0, **{f"{what}_factor": 1.0 for what in ("stiffness", "reference", "unloaded", "unstrained")}}
"""Parameters that a base has too, which go to 1 with the effect: a stiffness or a loss that is off is none."""

BOTH = 0.3
"""Ratio of how far the ends of a size's prior lie from nothing from which either is taken: a gain may be above or
below 1. At 0 half of all masses and shares would be tiny at their largest; at 1 no gain would ever be low."""


def _nothing(chosen: Hypothesis, name: str) -> float | None:
    """The value of a parameter where there is no effect; None if it is a place, a frequency or the like."""
    if chosen.entry == "sensor_polarity":
        return None
    if name == chosen.size:
        return chosen.none
    return ALONG.get(name, None if chosen.size else SIZES.get(name))


def _drawn(random: np.random.Generator, free: Free, chosen: Hypothesis) -> float:
    """A coordinate of a parameter: its size at an end of its prior, others near its middle."""
    low, high = free.limits
    none = _nothing(chosen, free.name)
    if none is None or free.name in ALONG or free.name.startswith("wave"):
        return float(np.clip(random.uniform(-USUAL, USUAL), low, high))
    ends = [float(np.clip(z, low, high)) for z in (-WIDEST, WIDEST)]
    away = [_away(free.value(z), none) for z in ends]
    if min(away) > BOTH * max(away):
        return ends[int(random.integers(2))]
    return ends[int(np.argmax(away))]


def _away(value: float, none: float) -> float:
    """How far a size is from nothing: by its logarithm where both are above zero."""
    if np.isinf(none):
        return 1.0 / abs(value)
    return abs(float(np.log(value / none))) if value > 0.0 and none > 0.0 else abs(value - none)


def _blank(campaign: Campaign, index: int, tests: Tests) -> Dataset:
    record = campaign.stated.records[index]
    condition = campaign.condition(record.condition)
    if record.statistic == "csd":
        return Dataset(record, condition, _spectra(list(record.channels.values()), LINES_HZ))
    names = {"sensor": list(record.responses.values()), "force": list(record.references.values())}
    shape = (*(len(v) for v in names.values()), tests.frequency_Hz.size)
    data = xr.Dataset(
        {"frf": ((*names, "frequency"), np.zeros(shape, complex))},
        coords={**names, "frequency": tests.frequency_Hz},
        attrs={"averages": BLOWS},
    )
    return Dataset(record, condition, data)


def _spectra(names: list[str], frequency_Hz: Reals) -> xr.Dataset:
    count, lines = len(names), frequency_Hz.size
    return xr.Dataset(
        {
            "csd": (("channel", "channel2", "frequency"), np.zeros((count, count, lines), complex)),
            "psd": (("channel", "frequency"), np.zeros((count, lines))),
        },
        coords={"channel": names, "channel2": names, "frequency": frequency_Hz},
        attrs={"averages": RUN_S, "duration_s": RUN_S},
    )


def _filled(dataset: Dataset, right: xr.Dataset) -> Dataset:
    """A dataset of what is predicted, with the noise of a good measurement."""
    data = dataset.data.copy()
    if dataset.record.statistic == "frf":
        data["frf"] = right["frf"]
        data["coherence"] = xr.full_like(right["frf"], 0.98, dtype=float)
        data["log_variance"] = xr.full_like(right["frf"], 0.02 / (2.0 * BLOWS * 0.98), dtype=float)
    else:
        data["csd"] = right["csd"]
        diagonal = np.einsum("ccf->cf", right["csd"].values).real
        data["psd"] = data["psd"].copy(data=diagonal)
    return replace(dataset, data=data)


assert LINES_HZ[-1] <= RUN_BAND_HZ[1]
