"""Effects that are concealed, each a class with its parameters."""

from __future__ import annotations

from permway.challenge.effects import (
    above_wheels,
    blows,
    bridge,
    fasteners,
    layers,
    leaving,
    measuring,
    on_board,
    outside,
    recorders,
    running_surface,
    sliding,
    under_load,
    uneven,
)
from permway.challenge.effects.base import STRENGTHS, Domain, Effect, Site, Strength

__all__ = [
    "CATALOGUE",
    "FADING",
    "NEAR_DEGENERATE",
    "NONLINEAR",
    "OUTSIDE",
    "STRENGTHS",
    "Domain",
    "Effect",
    "Site",
    "Strength",
]

CATALOGUE: tuple[type[Effect], ...] = (
    fasteners.PadSpringpot,
    fasteners.PadZener,
    fasteners.PadTemperature,
    fasteners.FastenersLost,
    fasteners.RailAbsorbers,
    fasteners.BaseplateMass,
    fasteners.SupportGradient,
    under_load.PadPreload,
    uneven.SupportScatter,
    uneven.SlabWarping,
    layers.MortarVoid,
    layers.SlabJoints,
    layers.ViscousLayer,
    bridge.DeckAttachment,
    bridge.GirderCrack,
    bridge.BearingStiffness,
    bridge.PierSoil,
    bridge.SecondTrack,
    on_board.DamperSeries,
    on_board.AxleboxAbsorber,
    on_board.BodyBending,
    on_board.WheelsetBending,
    above_wheels.AirSpring,
    above_wheels.BogieBending,
    above_wheels.SecondSource,
    running_surface.WheelPolygon,
    running_surface.RailCorrugation,
    blows.WheelFlat,
    blows.RailJoints,
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

NEAR_DEGENERATE = tuple(effect for effect in CATALOGUE if effect.ALTERNATIVES)
"""Effects that have near-degenerate alternatives."""

FADING = tuple(effect for effect in CATALOGUE if effect.FADES)
"""Effects that can be as weak as one likes."""

OUTSIDE: tuple[type[Effect], ...] = (
    outside.Inerter,
    outside.RailInerter,
    outside.NegativeStrip,
    outside.Cable,
    outside.MortarDelay,
    outside.FractionalGround,
)
"""Effects that no catalogue names."""

NONLINEAR: tuple[type[Effect], ...] = (
    sliding.PrimaryFriction,
    sliding.BlowOffDamper,
    leaving.DippedWelds,
    under_load.PadFriction,
    under_load.ClosingGap,
    recorders.Clipping,
    recorders.ClockDrift,
)
"""Effects that depend on amplitude, or change in time."""
