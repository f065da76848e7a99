"""Effects that the finite elements' line can have, by entry of the catalogue."""

from __future__ import annotations

from permway.challenge.small import elements_bodies as bodies
from permway.challenge.small import elements_layers as layers
from permway.challenge.small.elements_parts import Draw, bed_of, pad_of, rubber_of

PATH: dict[str, Draw] = {
    "fastener_loss": layers.loss("fastener_loss", pad_of),
    "mortar_void": layers.loss("mortar_void", bed_of),
    "support_scatter": layers.scatter,
    "support_gradient": layers.gradient,
    "pad_frequency": layers.rubber("pad_frequency", rubber_of, "pad law"),
    "ballast_frequency": layers.rubber("ballast_frequency", bed_of, "bed law"),
    "pad_temperature": layers.temperature,
    "layer_damping": layers.viscous,
    "rail_absorber": bodies.absorber,
    "baseplate_mass": layers.baseplate,
    "deck_attachment": bodies.attachment,
    "beam_damping": bodies.beam_loss,
    "girder_crack": bodies.crack,
    "bearing_stiffness": layers.one_bearing,
    "pier_soil": layers.pier,
    "girder_local_modes": bodies.local_modes,
    "slab_joints": bodies.slab_joints,
    "slab_warping": layers.warping,
}
"""By entry of the catalogue."""

OUTSIDE: Draw = bodies.outside
