"""Effects that are concealed, each a class with its parameters."""

from __future__ import annotations

from permway.challenge.effects import (
    bridge,
    fasteners,
    layers,
    leaving,
    measuring,
    on_board,
    outside,
    running_surface,
    sliding,
)
from permway.challenge.effects.base import STRENGTHS, Domain, Effect, Site, Strength

__all__ = ["CATALOGUE", "NONLINEAR", "OUTSIDE", "STRENGTHS", "TWINS", "Domain", "Effect", "Site", "Strength"]

CATALOGUE: tuple[type[Effect], ...] = (
    fasteners.PadSpringpot,
    fasteners.PadZener,
    fasteners.PadTemperature,
    fasteners.FastenersLost,
    fasteners.RailAbsorbers,
    fasteners.BaseplateMass,
    fasteners.SupportGradient,
    layers.MortarVoid,
    layers.SlabJoints,
    layers.ViscousLayer,
    bridge.DeckAttachment,
    bridge.GirderCrack,
    bridge.BearingStiffness,
    bridge.PierSoil,
    on_board.DamperSeries,
    on_board.AxleboxAbsorber,
    on_board.BodyBending,
    on_board.WheelsetBending,
    running_surface.WheelPolygon,
    running_surface.RailCorrugation,
    running_surface.ContactFilter,
    running_surface.IrregularityLevel,
    measuring.SensorGain,
    measuring.SensorDelay,
    measuring.SensorPolarity,
    measuring.SensorMounting,
    measuring.NoiseFloor,
    measuring.MainsLines,
    measuring.SpeedError,
)
"""Effects that the catalogue of diagnoses names."""

TWINS = tuple(effect for effect in CATALOGUE if effect.TWINS)
"""Effects that have a near twin."""

OUTSIDE: tuple[type[Effect], ...] = (
    outside.Inerter,
    outside.RailInerter,
    outside.NegativeStrip,
    outside.Cable,
    outside.MortarDelay,
    outside.FractionalGround,
)
"""Effects that no catalogue names."""

NONLINEAR: tuple[type[Effect], ...] = (sliding.PrimaryFriction, sliding.BlowOffDamper, leaving.DippedWelds)
"""Effects that depend on amplitude."""
