"""permway: how a train, its track and the viaduct below vibrate, frequency by frequency.

SI units; exp(+i omega t); displacement positive down; frequencies in Hz; densities one-sided per hertz.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING

from permway._core import __version__
from permway.notebook import draw_with

if TYPE_CHECKING:
    from permway.campaign.campaign import read_campaign
    from permway.errors import InputError, PermwayError, SolveError
    from permway.formats.model_file import model_from_dict, read_model
    from permway.laws import law_from_dict
    from permway.model.bodies import Beam, Mass, Shaft
    from permway.model.joints import Ends, Joints, Spread
    from permway.model.line import Line
    from permway.model.place import Place
    from permway.model.presets import slab_track_viaduct_32m, wj7b, wj7b_constant
    from permway.model.roll import Roll
    from permway.model.train import Train
    from permway.model.vehicle import Vehicle
    from permway.model.vehicle_presets import crh380a
    from permway.problem.model import Model
    from permway.problem.solve import solve, write_dataset
    from permway.public import check, compare, diagnose
    from permway.response.decay import decay_rate
    from permway.response.passby import Axles, MassOnSpring, SprungMass, couple, hslm_a, passby
    from permway.response.quantities import accelerance, mobility
    from permway.response.rails import both_rails
    from permway.response.receptance import receptance
    from permway.response.sensitivity import by_joint, change_joint, sensitivity
    from permway.response.train import train_response

_HOMES = {
    "errors": ("InputError", "PermwayError", "SolveError"),
    "laws": ("law_from_dict",),
    "model.bodies": ("Beam", "Mass", "Shaft"),
    "campaign.campaign": ("read_campaign",),
    "formats.model_file": ("model_from_dict", "read_model"),
    "model.joints": ("Ends", "Joints", "Spread"),
    "model.line": ("Line",),
    "model.place": ("Place",),
    "model.presets": ("slab_track_viaduct_32m", "wj7b", "wj7b_constant"),
    "model.roll": ("Roll",),
    "model.train": ("Train",),
    "model.vehicle": ("Vehicle",),
    "model.vehicle_presets": ("crh380a",),
    "problem.model": ("Model",),
    "problem.solve": ("solve", "write_dataset"),
    "public": ("check", "compare", "diagnose"),
    "response.decay": ("decay_rate",),
    "response.passby": ("Axles", "MassOnSpring", "SprungMass", "couple", "hslm_a", "passby"),
    "response.rails": ("both_rails",),
    "response.quantities": ("accelerance", "mobility"),
    "response.receptance": ("receptance",),
    "response.sensitivity": ("by_joint", "change_joint", "sensitivity"),
    "response.train": ("train_response",),
}


def _html(thing: object) -> str:
    draw: Callable[[object], str] = import_module("permway.report.notebook").html
    return draw(thing)


draw_with(_html)

_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "Axles",
    "Beam",
    "Ends",
    "InputError",
    "Joints",
    "Line",
    "Mass",
    "MassOnSpring",
    "Model",
    "PermwayError",
    "Place",
    "Roll",
    "Shaft",
    "SolveError",
    "Spread",
    "SprungMass",
    "Train",
    "Vehicle",
    "__version__",
    "accelerance",
    "both_rails",
    "by_joint",
    "change_joint",
    "check",
    "compare",
    "couple",
    "crh380a",
    "decay_rate",
    "diagnose",
    "hslm_a",
    "law_from_dict",
    "mobility",
    "model_from_dict",
    "passby",
    "read_campaign",
    "read_model",
    "receptance",
    "sensitivity",
    "slab_track_viaduct_32m",
    "solve",
    "train_response",
    "wj7b",
    "wj7b_constant",
    "write_dataset",
]


def __getattr__(name: str) -> object:
    # Names are loaded when first used: importing permway takes no second for what it may not need.
    if name in _HOME:
        value: object = getattr(import_module(f"permway.{_HOME[name]}"), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'permway' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
