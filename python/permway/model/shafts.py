"""Bodies that roll about an axis along the line, as seen from a distance to that axis."""

from __future__ import annotations

from typing import Literal

from pydantic import PositiveFloat, model_validator

from permway.model.faults import fault
from permway.model.slender import Factor, SectionChange, Slender, check_changes


class ShaftChange(SectionChange):
    """Another section of a shaft from one place to another.

    Parameters
    ----------
    from_m, to_m : float
        The interval.
    torsion_factor, mass_factor : float
        On torsional stiffness, and on rotational inertia.
    """

    torsion_factor: Factor = 1.0


class Shaft(Slender):
    """A body that rolls about its axis (Saint-Venant torsion), or a row of equal ones.

    Its displacement is that of a place beside the axis, w = y phi: a force there twists it as a torque F y. So
    joints and forces at that distance join a shaft as they join a beam, with S = G J / y^2 for stiffness and
    m = rho I_p / y^2 for mass per length: S w'' + m omega^2 w = -f.

    Parameters
    ----------
    shear_modulus_Pa, torsion_constant_m4 : float
        G and J of the whole section; J is not the polar moment unless the section is round.
    density_kg_per_m3, polar_moment_m4 : float
        rho and I_p = I_y + I_z of the whole section.
    arm_m : float
        y, m. With 1 displacements are angles (rad) and forces torques (N m).
    loss_factor, intervals_m, ends, share
        As of a beam; a pinned end does not roll.
    changes : sequence of ShaftChange
        Where the section is another.
    """

    type: Literal["shaft"] = "shaft"
    shear_modulus_Pa: PositiveFloat
    torsion_constant_m4: PositiveFloat
    density_kg_per_m3: PositiveFloat
    polar_moment_m4: PositiveFloat
    arm_m: PositiveFloat
    changes: tuple[ShaftChange, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Shaft:
        for key, slipped, what in (
            ("shear_modulus_Pa", self.shear_modulus_Pa < 1e5, "is softer than rubber: give it in Pa, not GPa"),
            (
                "density_kg_per_m3",
                self.density_kg_per_m3 < 20.0,
                "is below any solid: give it in kg/m3, not t/m3",
            ),
            ("loss_factor", self.loss_factor > 5.0, "is above any material's: give it as a ratio, not in percent"),
            ("arm_m", not 1e-3 <= self.arm_m <= 100.0, "is no distance on a track: give it in metres"),
            # Saint-Venant: no section is stiffer in torsion than a round one of its polar moment.
            (
                "torsion_constant_m4",
                self.torsion_constant_m4 > self.polar_moment_m4 * (1.0 + 1e-9),
                f"is above polar_moment_m4 = {self.polar_moment_m4:g}, which no section's is",
            ),
        ):
            if slipped:
                raise fault(f"{key} = {getattr(self, key):g} {what}", key)
        check_changes(self.changes, self.intervals_m)
        return self

    @property
    def mass_kg_per_m(self) -> float:
        """Mass rho I_p / y^2 of the model's share, kg/m."""
        return self.share * self.density_kg_per_m3 * self.polar_moment_m4 / self.arm_m**2

    @property
    def shear_N(self) -> complex:
        """Complex stiffness G J / y^2 of the model's share, N."""
        modulus = self.shear_modulus_Pa * complex(1.0, self.loss_factor)
        return self.share * modulus * self.torsion_constant_m4 / self.arm_m**2

    @property
    def bending_Nm2(self) -> complex:
        """A shaft does not bend: 0, by which the core knows it."""
        return 0j

    @property
    def rotary_kg_m(self) -> float:
        """0, as there is no bending."""
        return 0.0

    @property
    def modes(self) -> None:
        """A shaft has its closed form."""
        return None
