"""Random lines of railway magnitudes, for properties that hold whatever the line.

Ranges are log-uniform where a magnitude spans decades: rails to box girders, baseplate pads to bearings, loss
factors 0.005 to 0.5 in everything. Beams of both theories, with or without ends, free or pinned, lie anywhere
over 60 m and overlap as they happen to.

A beam in three has another section over one or two intervals, a millimetre to all of it, and every fifth body is a
shaft.

Four bounds are there for rounding's sake, each where the other formulation, against 60 digits, kept 1e-12 or
better. A free body of mass m has the receptance 1/(m omega^2), and what a joint k leaves of it loses k/(m omega^2)
of the dense system's digits: hence beams from 50 kg/m and 2 m on, masses from 100 kg on, joints to 9e9 N/m, which
leave nine at 1 Hz. The impedance that is marched loses k |H| in a joint much stiffer than all that it ties, which
the same bound keeps; and at d behind a pin on the left it is of the size E I / d^3, of which the turning of a bar
that nothing else holds is a small remainder (2e-9 off with a joint at a twentieth of its length, 5e-9 with a
change of section a millimetre from it): hence the margin of :func:`extent`, which changes keep too.
"""

import math

import numpy as np
from hypothesis import strategies as st
from permway.laws import FractionalKelvinVoigt, FractionalZener, Hysteretic, KelvinVoigt, Zener
from permway.model.bodies import Beam, BeamChange, Mass, Shaft
from permway.model.joints import GROUND, Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m
from permway.model.shafts import ShaftChange
from permway.response.receptance import receptance

REACH_M = 30.0
# The paper's pad at 20 and at -30 degC, as constants.
SOFT_PAD = Hysteretic(stiffness=62.7e6, loss_factor=0.122)
STIFF_PAD = Hysteretic(stiffness=190e6, loss_factor=0.647)


def between(low, high):
    return st.floats(low, high, allow_nan=False)


def decades(low, high):
    """Log-uniform from low to high."""
    return between(math.log10(low), math.log10(high)).map(lambda exponent: 10.0**exponent)


def frequencies(count=3):
    """Ascending frequencies, 1 to 3000 Hz."""
    distinct = st.lists(decades(1.0, 3000.0), min_size=1, max_size=count, unique_by=lambda f: round(f, 6))
    return distinct.map(sorted)


KINDS = ["hysteretic", "kelvin_voigt", "zener", "fractional_kelvin_voigt", "fractional_zener"]


@st.composite
def laws(draw):
    """A passive law, 1e6 to 3e9 N/m, loss factor 0.005 to 0.5 somewhere in the band."""
    stiffness, loss = draw(decades(1e6, 3e9)), draw(decades(0.005, 0.5))
    corner = 2.0 * math.pi * draw(decades(1.0, 3000.0))
    kind = draw(st.sampled_from(KINDS))
    if kind == "hysteretic":
        return Hysteretic(stiffness=stiffness, loss_factor=loss)
    if kind == "kelvin_voigt":
        return KelvinVoigt(stiffness=stiffness, damping=stiffness * loss / corner)
    if kind == "zener":
        return Zener(relaxed=stiffness, unrelaxed=stiffness * (1.0 + 2.0 * loss), relaxation_time_s=1.0 / corner)
    order = draw(between(0.1, 0.9))
    if kind == "fractional_kelvin_voigt":
        return FractionalKelvinVoigt(
            stiffness=stiffness, coefficient=stiffness * loss / corner**order, order=order
        )
    return FractionalZener(
        relaxed=stiffness, unrelaxed=stiffness * (1.0 + 4.0 * loss), relaxation_time_s=1.0 / corner, order=order
    )


@st.composite
def stretches(draw, interval, ends):
    """None, one or two intervals on a body, to the millimetre, often to its end; not cut near a pin."""
    start, stop = interval or (-REACH_M, REACH_M)
    margin = 0.1 * (stop - start) if interval else 0.0
    low, high = start + margin * (ends[0] == "pinned"), stop - margin * (ends[1] == "pinned")
    places = sorted({station(draw, low, high) for _ in range(draw(st.sampled_from([0, 0, 2, 4])))})
    pairs = [pair for pair in zip(places[::2], places[1::2], strict=False) if pair[1] - pair[0] > 1e-4]
    return [(start if a == low else a, stop if b == high else b) for a, b in pairs]


