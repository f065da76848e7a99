"""Lines that several tests share."""

from permway.laws import Hysteretic
from permway.model.bodies import Beam, Mass
from permway.model.joints import GROUND, Joints, Spread
from permway.model.line import Line

DENSITY = 7850.0
AREA_M2 = 76.70e-4
MASS_KG_PER_M = 60.20


def uic60(*, loss_factor=0.0, theory="timoshenko"):
    """UIC60 as REFERENCE values have it: 60.20 kg/m (rho A is 60.2095), rotary inertia rho I, shear 0.4 G A."""
    area = MASS_KG_PER_M / DENSITY
    shear = {"shear_modulus_Pa": 81e9, "shear_coefficient": 0.4 * AREA_M2 / area} if theory == "timoshenko" else {}
    return Beam(
        theory=theory,
        youngs_modulus_Pa=210e9,
        second_moment_m4=3038.3e-8,
        density_kg_per_m3=DENSITY,
        area_m2=area,
        loss_factor=loss_factor,
        **shear,
    )


def supported(rail, *, count, spacing_m, pad, ballast=None, sleeper_kg=None):
    """A rail on `count` supports about x = 0: pads on the ground, or on sleepers on ballast."""
    reach = 0.5 * (count - 1) * spacing_m
    at = Spread(from_m=-reach, to_m=reach, spacing_m=spacing_m)
    if sleeper_kg is None:
        pads = Joints(between=("rail", GROUND), law="pad", at=at)
        return Line(bodies={"rail": rail}, joints=(pads,), laws={"pad": pad})
    bodies, joints = {"rail": rail}, []
    for number, x in enumerate(at.stations()):
        name = f"sleeper{number}"
        bodies[name] = Mass(mass_kg=sleeper_kg)
        joints.append(Joints(between=("rail", name), law="pad", at=(float(x),)))
        joints.append(Joints(between=(name, GROUND), law="ballast", at=(float(x),)))
    return Line(bodies=bodies, joints=tuple(joints), laws={"pad": pad, "ballast": ballast})


def hysteretic(value):
    """The complex stiffness k (1 + i eta) as a law."""
    return Hysteretic(stiffness=value.real, loss_factor=value.imag / value.real)
