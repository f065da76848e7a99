"""Effects whose family is taken out of the catalogue: what is named otherwise has to be described then."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from permway.challenge.effects import bridge, fasteners, layers
from permway.challenge.effects.base import Effect


@dataclass(frozen=True)
class TakenOut:
    """Effects that a diagnosis is asked to exclude.

    Attributes
    ----------
    names : tuple of str
        Of the catalogue: the effect and all that do nearly the same.
    words : tuple of str
        Of which a right description of its mechanics uses one.
    """

    names: tuple[str, ...]
    words: tuple[str, ...]


PADS = ("pad_frequency", "pad_temperature", "layer_damping", "baseplate_mass")
HUNG = ("deck_attachment", "rail_absorber")
LOST = ("fastener_loss", "mortar_void", "support_gradient")
HELD = ("bearing_stiffness", "pier_soil")

TAKEN_OUT: Mapping[type[Effect], TakenOut] = {
    fasteners.PadSpringpot: TakenOut(PADS, ("springpot",)),
    fasteners.PadZener: TakenOut(PADS, ("in series with a dashpot",)),
    fasteners.FastenersLost: TakenOut(LOST, ("spring of -",)),
    fasteners.RailAbsorbers: TakenOut(HUNG, ("resonator",)),
    layers.MortarVoid: TakenOut(LOST, ("spring of -",)),
    layers.ViscousLayer: TakenOut(PADS, ("dashpot",)),
    bridge.DeckAttachment: TakenOut(HUNG, ("resonator",)),
    bridge.BearingStiffness: TakenOut(HELD, ("spring of",)),
}
"""By kind of effect; those of which one element of few constants states what they do."""