@st.composite
def shafts(draw, *, finite=None, lossless=False):
    """A slab, base plate or girder that rolls, seen from 0.75 m: 0.2 to 5 m wide, 0.1 m high or more."""
    width, height = draw(decades(0.2, 5.0)), draw(decades(0.1, 3.0))
    low, high = sorted((width, height))
    interval = _interval(draw, height) if (draw(st.booleans()) if finite is None else finite) else None
    factor, ends = decades(0.1, 3.0), (draw(_ENDS), draw(_ENDS))
    return Shaft(
        shear_modulus_Pa=draw(decades(8e9, 8e10)),
        torsion_constant_m4=high * low**3 / 3.0 * (1.0 - 0.63 * low / high),
        density_kg_per_m3=draw(between(2300.0, 7850.0)),
        polar_moment_m4=low * high * (low**2 + high**2) / 12.0,
        # No lighter than a beam: 50 kg/m.
        arm_m=min(0.75, math.sqrt(2300.0 * low * high * (low**2 + high**2) / 12.0 / 50.0)),
        loss_factor=0.0 if lossless else draw(decades(0.005, 0.5)),
        intervals_m=interval,
        ends=ends,
        changes=[
            ShaftChange(from_m=a, to_m=b, torsion_factor=draw(factor), mass_factor=draw(factor))
            for a, b in draw(stretches(interval[0] if interval else None, ends))
        ],
    )


def _interval(draw, height):
    start = round(draw(between(-REACH_M, REACH_M)), 3)
    length = draw(decades(max(5.0 * height, 2.0), min(max(50.0 * height, 10.0), 60.0)))
    return ((start, round(start + length, 3)),)


@st.composite
def beams(draw, *, finite=None, lossless=False, uniform=False):
    """A rail, slab, base plate or girder: 0.1 to 3 m high, up to 3 m wide, from 50 kg/m, 20 to 210 GPa.

    With ends it is 5 to 50 heights long, since a shorter block is no beam, and at least 2 m.
    """
    modulus, height, density = draw(decades(2e10, 2.1e11)), draw(decades(0.1, 3.0)), draw(between(2300.0, 7850.0))
    area = height * draw(decades(max(0.25 * height, 50.0 / (density * height)), 3.0))
    # From a solid section (1/12) towards all of it in two flanges (1/4).
    second = area * height**2 * draw(between(1.0 / 12.0, 0.2))
    timoshenko, with_ends = draw(st.booleans()), draw(st.booleans()) if finite is None else finite
    interval = _interval(draw, height) if with_ends else None
    factor, ends = decades(0.1, 3.0), (draw(_ENDS), draw(_ENDS))
    where = [] if uniform else draw(stretches(interval[0] if interval else None, ends))
    return Beam(
        theory="timoshenko" if timoshenko else "euler",
        youngs_modulus_Pa=modulus,
        second_moment_m4=second,
        density_kg_per_m3=density,
        area_m2=area,
        shear_modulus_Pa=modulus / draw(between(2.3, 2.7)) if timoshenko else None,
        shear_coefficient=draw(between(0.3, 0.87)) if timoshenko else None,
        loss_factor=0.0 if lossless else draw(decades(0.005, 0.5)),
        **({} if lossless else draw(_VISCOUS)),
        intervals_m=interval,
        ends=ends,
        changes=[
            BeamChange(
                from_m=a,
                to_m=b,
                bending_factor=draw(factor),
                shear_factor=draw(factor) if timoshenko else 1.0,
                mass_factor=draw(factor),
            )
            for a, b in where
        ],
    )


_ENDS = st.sampled_from(["free", "pinned"])
_VISCOUS = st.fixed_dictionaries(
    {},
    optional={
        "damping_ratio": decades(0.002, 0.2),
        "mass_damping_per_s": decades(0.1, 50.0),
        "stiffness_damping_s": decades(1e-6, 1e-3),
    },
)


