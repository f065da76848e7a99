"""Response at fixed sensors to a passing train, and vehicles coupled to the line in time."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from permway.response.passby.coupled import couple
    from permway.response.passby.loads import Axles, hslm_a
    from permway.response.passby.run import passby
    from permway.response.passby.sprung import MassOnSpring, SprungMass

_HOME = {
    "Axles": "loads",
    "MassOnSpring": "sprung",
    "SprungMass": "sprung",
    "couple": "coupled",
    "hslm_a": "loads",
    "passby": "run",
}

__all__ = ["Axles", "MassOnSpring", "SprungMass", "couple", "hslm_a", "passby"]


def __getattr__(name: str) -> object:
    # A model file's reader needs the settings alone.
    if name in _HOME:
        value: object = getattr(import_module(f"permway.response.passby.{_HOME[name]}"), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'permway.response.passby' has no attribute {name!r}")
