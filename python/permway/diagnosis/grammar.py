"""Mechanics outside the catalogue: small elements put where something acts that no named effect explains.

An element of up to three constants (spring, dashpot, springpot, Maxwell's pair, mass on a spring, standing rod; of
either sign where the sign is free) is added to one joint, to every joint of a layer, or to a place of a body. What
fits best is a description, not a name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from permway.diagnosis.catalogue._change import fixed_mass, fresh, hung_mass, with_joints, with_law
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Amend, Hypothesis, Situation, Where, between_free, linear_free, log_free
from permway.diagnosis.locate import Found
from permway.diagnosis.verdict import NOVEL
from permway.laws import Hysteretic, Maxwell, Parallel, Scaled, Springpot
from permway.laws.base import Law
from permway.model.joints import GROUND, Joints
from permway.recordings.campaign import Campaign

ROD_MODES = 4
"""Of a rod that are modelled; those above count as mass."""

RESONANCES_HZ = np.geomspace(4.0, 150.0, 12)
"""Where resonances are looked for, beside where the free stiffness is best known."""

BESIDE_M = 2.0
"""How far from the most telling place of a scan something may stand."""

AT_HZ = 100.0
"""Where the stiffness of a springpot is counted."""

Values = Mapping[str, float]


@dataclass(frozen=True)
class Element:
    """A kind of element.

    Attributes
    ----------
    name : str
    free : callable
        From a typical stiffness in N/m and the frequency where it acts to the constants.
    law : callable
        From the constants to the law that is added.
    words : callable
    ground : bool
        Whether it hangs on one body; else it ties what a joint ties.
    """

    name: str
    free: Callable[[float, float], tuple[Free, ...]]
    law: Callable[[Values], Law]
    words: Callable[[Values], str]
    ground: bool = False


def _spring(v: Values) -> Law:
    return Scaled(law=Hysteretic(stiffness=1.0, loss_factor=v["loss_factor"]), factor=v["stiffness_N_per_m"])


def _dashpot(v: Values) -> Law:
    return Scaled(law=Springpot(coefficient=1.0, order=1.0), factor=v["damping_Ns_per_m"])


def _springpot(v: Values) -> Law:
    at = float((2.0 * np.pi * AT_HZ) ** v["order"])
    return Scaled(law=Springpot(coefficient=1.0, order=v["order"]), factor=v["stiffness_N_per_m"] / at)


def _maxwell(v: Values) -> Law:
    stiffness = v["stiffness_N_per_m"]
    return Maxwell(stiffness=stiffness, damping=stiffness / (2.0 * np.pi * v["frequency_Hz"]))


def _resonator(v: Values) -> Law:
    return hung_mass(v["mass_kg"], v["frequency_Hz"], v["loss_factor"])


def _rod(v: Values) -> Law:
    """A rod that is held below and free above: of its modes, 1, 3, 5 ... quarter waves long, each carries less."""
    law: Law = fixed_mass(0.0)
    left = v["mass_kg"]
    for odd in range(1, 2 * ROD_MODES, 2):
        mass = 8.0 / (np.pi * odd) ** 2 * v["mass_kg"]
        law = Parallel(first=law, second=hung_mass(mass, odd * v["frequency_Hz"], v["loss_factor"]))
        left -= mass
    # The modes above move with the body.
    return Parallel(first=law, second=fixed_mass(left))


def _signed(name: str, unit: str, size: float) -> Free:
    return linear_free(name, unit, 0.0, size, -8.0 * size, 8.0 * size)


ELEMENTS = (
    Element(
        "spring",
        lambda k, f: (_signed("stiffness_N_per_m", "N/m", k), between_free("loss_factor", "1", 0.0, 2.0)),
        _spring,
        lambda v: f"a spring of {v['stiffness_N_per_m']:.3g} N/m, loss factor {v['loss_factor']:.2g}",
    ),
    Element(
        "dashpot",
        lambda k, f: (_signed("damping_Ns_per_m", "N s/m", k / (2.0 * np.pi * f)),),
        _dashpot,
        lambda v: f"a dashpot of {v['damping_Ns_per_m']:.3g} N s/m",
    ),
    Element(
        "springpot",
        lambda k, f: (
            _signed("stiffness_N_per_m", "N/m", k),
            between_free("order", "1", 0.02, 0.98),
        ),
        _springpot,
        lambda v: f"a springpot of order {v['order']:.2f}, {v['stiffness_N_per_m']:.3g} N/m at {AT_HZ:g} Hz",
    ),
    Element(
        "maxwell",
        lambda k, f: (log_free("stiffness_N_per_m", "N/m", k, 3.0), log_free("frequency_Hz", "Hz", f, 3.0)),
        _maxwell,
        lambda v: (
            f"a spring of {v['stiffness_N_per_m']:.3g} N/m in series with a dashpot, relaxing at "
            f"{v['frequency_Hz']:.3g} Hz"
        ),
    ),
    Element(
        "resonator",
        lambda k, f: (
            log_free("mass_kg", "kg", k / (2.0 * np.pi * f) ** 2, 5.0),
            log_free("frequency_Hz", "Hz", f, 2.0),
            log_free("loss_factor", "1", 0.1, 2.5),
        ),
        _resonator,
        lambda v: (
            f"a resonator of {v['mass_kg']:.3g} kg at {v['frequency_Hz']:.3g} Hz, loss factor "
            f"{v['loss_factor']:.2g}"
        ),
        ground=True,
    ),
    Element(
        "rod",
        lambda k, f: (
            log_free("mass_kg", "kg", k / (2.0 * np.pi * f) ** 2, 5.0),
            log_free("frequency_Hz", "Hz", f, 2.0),
            log_free("loss_factor", "1", 0.1, 2.5),
        ),
        _rod,
        lambda v: (
            f"a standing rod of {v['mass_kg']:.3g} kg, a quarter wave long at {v['frequency_Hz']:.3g} Hz, loss "
            f"factor {v['loss_factor']:.2g}"
        ),
        ground=True,
    ),
)


def hypotheses(situation: Situation, like: Values | None = None) -> Iterator[Hypothesis]:
    """Each element at the most telling joint, in its whole layer, and at the most telling place of a body.

    Parameters
    ----------
    situation : Situation
    like : mapping of name to float, optional
        Of a mass on a spring that explained part: what hangs on a body is looked for from there.
    """
    joint = next((f for f in situation.found if f.spot.kind == "joint"), None)
    body = next((f for f in situation.found if f.spot.kind == "body"), None)
    for element in ELEMENTS:
        if not element.ground and joint is not None:
            yield _at_joint(situation, element, joint)
            yield _in_layer(element, joint)
        if body is not None:
            yield _on_body(element, body, like)


def _typical(found: Found) -> tuple[float, float]:
    """Size of the free stiffness where it is best known, and at which frequency."""
    known = np.abs(found.stiffness_N_per_m) / np.maximum(found.sigma_N_per_m, 1e-300)
    weight = known * np.maximum(found.by_band, 0.0)
    best = int(np.argmax(weight))
    return float(max(np.abs(found.stiffness_N_per_m[best]), 1.0)), float(found.frequency_Hz[best])


def _made(element: Element, place: str, free: tuple[Free, ...], where: Where, amend: Amend) -> Hypothesis:
    starts = [tuple(0.5 if i == 0 else 0.0 for i in range(len(free)))]
    if element.ground:
        # A resonance is met from close by only.
        centre = free[1].value(0.0)
        rest = (0.0,) * (len(free) - 2)
        starts += [(0.0, float(np.log2(f / centre)), *rest) for f in RESONANCES_HZ]
    if free[0].limits[0] < 0.0 and not element.ground:
        starts.append(tuple(-0.5 if i == 0 else 0.0 for i in range(len(free))))
    return Hypothesis(
        entry=NOVEL,
        domain="path",
        family=f"{element.name} {place}",
        free=free,
        amend=amend,
        locate=lambda _: where,
        starts=tuple(starts),
        law=lambda v: f"{element.words(v)}, {place}",
        size=free[0].name,
        none=0.0,
    )


def _at_joint(situation: Situation, element: Element, found: Found) -> Hypothesis:
    line = situation.campaign.model.line
    table = line.joint_table()
    layer = line.joints[int(table.layer[found.spot.joints[0]])]
    x = found.spot.x_m[0]

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        joints = Joints(between=layer.between, law=name, at=(x,))
        return with_joints(campaign, joints, laws={name: element.law(values)})

    return _made(
        element, "beside one joint", element.free(*_typical(found)), Where(found.spot.name, (x, x)), amend
    )


def _in_layer(element: Element, found: Found) -> Hypothesis:
    name = found.spot.name

    def amend(campaign: Campaign, values: Values) -> Campaign:
        law = campaign.model.line.laws[name]
        return with_law(campaign, name, Parallel(first=law, second=element.law(values)))

    return _made(
        element, "beside every joint of the layer", element.free(*_typical(found)), Where(found.spot.name), amend
    )


def _on_body(element: Element, found: Found, like: Values | None = None) -> Hypothesis:
    x = found.spot.x_m[0]
    free = element.free(*_typical(found))
    if element.ground and like is not None:
        mass, frequency, loss = (like[name] for name in ("mass_kg", "frequency_Hz", "loss_factor"))
        free = (
            log_free("mass_kg", "kg", mass, 2.0),
            log_free("frequency_Hz", "Hz", frequency, 1.5),
            log_free("loss_factor", "1", loss, 2.0),
        )
    if element.ground:
        # The scan looks at places a metre apart.
        free = (*free, linear_free("x_m", "m", x, 0.5, x - BESIDE_M, x + BESIDE_M))

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        joints = Joints(between=(found.spot.name, GROUND), law=name, at=(values.get("x_m", x),))
        return with_joints(campaign, joints, laws={name: element.law(values)})

    made = _made(element, "on the body", free, Where(found.spot.name, (x, x)), amend)
    return replace(made, locate=lambda v: Where(found.spot.name, (v.get("x_m", x), v.get("x_m", x))))