def extent(body):
    """Where a beam can be joined or pushed: not within a tenth of its length of a pin, which does not move."""
    if body.intervals_m is None:
        return -REACH_M, REACH_M
    (start, stop), (left, right) = body.intervals_m[0], body.pinned
    margin = 0.1 * (stop - start)
    return start + left * margin, stop - right * margin


def station(draw, start, stop):
    """A place between two, to the millimetre, and often at one of them."""
    return min(max(round(start + draw(between(0.0, 1.0)) * (stop - start), 3), start), stop)


@st.composite
def layers(draw, bodies, laws, upper, lower):
    """Joints of one law at one to six stations that both beams, or beam and ground, reach; none if they part."""
    reaches = [extent(bodies[name]) for name in (upper, lower) if name != GROUND]
    start, stop = max(r[0] for r in reaches), min(r[1] for r in reaches)
    if start > stop:
        return []
    at = sorted({station(draw, start, stop) for _ in range(draw(st.integers(1, 6)))})
    return [_joints(draw, laws, upper, lower, at)]


def _joints(draw, laws, upper, lower, at):
    return Joints(
        between=(upper, lower), law=draw(st.sampled_from(laws)), at=tuple(at), scale=draw(decades(0.1, 3.0))
    )


@st.composite
def lines(draw, *, finite=None, lossless=False, uniform=False):
    """One to five beams and shafts, up to three masses at one station each, joints of them and the ground."""
    materials = {f"law{i}": law for i, law in enumerate(draw(st.lists(laws(), min_size=1, max_size=3)))}
    names = sorted(materials)
    shape = beams(finite=finite, lossless=lossless, uniform=uniform)
    if not uniform:
        shape = st.one_of(*([shape] * 4), shafts(finite=finite, lossless=lossless))
    bodies = {f"beam{i}": beam for i, beam in enumerate(draw(st.lists(shape, min_size=1, max_size=5)))}
    joints = []
    for name in bodies:
        for _ in range(draw(st.integers(0, 2))):
            below = draw(st.sampled_from([GROUND, *(other for other in bodies if other != name)]))
            joints += draw(layers(bodies, names, name, below))
    for i, mass in enumerate(draw(st.lists(decades(100.0, 20_000.0), max_size=3))):
        above = draw(st.sampled_from(_beams(bodies)))
        x = station(draw, *extent(bodies[above]))
        bodies[f"mass{i}"] = Mass(mass_kg=mass)
        joints.append(_joints(draw, names, above, f"mass{i}", [x]))
        if draw(st.booleans()):
            joints.append(_joints(draw, names, f"mass{i}", GROUND, [x]))
    return Line(bodies=bodies, joints=tuple(joints), laws=materials)


def _beams(bodies):
    return [name for name, body in bodies.items() if not isinstance(body, Mass)]


@st.composite
def places(draw, line, count=4):
    """Distinct places on beams anywhere, on masses where they are joined."""
    found = set()
    for _ in range(draw(st.integers(1, count))):
        name = draw(st.sampled_from(sorted(line.bodies)))
        body = line.bodies[name]
        if isinstance(body, Mass):
            x = next(layer.at[0] for layer in line.joints if name in layer.between)
        else:
            x = station(draw, *extent(body))
        found.add((name, x))
    return [Place(body=name, x_m=x, name=f"place{i}") for i, (name, x) in enumerate(sorted(found))]


@st.composite
def solvable(draw, **options):
    """A line, places on it and frequencies."""
    line = draw(lines(**options))
    return line, draw(places(line)), draw(frequencies())


def paper_line(*, pad=SOFT_PAD, **options):
    """The paper's line on pads that need no temperature."""
    return slab_track_viaduct_32m(pad=pad, **options)


def respond(line, places, frequency, *, formulation="chain"):
    """Receptances between all places, (F, P, P)."""
    data = receptance(line, frequency, forces=places, sensors=places, formulation=formulation, threads=1)
    return data["receptance"].values


def both(line, places, frequency):
    """By either formulation."""
    return respond(line, places, frequency), respond(line, places, frequency, formulation="receptance")


def magnitude(values):
    """What an error in a receptance is measured by: itself, or the direct ones at its two places if larger."""
    direct = np.abs(np.diagonal(values, axis1=1, axis2=2))
    return np.maximum(np.abs(values), np.sqrt(direct[:, :, None] * direct[:, None, :]))
