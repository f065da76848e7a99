"""Ballasted track: 60E1 rail on B91 sleepers."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from permway.laws import AnyLaw, Hysteretic
from permway.model.bodies import Beam, Mass
from permway.model.joints import Ends, Joints
from permway.model.line import Line
from permway.model.line_parts import chosen
from permway.model.stations import Spread
from permway.records import FrozenModel, Number


def _pad() -> Hysteretic:
    return Hysteretic(stiffness=225e6, loss_factor=0.25)


def _ballast() -> Hysteretic:
    return Hysteretic(stiffness=20e6, loss_factor=1.0)


class BallastedTrack(FrozenModel):
    """Options of ballasted track with 60E1 rail and B91 concrete sleepers.

    ===================  ==========================================  ==========================================
    what                 value                                       source
    ===================  ==========================================  ==========================================
    rail 60E1            7670 mm2, 3038.3 cm4, 7850 kg/m3            EN 13674-1
    steel                E 210 GPa, G 81 GPa, kappa 0.4, loss 0.01   as for UIC60 in the literature; loss assumed
    half sleeper         150 kg: half of about 300 kg                assumed
    spacing              0.6 m                                       usual; assumed
    pad                  225 kN/mm, loss factor 0.25                 [1]_ Table 1
    ballast, half        20 kN/mm, loss factor 1                     [1]_ Table 1
    ===================  ==========================================  ==========================================

    Half a sleeper is a point mass. The stiffness of pads and ballast differs from line to line by
    more than a factor of three: replace the laws `pad` and `ballast` by what is known of yours.

    Parameters
    ----------
    model : "half" or "full"
        One rail on half sleepers, or both rails as one beam on whole sleepers.
    sleepers : int
        Number of sleepers, the first at x = 0; beyond them the rail hangs free.
    spacing_m : float
    sleeper_kg : float
        Of a whole sleeper.
    pad, ballast : law
        Complex stiffness of one pad, and of the ballast under half a sleeper, N/m.

    References
    ----------
    .. [1] Study on Transmission Characteristics of Vertical Rail Vibrations in Ballast Track, Mathematical
       Problems in Engineering 2017, 5872419.
    """

    model: Literal["half", "full"] = "half"
    sleepers: int = Field(default=101, ge=1, le=100_000, strict=True)
    spacing_m: Number = Field(default=0.6, gt=0.0, le=10.0)
    sleeper_kg: Number = Field(default=300.0, gt=0.0)
    pad: AnyLaw = Field(default_factory=_pad)
    ballast: AnyLaw = Field(default_factory=_ballast)

    def line(self) -> Line:
        """The line, its first sleeper at x = 0."""
        rails = 1.0 if self.model == "half" else 2.0
        reach = self.spacing_m * (self.sleepers - 1)
        at = Spread(from_m=0.0, to_m=reach, spacing_m=self.spacing_m)
        each = Ends(of="sleeper")
        return Line(
            bodies={
                "rail": _rail_60e1(rails),
                "sleeper": Mass(mass_kg=0.5 * rails * self.sleeper_kg, at=at),
            },
            joints=(
                Joints(between=("rail", "sleeper"), law="pad", at=each, scale=rails),
                Joints(between=("sleeper", "ground"), law="ballast", at=each, scale=rails),
            ),
            laws={"pad": self.pad, "ballast": self.ballast},
        )


def _rail_60e1(rails: float) -> Beam:
    return Beam(
        theory="timoshenko",
        youngs_modulus_Pa=2.1e11,
        second_moment_m4=3.0383e-5,
        density_kg_per_m3=7850.0,
        area_m2=7.67e-3,
        shear_modulus_Pa=8.1e10,
        shear_coefficient=0.4,
        loss_factor=0.01,
        share=rails,
    )


def ballasted_b91_60e1(**options: Any) -> Line:
    """Ballasted track; options as in :class:`BallastedTrack`."""
    return chosen(BallastedTrack, options).line()
