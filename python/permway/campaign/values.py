"""From values of parameters to changed models."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from permway.campaign.parameters import Known, Parameter, known_of
from permway.campaign.paths import Changed, Steps, leads, number_at, parse_path, value_at, with_numbers
from permway.errors import InputError
from permway.formats.model_file import model_from_dict
from permway.problem.model import Model

OWN = "campaign"
"""First word of a path that leads into the campaign file instead of the model file."""


Kind = Literal["model", "table", "campaign"]


@dataclass(frozen=True)
class Place:
    """A number that a parameter sets.

    Attributes
    ----------
    steps : tuple
        From the model, or from the campaign, down.
    kind : "model", "table" or "campaign"
        Whether it stands in the built model; only in the file's table, so that the model must be built again; or
        in the campaign file.
    base : float
        The number as the file has it.
    """

    steps: Steps
    kind: Kind
    base: float


@dataclass(frozen=True)
class Move:
    """What a parameter does to a number: sets it, adds to it, or scales it."""

    acts: Literal["scales", "sets", "adds"]
    by: float

    def __call__(self, base: float) -> float:
        """The new number."""
        match self.acts:
            case "sets":
                return self.by
            case "adds":
                return base + self.by
            case _:
                return base * self.by


class ParameterSet:
    """The parameters of a campaign, resolved: from values to changed models.

    Parameters
    ----------
    parameters : sequence of Parameter
    model : Model
    table : mapping
        The model file's table, for what presets are made of.
    own : object
        The campaign file's record.
    folder : Path, optional
        Where the model file lies.

    Raises
    ------
    InputError
        For a path that leads to no number, two parameters of one name, or a nominal that does not fit.
    """

    def __init__(
        self,
        parameters: Sequence[Parameter],
        model: Model,
        table: Mapping[str, Any],
        own: object,
        folder: Path | None = None,
    ) -> None:
        self._model, self._table, self._own, self._folder = model, table, own, folder
        # Of the values that a slope is taken by, one at a time, the others stay.
        self._made: dict[Kind, Changed] = {"model": {}, "table": {}, "campaign": {}}
        self._every: dict[str, tuple[Place, ...]] = {}
        self.known: dict[str, Known] = {}
        taken: dict[Steps, str] = {}
        for index, parameter in enumerate(parameters):
            where = f"parameters[{index}]"
            if parameter.name in self.known:
                raise InputError("the name stands twice", where=f"{where}.name", value=parameter.name)
            places = tuple(self._place(path, f"{where}.paths[{i}]") for i, path in enumerate(parameter.paths))
            for i, place in enumerate(places):
                other = taken.setdefault((str(place.kind == "campaign"), *place.steps), parameter.name)
                if other != parameter.name and "sets" in (parameter.acts, self.known[other].parameter.acts):
                    what = f"{other!r} leads there too, and one of the two sets it"
                    raise InputError(what, where=f"{where}.paths[{i}]", value=parameter.paths[i])
            self._every[parameter.name] = places
            self.known[parameter.name] = known_of(parameter, places[0].base, where)

    @cached_property
    def _places(self) -> dict[str, tuple[Place, ...]]:
        """Where each parameter acts; numbers that the model does not have are left out.

        Found when it is asked for: most of the models that a search makes are predicted once, as they are.
        """
        return {
            name: tuple(place for place in places if place.kind != "model" or leads(self._model, place.steps))
            for name, places in self._every.items()
        }

    @property
    def names(self) -> list[str]:
        """Names in the order of the file."""
        return list(self.known)

    def nominal(self) -> dict[str, float]:
        """What the user believes, by name."""
        return {name: known.nominal for name, known in self.known.items()}

    def changed(self, values: Mapping[str, float]) -> tuple[Model, Any]:
        """Model and campaign record with other values; parameters that are not named keep their nominal.

        Raises
        ------
        InputError
            For a name that is no parameter, a value out of its bounds, or one that the model refuses.
        """
        model, own, table = self._model, self._own, self._table
        numbers = [
            (place, new)
            for name, value in values.items()
            for place, new in self._new(name, value, self._nominal(name))
        ]
        if any(place.kind == "table" for place, _ in numbers):
            if not table:
                name = next(n for n in values if any(p.kind == "table" for p in self._places[n]))
                what = "acts on what a preset is made of, and the model was changed since"
                raise InputError(what, where=name, remedy="spell the line out in the model file")
            model = model_from_dict(self._with(table, "table", numbers), folder=self._folder)
        return self._with(model, "model", numbers), self._with(own, "campaign", numbers)

    def _with(self, record: Any, kind: Kind, numbers: Sequence[tuple[Place, Move]]) -> Any:
        """A record with the numbers that stand in it."""
        mine = [(place.steps, move) for place, move in numbers if place.kind == kind]
        return with_numbers(record, mine, self._made[kind])

    def on(self, model: Model) -> ParameterSet:
        """The same parameters, acting on another model; numbers that it does not have are left out."""
        other = self._anew()
        other._model = model
        # What this model has not comes back with none that is made of it.
        other._every = self._places
        other.__dict__.pop("_places", None)
        # What a preset was made of is not in the new model.
        other._table = {}
        return other

    def restated(self, own: object) -> ParameterSet:
        """The same parameters, acting on another record of the campaign file, alike where they act."""
        other = self._anew()
        other._own = own
        return other

    def _anew(self) -> ParameterSet:
        other = copy.copy(self)
        other._made = {kind: {} for kind in self._made}
        return other

    def touches(self, name: str) -> set[str]:
        """First two keys of the paths of a parameter, as "line.laws" or "train.vehicle" or "campaign.sensors"."""
        found = set()
        for place in self._places[name]:
            head = (OWN, *place.steps) if place.kind == "campaign" else place.steps
            found.add(".".join(str(step) for step in head[:2]))
        return found

    def shifted(self, model: Model, name: str, old: float, new: float) -> Model | None:
        """A model that has one parameter at `old`, with it at `new` instead; None if it must be built again."""
        steps = self._new(name, new, old)
        if any(place.kind == "table" for place, _ in steps):
            return None
        changed: Model = with_numbers(model, [(place.steps, new) for place, new in steps if place.kind == "model"])
        return changed

    def _nominal(self, name: str) -> float:
        if name not in self.known:
            raise InputError("no such parameter", where="values", value=name, remedy=f"use one of {self.names}")
        return self.known[name].nominal

    def _new(self, name: str, value: float, old: float) -> list[tuple[Place, Move]]:
        """The numbers that a parameter sets, each with what makes the new number of the one at `old`."""
        known = self.known[name]
        low, high = known.bounds
        if not (math.isfinite(value) and low <= value <= high):
            raise InputError(f"must lie between {low:g} and {high:g}", where=name, value=value)
        if value == old:
            return []
        acts = known.parameter.acts
        move = Move(acts, value if acts == "sets" else value - old if acts == "adds" else value / old)
        return [(place, move) for place in self._places[name]]

    def _place(self, path: str, where: str) -> Place:
        steps = parse_path(path, where)
        if steps[0] == OWN:
            return Place(steps[1:], "campaign", self._number(self._own, steps[1:], where, path))
        try:
            value_at(self._model, steps)
        except KeyError as error:
            try:
                return Place(steps, "table", number_at(self._table, steps))
            except KeyError:
                raise _no_number(error, where, path) from error
        return Place(steps, "model", self._number(self._model, steps, where, path))

    def _number(self, record: object, steps: Steps, where: str, path: str) -> float:
        try:
            return number_at(record, steps)
        except KeyError as error:
            raise _no_number(error, where, path) from error


def _no_number(error: KeyError, where: str, path: str) -> InputError:
    return InputError(f"leads to no number: {error.args[0]}", where=where, value=path)
