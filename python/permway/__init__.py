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
    from permway.campaign.track_decay import track_decay_rate
    from permway.errors import InputError, PermwayError, SolveError
    from permway.laws import (
        FVMP,
        TFDV,
        WLF,
        Arrhenius,
        FractionalKelvinVoigt,
        FractionalZener,
        Free,
        Given,
        HavriliakNegami,
        Hysteretic,
        KelvinVoigt,
        Maxwell,
        Measured,
        Pad,
        Parallel,
        Prony,
        Scaled,
        Series,
        Springpot,
        StorageLossPair,
        Tabulated,
        Waves,
        WLFArrhenius,
        Zener,
        law_from_dict,
        law_to_dict,
    )
    from permway.model.bodies import Beam, Mass, Shaft
    from permway.model.joints import Ends, Joints, Spread
    from permway.model.line import Line
    from permway.model.lines_ballasted import ballasted_b91_60e1
    from permway.model.lines_crts import crts_ii_viaduct_32m, crts_iii_viaduct_32m
    from permway.model.lines_zeng2014 import zeng2014_nine_spans
    from permway.model.presets import slab_track_viaduct_32m, wj7b, wj7b_constant
    from permway.model.roll import Roll
    from permway.model.train import Train
    from permway.model.vehicle import Vehicle
    from permway.model.vehicle_presets import crh380a, manchester_vehicle_1, zeng2014_trailer
    from permway.problem.solve import solve, write_dataset
    from permway.public import check, compare, diagnose
    from permway.recordings.insertion_loss import insertion_loss
    from permway.response.decay import decay_rate
    from permway.response.dispersion import dispersion
    from permway.response.modes import modes
    from permway.response.operating import at_phase, operating_shapes
    from permway.response.passby import Axles, MassOnSpring, SprungMass, couple, hslm_a, passby
    from permway.response.quantities import accelerance, mobility
    from permway.response.rails import both_rails
    from permway.response.receptance import receptance
    from permway.response.sensitivity import by_joint, change_joint, sensitivity
    from permway.response.train import train_response
    from permway.tables import to_frame, write_csv

_HOMES = {
    "errors": ("InputError", "PermwayError", "SolveError"),
    "laws": (
        *("FVMP", "TFDV", "WLF", "Arrhenius", "FractionalKelvinVoigt", "FractionalZener", "Free", "Given"),
        *("HavriliakNegami", "Hysteretic", "KelvinVoigt", "Maxwell", "Measured", "Pad", "Parallel", "Prony"),
        *("Scaled", "Series", "Springpot", "StorageLossPair", "Tabulated", "WLFArrhenius", "Waves", "Zener"),
        *("law_from_dict", "law_to_dict"),
    ),
    "model.bodies": ("Beam", "Mass", "Shaft"),
    "campaign.campaign": ("read_campaign",),
    "formats.model_file": ("model_from_dict", "read_model"),
    "model.joints": ("Ends", "Joints", "Spread"),
    "model.line": ("Line",),
    "model.lines_ballasted": ("ballasted_b91_60e1",),
    "model.lines_crts": ("crts_ii_viaduct_32m", "crts_iii_viaduct_32m"),
    "model.lines_zeng2014": ("zeng2014_nine_spans",),
    "model.place": ("Place",),
    "model.presets": ("slab_track_viaduct_32m", "wj7b", "wj7b_constant"),
    "model.roll": ("Roll",),
    "model.train": ("Train",),
    "model.vehicle": ("Vehicle",),
    "model.vehicle_presets": ("crh380a", "manchester_vehicle_1", "zeng2014_trailer"),
    "problem.model": ("Model",),
    "problem.solve": ("solve", "write_dataset"),
    "public": ("check", "compare", "diagnose"),
    "recordings.insertion_loss": ("insertion_loss",),
    "campaign.track_decay": ("track_decay_rate",),
    "response.decay": ("decay_rate",),
    "response.dispersion": ("dispersion",),
    "response.modes": ("modes",),
    "response.operating": ("at_phase", "operating_shapes"),
    "response.passby": ("Axles", "MassOnSpring", "SprungMass", "couple", "hslm_a", "passby"),
    "response.rails": ("both_rails",),
    "response.quantities": ("accelerance", "mobility"),
    "response.receptance": ("receptance",),
    "response.sensitivity": ("by_joint", "change_joint", "sensitivity"),
    "response.train": ("train_response",),
    "tables": ("to_frame", "write_csv"),
}


def _html(thing: object) -> str:
    draw: Callable[[object], str] = import_module("permway.report.notebook").html
    return draw(thing)


draw_with(_html)

_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "FVMP",
    "TFDV",
    "WLF",
    "Arrhenius",
    "Axles",
    "Beam",
    "Ends",
    "FractionalKelvinVoigt",
    "FractionalZener",
    "Free",
    "Given",
    "HavriliakNegami",
    "Hysteretic",
    "InputError",
    "Joints",
    "KelvinVoigt",
    "Line",
    "Mass",
    "MassOnSpring",
    "Maxwell",
    "Measured",
    "Model",
    "Pad",
    "Parallel",
    "PermwayError",
    "Place",
    "Prony",
    "Roll",
    "Scaled",
    "Series",
    "Shaft",
    "SolveError",
    "Spread",
    "Springpot",
    "SprungMass",
    "StorageLossPair",
    "Tabulated",
    "Train",
    "Vehicle",
    "WLFArrhenius",
    "Waves",
    "Zener",
    "__version__",
    "accelerance",
    "at_phase",
    "ballasted_b91_60e1",
    "both_rails",
    "by_joint",
    "change_joint",
    "check",
    "compare",
    "couple",
    "crh380a",
    "crts_ii_viaduct_32m",
    "crts_iii_viaduct_32m",
    "decay_rate",
    "diagnose",
    "dispersion",
    "hslm_a",
    "insertion_loss",
    "law_from_dict",
    "law_to_dict",
    "manchester_vehicle_1",
    "mobility",
    "model_from_dict",
    "modes",
    "operating_shapes",
    "passby",
    "read_campaign",
    "read_model",
    "receptance",
    "sensitivity",
    "slab_track_viaduct_32m",
    "solve",
    "to_frame",
    "track_decay_rate",
    "train_response",
    "wj7b",
    "wj7b_constant",
    "write_csv",
    "write_dataset",
    "zeng2014_nine_spans",
    "zeng2014_trailer",
]


def __getattr__(name: str) -> object:
    # Names are loaded when first used: importing permway takes no second for what it may not need.
    if name in _HOME:
        value: object = getattr(import_module(f"permway.{_HOME[name]}"), name)
        globals()[name] = value
        return value
    from difflib import get_close_matches

    close = get_close_matches(name, __all__, n=1)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    raise AttributeError(f"module 'permway' has no attribute {name!r}{hint}")


def __dir__() -> list[str]:
    return __all__
