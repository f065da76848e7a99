"""What moves along a line: beams, shafts and masses."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from permway.model.faults import fault
from permway.model.shafts import Shaft as Shaft
from permway.model.slender import Factor, SectionChange, Slender, check_changes
from permway.model.stations import Interval as Interval
from permway.model.stations import MassesAt
from permway.model.stations import Metres as Metres
from permway.records import FrozenModel


class BeamChange(SectionChange):
    """Another section of a beam from one place to another: a crack, a thinned slab, a weld, a corroded foot.

    Parameters
    ----------
    from_m, to_m : float
        The interval.
    bending_factor, shear_factor : float
        On bending and shear stiffness.
    mass_factor : float
        On mass and rotary inertia.
    """

    bending_factor: Factor = 1.0
    shear_factor: Factor = 1.0


class Beam(Slender):
    """A beam, or a row of equal ones (the girders of several spans).

    Parameters
    ----------
    theory : "euler" or "timoshenko"
        Timoshenko needs the shear modulus and the shear coefficient.
    youngs_modulus_Pa, second_moment_m4, density_kg_per_m3, area_m2 : float
        Of the whole section.
    shear_modulus_Pa, shear_coefficient : float, optional
        Shear stiffness is coefficient x modulus x area.
    loss_factor : float
        Of both moduli, hysteretic: E (1 + i eta).
    damping_ratio : float
        Viscous, of critical: the same in every mode of a uniform beam on pinned ends, by dashpots
        2 zeta sqrt(E I m) per metre against its rotation.
    mass_damping_per_s, stiffness_damping_s : float
        Viscous, as Rayleigh's: c = alpha m + beta k, with alpha in 1/s and beta in s.
    intervals_m : sequence of (from, to), optional
        Where the beams lie; left out, the beam has no end on either side.
    ends : "free", "pinned" or "clamped", or one for each end
        A pinned end does not move and may turn; a clamped end does neither.
    rotation_law : str, or one for each end, optional
        Name of a law of the line, in N m/rad: a rotational spring between a pinned end and the ground; "" at
        an end that has none.
    modes : int, optional
        Number of bending modes that the receptance formulation sums, instead of the closed form.
    share : float
        Factor on stiffness and mass: 0.5 for the half model of one rail, 2 for two rails as one.
    changes : sequence of BeamChange
        Where the section is another; elsewhere the beam is uniform.
    """

    type: Literal["beam"] = "beam"
    theory: Literal["euler", "timoshenko"] = "euler"
    youngs_modulus_Pa: PositiveFloat
    second_moment_m4: PositiveFloat
    density_kg_per_m3: PositiveFloat
    area_m2: PositiveFloat
    shear_modulus_Pa: PositiveFloat | None = None
    shear_coefficient: PositiveFloat | None = None
    damping_ratio: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    mass_damping_per_s: NonNegativeFloat = 0.0
    stiffness_damping_s: NonNegativeFloat = 0.0
    rotation_law: str | tuple[str, str] = ""
    modes: int | None = Field(default=None, ge=1, le=10_000)
    changes: tuple[BeamChange, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Beam:
        shear = (self.shear_modulus_Pa, self.shear_coefficient)
        if self.theory == "timoshenko" and None in shear:
            raise ValueError("a timoshenko beam needs shear_modulus_Pa and shear_coefficient")
        if self.theory == "euler" and shear != (None, None):
            raise ValueError("an euler beam has no shear_modulus_Pa or shear_coefficient: use timoshenko")
        _check_units(self)
        self._check_ends()
        if self.modes is not None:
            if self.intervals_m is None:
                raise fault("modes need a beam with ends: give intervals_m", "modes")
            if self.theory == "timoshenko":
                raise fault("modes are for euler beams; the closed form of timoshenko needs none", "modes")
            if self.changes:
                raise fault("modes are for uniform beams; the closed form needs none", "modes")
            if self.is_viscous:
                raise fault("modes are for a constant loss factor; the closed form needs none", "modes")
        for index, change in enumerate(self.changes):
            if self.theory == "euler" and change.shear_factor != 1.0:
                raise fault("an euler beam has no shear stiffness", "changes", index, "shear_factor")
        check_changes(self.changes, self.intervals_m)
        return self

    def _check_ends(self) -> None:
        if self.intervals_m is None and (any(self.clamped) or any(self.rotation_laws)):
            raise fault("a beam without ends has none to hold: give intervals_m", "ends")
        for side, law in zip(("left", "right"), self.rotation_laws, strict=True):
            index = 0 if side == "left" else 1
            if law is not None and (not self.pinned[index] or self.clamped[index]):
                what = f"a rotational spring goes with a pinned end, and the {side} one is not"
                raise fault(what, "rotation_law", value=self.rotation_law)
        if self.modes is not None and (any(self.clamped) or any(self.rotation_laws)):
            raise fault("modes are for free and pinned ends; the closed form needs none", "modes")

    @property
    def rotation_laws(self) -> tuple[str | None, str | None]:
        """Law of the rotational spring at the left and the right end."""
        left, right = (self.rotation_law,) * 2 if isinstance(self.rotation_law, str) else self.rotation_law
        return left or None, right or None

    @property
    def is_viscous(self) -> bool:
        """Whether a part of its loss is viscous."""
        return (self.damping_ratio, self.mass_damping_per_s, self.stiffness_damping_s) != (0.0, 0.0, 0.0)

    @property
    def mass_kg_per_m(self) -> float:
        """Mass per length of the model's share, kg/m."""
        return self.share * self.density_kg_per_m3 * self.area_m2

    @property
    def bending_Nm2(self) -> complex:
        """Complex bending stiffness of the model's share, N m2."""
        return self.share * self.youngs_modulus_Pa * self.second_moment_m4 * complex(1.0, self.loss_factor)

    @property
    def shear_N(self) -> complex:
        """Complex shear stiffness of the model's share, N; 0 for an Euler-Bernoulli beam."""
        if self.shear_modulus_Pa is None or self.shear_coefficient is None:
            return 0j
        modulus = self.shear_modulus_Pa * complex(1.0, self.loss_factor)
        return self.share * self.shear_coefficient * modulus * self.area_m2

    @property
    def rotary_kg_m(self) -> float:
        """Rotary inertia per length of the model's share, kg m; 0 for an Euler-Bernoulli beam."""
        return self.share * self.density_kg_per_m3 * self.second_moment_m4 if self.theory == "timoshenko" else 0.0


