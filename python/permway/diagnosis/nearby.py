"""Predictions of campaigns whose lines differ by little in their numbers: by exact derivatives, without a solve.

Where a parameter changes stiffnesses, masses and loss factors of laws and bodies, and no place, the receptances
move by `dH = sum of dH/dp times the change of p`, one derivative sweep for all parameters
(:mod:`permway.response.sensitivity`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.factors import model_under
from permway.campaign.predict import Request, Result, Sweep, plan, predict_one, request_of, solve
from permway.campaign.predictions.sweeps import places_of
from permway.diagnosis.observations import Observations, Solved
from permway.diagnosis.side_by_side import threads_of_solver
from permway.model.line import Line
from permway.response.sensitivity import sensitivity

COLUMNS = ("bending", "shear", "mass", "rotary")
"""Of the core's tables, in the order of :data:`permway.response.sensitivity.PROPERTIES`."""

Part = Literal["law", "bending", "mass", "point"]
"""Of a line: stiffness of laws, bending stiffness and mass of beams, masses."""

MOST_BEAMS = 60
"""Beams and masses of a line above which all derivatives together cost more memory than they save time."""


@dataclass(frozen=True)
class _Numbers:
    """Of a line that derivatives are by: stiffness of laws (frequency, law), columns of beams, masses."""

    stiffness: Complexes
    beams: Mapping[str, np.ndarray]
    masses_kg: Reals

    @staticmethod
    def of(line: Line, need: Request) -> _Numbers:
        """At a need's frequencies and temperature."""
        stiffness = line.stiffness(need.frequency_Hz, need.temperature_C)
        return _Numbers(stiffness, line.beam_columns(), line.masses_kg())


@dataclass(frozen=True)
class _Derivatives:
    """Of one need's receptances, (frequency, law or beam or mass, row, column), and the numbers they are at."""

    at: _Numbers
    by_law: Complexes
    by_beam: Complexes
    by_mass: Complexes

    def of(self, part: Part) -> tuple[np.ndarray, Complexes]:
        """Values of a part, (frequency or 1, number), and derivatives by them."""
        if part == "law":
            return self.at.stiffness, self.by_law
        if part == "point":
            return self.at.masses_kg[None], self.by_mass
        return self.at.beams[part][None], self.by_beam[:, :, COLUMNS.index(part)]


