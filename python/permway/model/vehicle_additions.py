"""What a car has beside rigid masses, springs and dashpots: additions to its dynamic stiffness, all passive."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import Field, NonNegativeFloat, PositiveFloat

from permway.arrays import Complexes, Reals
from permway.model.faults import fault
from permway.records import FrozenModel, Number

Part = Literal[
    "wheelsets",
    "wheelset1",
    "wheelset2",
    "wheelset3",
    "wheelset4",
    "bogies",
    "bogie1",
    "bogie2",
    "body",
]
"""A part of every car, or all of a kind."""

BODY, BOGIES, WHEELSETS = 0, (2, 4), (6, 7, 8, 9)
"""Vertical degrees of a car by kind."""


class _Resonant(FrozenModel):
    """Something with a frequency and a loss of its own on parts of the car."""

    on: Part
    frequency_Hz: PositiveFloat
    loss_factor: float = Field(gt=0.0, le=5.0)

    def at(self) -> tuple[int, ...]:
        """Degrees of a car that it sits on."""
        if self.on == "body":
            return (BODY,)
        every = BOGIES if self.on.startswith("bogie") else WHEELSETS
        return every if self.on.endswith("s") else (every[int(self.on[-1]) - 1],)

    def spring(self) -> complex:
        """Square of the circular frequency with the loss, rad^2/s^2."""
        return (2.0 * math.pi * self.frequency_Hz) ** 2 * (1.0 + 1j * self.loss_factor)


class Resonator(_Resonant):
    """A mass on a spring, added to a part: an absorber, or something that hangs on it.

    Parameters
    ----------
    on : str
        "wheelsets", "bogies", "body", or one part, as "wheelset2" of every car.
    mass_kg : float
        Of one; the whole vehicle's, of which the model carries its share.
    frequency_Hz : float
        Of the mass on its spring, the part held.
    loss_factor : float
        Of the spring, above 0.
    """

    type: Literal["resonator"] = "resonator"
    mass_kg: PositiveFloat

    def stiffness(self, omega: Reals) -> Complexes:
        """What one adds to the dynamic stiffness of its part, N/m, shape of `omega`."""
        spring = self.spring()
        added: Complexes = -(omega**2) * self.mass_kg * spring / (spring - omega**2)
        return added


class FlexibleMode(_Resonant):
    """A symmetric bending mode of a part that was rigid; its mass stays what it is.

    The part's degree of freedom is then the motion of the point that is read: the middle of the car body or of
    the bogie frame, the axle boxes of a wheelset, where it is sprung, too. The mode is scaled to 1 there.

    Parameters
    ----------
    on : str
        "wheelsets", "bogies", "body", or one part, as "wheelset2" of every car.
    modal_mass_kg : float
        With the mode 1 at the point read; for a free beam of mass m read in its middle 0.68 m.
    frequency_Hz, loss_factor : float
        Of the free part.
    shape : float
        The mode where other springs hold the part: at the secondary suspension for the body, at the primary for a
        bogie, at the contact for a wheelset. Negative beyond the node: boxes of mass b on a spring to wheels of
        mass w are -b / w with a modal mass of b (b + w) / w.
    """

    type: Literal["flexible_mode"] = "flexible_mode"
    modal_mass_kg: PositiveFloat
    shape: Number = Field(default=1.0, ge=-10.0, le=10.0)


class DamperSeries(FrozenModel):
    """A spring in series with each damper of a suspension: i w c becomes i w c k / (k + i w c).

    Parameters
    ----------
    suspension : "primary" or "secondary"
    stiffness_N_per_m : float
        Of mount and oil together, of both sides, as the damping is.
    """

    type: Literal["damper_series"] = "damper_series"
    suspension: Literal["primary", "secondary"]
    stiffness_N_per_m: PositiveFloat


class AirSpring(FrozenModel):
    """Secondary springs of air with a reservoir behind an orifice (Nishimura's linear model).

    The stiffness k of the vehicle is that at rest; it becomes k (1 + rise i f / (transition + i f)).

    Parameters
    ----------
    rise : float
        Growth of the stiffness from rest to where the orifice passes no more air, relative to that at rest.
    transition_Hz : float
        Where half of the rise is reached, as the real part goes.
    """

    type: Literal["air_spring"] = "air_spring"
    rise: NonNegativeFloat
    transition_Hz: PositiveFloat


class Slider(FrozenModel):
    """A force along each suspension of a kind that saturates: F erf(v / (sqrt(2) v0)), dry friction or a blow-off.

    Over frequency it is the dashpot that does the same work on a motion of a normal distribution, which
    :mod:`permway.response.sliding` finds; at rest its slope there. Its velocity is taken between the degrees as
    they are read, flexible modes or not.

    Parameters
    ----------
    suspension : "primary" or "secondary"
    force_N : float
        F, the most it gives, of both sides, as the damping is.
    velocity_m_per_s : float
        v0, at which it gives two thirds of that.
    alone : bool
        Whether it stands for the damper of that suspension: one that blows off. Else it acts beside it.
    rms_m_per_s : float
        Root mean square of the velocity at work; 0 at rest.
    """

    type: Literal["slider"] = "slider"
    suspension: Literal["primary", "secondary"]
    force_N: PositiveFloat
    velocity_m_per_s: PositiveFloat
    alone: bool = False
    rms_m_per_s: NonNegativeFloat = 0.0

    @property
    def damping_Ns_per_m(self) -> float:
        """Of the dashpot that it works as (Booton 1954)."""
        return self.force_N * math.sqrt(2.0 / math.pi) / math.hypot(self.velocity_m_per_s, self.rms_m_per_s)


AnyAddition = Annotated[Resonator | FlexibleMode | DamperSeries | AirSpring | Slider, Field(discriminator="type")]
"""Any addition, distinguished by its `type`."""


def check_additions(additions: Sequence[AnyAddition]) -> None:
    """Refuse a suspension that is described twice.

    Raises
    ------
    ValidationError
        With the place of the second.
    """
    seen: set[str] = set()
    for index, addition in enumerate(additions):
        if isinstance(addition, Resonator | FlexibleMode):
            continue
        if isinstance(addition, Slider):
            # One that stands for the damper leaves nothing for a spring in series.
            kinds = {f"{addition.suspension} slider", *([addition.suspension] if addition.alone else [])}
        else:
            kinds = {addition.suspension if isinstance(addition, DamperSeries) else "air"}
        if kinds & seen:
            what = "there is another of that kind: its suspension would be described twice"
            raise fault(what, "additions", index)
        seen |= kinds


def attached_mass_kg(additions: Sequence[AnyAddition]) -> float:
    """Mass that resonators add to a car."""
    return sum(a.mass_kg * len(a.at()) for a in additions if isinstance(a, Resonator))