class Mass(FrozenModel):
    """A point mass (sleeper, baseplate, pier cap, resonator), or a row of equal ones.

    Parameters
    ----------
    mass_kg : float
        Of each.
    at : sequence of float, Spread, sequence of Spread, or Ends, optional
        Where the masses of a row stand: "sleeper[1]" is the first. Left out, there is one mass, and the joints
        that hold it place it.
    """

    type: Literal["mass"] = "mass"
    mass_kg: PositiveFloat
    at: MassesAt | None = None


AnyBody = Annotated[Beam | Shaft | Mass, Field(discriminator="type")]


def _check_units(beam: Beam) -> None:
    """Refuse values that only a wrong unit explains."""
    shear = beam.shear_modulus_Pa
    radius = math.sqrt(beam.second_moment_m4 / beam.area_m2)
    for key, slipped, what in (
        (
            "youngs_modulus_Pa",
            beam.youngs_modulus_Pa < 1e6,
            "is softer than rubber: give it in Pa, not GPa or MPa",
        ),
        ("shear_modulus_Pa", shear is not None and shear < 1e5, "is softer than rubber: give it in Pa, not GPa"),
        ("density_kg_per_m3", beam.density_kg_per_m3 < 20.0, "is below any solid: give it in kg/m3, not t/m3"),
        ("loss_factor", beam.loss_factor > 5.0, "is above any material's: give it as a ratio, not in percent"),
        (
            "second_moment_m4",
            radius > 5.0,
            f"does not fit area_m2 = {beam.area_m2:g}, for its radius of gyration would be {radius:g} m: "
            "give both in metres, not cm4 or mm4",
        ),
        # A solid square has I = A^2 / 12, a strip a hundred times as wide as high a hundredth of that.
        (
            "area_m2",
            beam.second_moment_m4 < 1e-6 * beam.area_m2 * beam.area_m2,
            f"does not fit second_moment_m4 = {beam.second_moment_m4:g}: give both in metres, not cm2 or mm2",
        ),
    ):
        if slipped:
            raise fault(f"{key} = {getattr(beam, key):g} {what}", key)
