"""Two rails on one slab: the antisymmetric half that belongs to a half model.

A line that is symmetric about its middle moves in two ways that do not see each other. Both rails alike: that is
the half model. One down, the other up: what carries them rolls by phi, so that at the rails, y to either side, it
moves by +-y phi. Seen from one rail, in w = y phi, a body that rolls is a shaft (G J / y^2, rho I_p / y^2), a mass
is m r^2 / y^2 with its radius of gyration r, and joints between such bodies, spread over a width b or standing at
+-a, have their stiffness times b^2 / (12 y^2) or a^2 / y^2.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, PositiveFloat, model_validator

from permway.errors import InputError
from permway.model.bodies import AnyBody, Beam, Mass
from permway.model.faults import fault
from permway.model.joints import GROUND, Joints
from permway.model.line import Line
from permway.model.shafts import Shaft, ShaftChange
from permway.records import FrozenModel


class Twisting(FrozenModel):
    """How a beam of the half model rolls.

    Parameters
    ----------
    shear_modulus_Pa, torsion_constant_m4, polar_moment_m4 : float
        G, J and I_p of the whole section; density, loss factor, intervals, ends and share are the beam's.
    changes : sequence of ShaftChange
        Where the section is another; a beam with changes needs them.
    """

    type: Literal["beam"] = "beam"
    shear_modulus_Pa: PositiveFloat
    torsion_constant_m4: PositiveFloat
    polar_moment_m4: PositiveFloat
    changes: tuple[ShaftChange, ...] = ()


class Rolling(FrozenModel):
    """How a mass of the half model rolls, or each of a row.

    Parameters
    ----------
    radius_m : float
        Radius of gyration about the axis.
    """

    type: Literal["mass"] = "mass"
    radius_m: PositiveFloat


class Lever(FrozenModel):
    """Where across the track joints resist a roll: spread evenly over a width, or at a distance to either side.

    Parameters
    ----------
    width_m : float, optional
        b: b^2 / 12 is the mean squared distance.
    arm_m : float, optional
        Instead: a to either side.
    """

    width_m: PositiveFloat | None = None
    arm_m: PositiveFloat | None = None

    @model_validator(mode="after")
    def _check(self) -> Lever:
        if (self.width_m is None) == (self.arm_m is None):
            raise fault("give width_m or arm_m")
        return self

    @property
    def squared_m2(self) -> float:
        """Mean squared distance from the axis, m2."""
        return self.arm_m**2 if self.arm_m is not None else (self.width_m or 0.0) ** 2 / 12.0


class Roll(FrozenModel):
    """What the antisymmetric half of a half model needs to know.

    Parameters
    ----------
    gauge_m : float
        Distance between the middles of the two rails, 2 y.
    bodies : dict of name to Twisting or Rolling
        The bodies that carry both rails. All others (rails, baseplates, dampers) stand under one rail each, and
        move up and down as they do.
    laws : dict of name to Lever
        Of each law that ties two bodies that roll, or one and the ground.
    """

    gauge_m: float = Field(gt=0.1, lt=10.0)
    bodies: dict[str, Annotated[Twisting | Rolling, Field(discriminator="type")]] = Field(min_length=1)
    laws: dict[str, Lever] = Field(default_factory=dict)


def antisymmetric(line: Line, roll: Roll) -> Line:
    """The antisymmetric half that belongs to a half model.

    Parameters
    ----------
    line : Line
        One rail and half of what carries both.
    roll : Roll

    Returns
    -------
    Line
        Bodies, joints and laws of the same names and places; displacements are those under the rail.

    Raises
    ------
    InputError
        For a body or a law that the line has not, a body of the other kind, a beam with changes without those of
        its twist, and joints between bodies that roll without a lever.
    """
    arm = 0.5 * roll.gauge_m
    for kind, named, there in (("bodies", roll.bodies, line.bodies), ("laws", roll.laws, line.laws)):
        for name in named:
            if name not in there:
                raise InputError(
                    "the line has no such name", where=f"{kind}.{name}", remedy=f"use one of {[*there]}"
                )
    bodies = {name: _rolled(name, body, roll, arm) for name, body in line.bodies.items()}
    joints = tuple(_levered(index, layer, roll, arm) for index, layer in enumerate(line.joints))
    return Line(bodies=bodies, joints=joints, laws=line.laws)


def _rolled(name: str, body: AnyBody, roll: Roll, arm_m: float) -> AnyBody:
    how = roll.bodies.get(name)
    if how is None:
        return body
    if isinstance(how, Twisting) and isinstance(body, Beam):
        if body.changes and not how.changes:
            raise InputError(
                "the beam's section changes, and its twist's does not",
                where=f"bodies.{name}.changes",
                remedy="give changes with torsion_factor, 1 where torsion is the same",
            )
        if body.is_viscous:
            raise InputError(
                "a beam that twists has a constant loss factor",
                where=f"bodies.{name}",
                remedy="give loss_factor, which is twice the damping ratio at resonance",
            )
        return Shaft(
            shear_modulus_Pa=how.shear_modulus_Pa,
            torsion_constant_m4=how.torsion_constant_m4,
            density_kg_per_m3=body.density_kg_per_m3,
            polar_moment_m4=how.polar_moment_m4,
            arm_m=arm_m,
            loss_factor=body.loss_factor,
            intervals_m=body.intervals_m,
            # What may not turn in bending does not roll either.
            ends=("pinned" if body.pinned[0] else "free", "pinned" if body.pinned[1] else "free"),
            share=body.share,
            changes=how.changes,
        )
    if isinstance(how, Rolling) and isinstance(body, Mass):
        return body.model_copy(update={"mass_kg": body.mass_kg * (how.radius_m / arm_m) ** 2})
    raise InputError(
        f"is a {body.type} on the line",
        where=f"bodies.{name}.type",
        value=how.type,
        remedy="a beam twists, a mass has a radius of gyration",
    )


def _levered(index: int, layer: Joints, roll: Roll, arm_m: float) -> Joints:
    rows = [body.split("[")[0] for body in layer.between]
    if not all(row == GROUND or row in roll.bodies for row in rows):
        return layer
    if layer.law not in roll.laws:
        raise InputError(
            f"joints[{index}] tie {rows[0]} to {rows[1]}, which roll, and their law has no lever",
            where=f"laws.{layer.law}",
            remedy="give width_m or arm_m",
        )
    return layer.model_copy(update={"scale": layer.scale * roll.laws[layer.law].squared_m2 / arm_m**2})