class Nearby:
    """Campaigns that differ little from one that was solved.

    Parameters
    ----------
    observations : Observations
    solved : Solved
        Of the campaign that they are near to.
    """

    def __init__(self, observations: Observations, solved: Solved) -> None:
        self.observations, self.solved = observations, solved
        self._known: dict[int, _Derivatives] = {}
        # What is linear in the change has double poles: no modes.
        self._exact = {
            id(need)
            for dataset, need in zip(observations.datasets, solved.needs, strict=True)
            if dataset.record.statistic == "modes"
        }

    def derive(self) -> None:
        """Take the derivatives that campaigns near by will need, before processes share the work."""
        model = self.solved.campaign.model
        if model.formulation == "chain" and self._few(model.line):
            for need in self.solved.needs:
                if need is not None and id(need) not in self._exact:
                    self._derivatives(need, model_under(model, need.factors).line)

    def predicted(self, campaign: Campaign) -> Solved | None:
        """What a campaign near by predicts; None if its line differs by more than numbers."""
        near = self.solved
        one, other = near.campaign.model.line, campaign.model.line
        if one == other or not self._few(one) or campaign.model.formulation != "chain" or not _alike(one, other):
            return None
        needs = [request_of(campaign, dataset) for dataset in self.observations.datasets]
        pairs = list(zip(needs, near.needs, strict=True))
        if not all(_same_places(new, old) for new, old in pairs):
            return None
        answers = {
            id(new): self._moved(old, new, campaign) for new, old in pairs if new is not None and old is not None
        }
        return self._read(campaign, needs, answers)

    def perturbed(self, part: Part, indices: Sequence[int], share: Callable[[Reals], Reals]) -> Solved | None:
        """What is predicted with some numbers of the line off at some frequencies.

        Parameters
        ----------
        part : str
        indices : sequence of int
            Of the line's laws, beams or masses.
        share : callable
            From frequencies to the share by which these are off.

        Returns
        -------
        Solved or None
            None if derivatives would cost too much, or modes are among the records.
        """
        if self._exact or not self._few(self.solved.campaign.model.line):
            return None
        answers: dict[int, Result] = {}
        for need in self.solved.needs:
            if need is not None:
                line = model_under(self.solved.campaign.model, need.factors).line
                values, slopes = self._derivatives(need, line).of(part)
                chosen = list(indices)
                by_share = np.einsum("fi,firc->frc", values[:, chosen], slopes[:, chosen])
                moved = share(need.frequency_Hz)[:, None, None] * by_share
                answers[id(need)] = self._answer(need, need, moved)
        return self._read(self.solved.campaign, self.solved.needs, answers)

    def _few(self, line: Line) -> bool:
        return len(line.beams()) + line.masses_kg().size <= MOST_BEAMS

    def _read(self, campaign: Campaign, needs: Sequence[Request | None], answers: Mapping[int, Result]) -> Solved:
        """All datasets, from what their needs were answered."""
        made: dict[int, xr.Dataset] = {}
        for dataset, need in zip(self.observations.datasets, needs, strict=True):
            if id(dataset) not in made:
                made[id(dataset)] = predict_one(
                    campaign, dataset, need, None if need is None else answers[id(need)]
                )
        return Solved(campaign, tuple(needs), {}, [made[id(dataset)] for dataset in self.observations.datasets])

    def _answer(self, need: Request, asked: Request, moved: Complexes) -> Result:
        """The receptances of a need, moved to what is asked."""
        places = places_of(need.columns), places_of(need.rows)
        sweep = Sweep(asked.temperature_C, need.frequency_Hz, *places, need.factors)
        return Result(sweep, self.solved.answers[need.key].of(need) + moved)

    def _moved(self, need: Request, asked: Request, campaign: Campaign) -> Result:
        if id(need) in self._exact:
            (sweep,) = plan([asked])
            return solve(sweep, campaign.model, threads=threads_of_solver(self.observations.threads))
        known = self._derivatives(need, model_under(self.solved.campaign.model, need.factors).line)
        before, after = known.at, _Numbers.of(model_under(campaign.model, need.factors).line, asked)
        values = np.zeros((need.frequency_Hz.size, len(need.rows), len(need.columns)), dtype=np.complex128)
        law = after.stiffness - before.stiffness
        for index in np.flatnonzero((law != 0.0).any(axis=0)):
            values += law[:, index, None, None] * known.by_law[:, index]
        for place, name in enumerate(COLUMNS):
            change = after.beams[name] - before.beams[name]
            for index in np.flatnonzero(change):
                values += change[index] * known.by_beam[:, index, place]
        mass = after.masses_kg - before.masses_kg
        for index in np.flatnonzero(mass):
            values += mass[index] * known.by_mass[:, index]
        return self._answer(need, asked, values)

    def _derivatives(self, need: Request, line: Line) -> _Derivatives:
        if id(need) not in self._known:
            # Two runs at one temperature may need the same.
            like = next((n for n in self.solved.needs if n is not None and n.is_like(need)), need)
            if id(like) not in self._known:
                data = sensitivity(
                    line,
                    like.frequency_Hz,
                    forces=places_of(like.columns),
                    sensors=places_of(like.rows),
                    temperature_C=like.temperature_C,
                    threads=threads_of_solver(self.observations.threads),
                )
                slopes = (data[name].values for name in ("by_law", "by_beam", "by_mass"))
                self._known[id(like)] = _Derivatives(_Numbers.of(line, like), *slopes)
            self._known[id(need)] = self._known[id(like)]
        return self._known[id(need)]


def _alike(one: Line, other: Line) -> bool:
    """Whether two lines differ in numbers of laws, sections and masses only, changes of section in proportion."""
    if one.bodies.keys() != other.bodies.keys() or one.laws.keys() != other.laws.keys():
        return False
    if one.segments() != other.segments() or one.masses_kg().size != other.masses_kg().size:
        return False
    if one.joints != other.joints:
        first, second = one.joint_table(), other.joint_table()
        if any(
            not np.array_equal(getattr(first, name), getattr(second, name))
            for name in ("x", "upper", "lower", "law", "scale")
        ):
            return False
    old, new = one.beam_columns(), other.beam_columns()
    if any(not np.array_equal(old[name], new[name]) for name in ("interval", "pinned", "modes")):
        return False
    stretches, others = old["stretches"], new["stretches"]
    if any(not np.array_equal(stretches[name], others[name]) for name in ("body", "interval")):
        return False
    body = stretches["body"]
    return all(
        np.allclose(stretches[name] * new[name][body], others[name] * old[name][body], rtol=1e-12, atol=0.0)
        for name in COLUMNS
    )


def _same_places(new: Request | None, old: Request | None) -> bool:
    """Whether both need the same, but that the old may be of all temperatures, for no law depended on it."""
    if new is None or old is None:
        return new is old
    return new.is_like(old if old.temperature_C is not None else replace(old, temperature_C=new.temperature_C))
