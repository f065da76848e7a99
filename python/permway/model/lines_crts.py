"""CRTS II and CRTS III slab track on viaducts of 32 m box girders."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from pydantic import Field

from permway.arrays import Reals
from permway.laws import AnyLaw, Hysteretic
from permway.model.bodies import AnyBody, Mass
from permway.model.joints import GROUND, Ends, Joints
from permway.model.line import Line
from permway.model.line_parts import (
    approaches,
    chn60,
    chosen,
    concrete_row,
    fastener_of_zeng,
    intervals,
    repeated,
)
from permway.model.stations import Interval, Spread
from permway.records import FrozenModel

PITCH_M = 32.7
"""From pier to pier; the girder of 32.6 m leaves a gap of 0.1 m."""

GIRDER_M = (0.05, 32.65)
BEARING_INSET_M = 0.55
II_SPACING_M = 0.65
III_SPACING_M = 0.63
III_GAP_M = 0.07
III_SLABS = ((4.925, 8, 0.617), *((5.6, 9, III_SPACING_M),) * 4, (4.925, 8, 0.617))
"""Length of each slab on a girder, its fasteners and their spacing."""


class CrtsViaduct(FrozenModel):
    """Options of both kinds of slab track.

    ================  =================================================  ==========================================
    what              value                                              source
    ================  =================================================  ==========================================
    rail CHN60        2.1e11 Pa, 3.217e-5 m4, 7850 kg/m3, 7.745e-3 m2    the paper's Tables 2, 3
    girder            3.6e10 Pa, 11.056 m4, 2650 kg/m3, 9.089 m2         the paper's Tables 2, 3
    girder's length   32.6 m, piers 32.7 m apart                         standard girder of "32 m"; assumed here
    fastener          5.0e7 N/m, 3.625e4 N s/m                           Zeng et al. 2014, Table 2
    bearing           6e9 N/m, loss factor 0.25, 0.55 m from the end     the paper's Tables 2, 3; place assumed
    pier and soil     8.7e9 N/m, loss factor 0.1, cap of 1.7e5 kg        assumed: a third of a pier of 10 m with
                                                                         5.2e4 kg/m, on 1e10 N/m of piles
    ================  =================================================  ==========================================

    Parameters
    ----------
    model : "half" or "full"
        One rail with half of everything else, or both rails as one beam with everything whole.
    spans : int
    piers : "rigid" or "elastic"
        Bearings on the ground, or on pier caps that two girders share, on pier and soil.
    approach_bays : int
        Bays of track before and behind the viaduct.
    pad : law
        Complex stiffness of one fastener, N/m.
    """

    model: Literal["half", "full"] = "half"
    spans: int = Field(default=10, ge=1, le=1000, strict=True)
    piers: Literal["rigid", "elastic"] = "rigid"
    approach_bays: int = Field(default=40, ge=0, le=10_000, strict=True)
    pad: AnyLaw = Field(default_factory=fastener_of_zeng)

    @property
    def rails(self) -> float:
        """Rails in the model's one beam."""
        return 1.0 if self.model == "half" else 2.0

    @property
    def starts_m(self) -> Reals:
        """Where the spans start, m."""
        return PITCH_M * np.arange(self.spans, dtype=np.float64)

    def below(self) -> tuple[dict[str, AnyBody], tuple[Joints, ...], dict[str, AnyLaw]]:
        """Girders, bearings and piers: bodies, joints and laws."""
        share = 0.5 * self.rails
        row = intervals([GIRDER_M], self.starts_m)
        bodies: dict[str, AnyBody] = {"girder": concrete_row(3.6e10, 11.056, 2650.0, 9.089, share, row)}
        laws: dict[str, AnyLaw] = {"bearing": Hysteretic(stiffness=6e9, loss_factor=0.25)}
        ends = Ends(of="girder", inset_m=BEARING_INSET_M, within_m=2.0)
        if self.piers == "rigid":
            bearings = Joints(between=("girder", GROUND), law="bearing", at=ends, scale=share)
            return bodies, (bearings,), laws
        bodies["cap"] = Mass(mass_kg=1.7e5 * share, at=ends)
        laws["pier"] = Hysteretic(stiffness=8.7e9, loss_factor=0.1)
        bearings = Joints(between=("girder", "cap"), law="bearing", at=ends, scale=share)
        shafts = Joints(between=("cap", GROUND), law="pier", at=Ends(of="cap"), scale=share)
        return bodies, (bearings, shafts), laws


class CrtsII(CrtsViaduct):
    """Options of CRTS II: slab and base plate go on over gaps and approaches; what is common as in CrtsViaduct.

    ================  =================================================  ==========================================
    what              value                                              source
    ================  =================================================  ==========================================
    slab              3.6e10 Pa, 1.7e-3 m4, 2500 kg/m3, 0.51 m2          the paper's Tables 2, 3
    base plate        3.0e10 Pa, 7.3125e-3 m4, 2500 kg/m3, 0.975 m2      the paper's Tables 2, 3
    mortar            3.79e11 N/m on 32 m, loss factor 0.2               the paper's Tables 2, 3, here per metre
    sliding layer     2.1e11 N/m on 32 m, loss factor 0.2                the paper's Tables 2, 3, here per metre
    fastener spacing  0.65 m                                             standard; assumed here
    bed of approach   2.2e8 N/m2, loss factor 0.1                        assumed: 75 MPa/m under 2.95 m
    ================  =================================================  ==========================================
    """

    def line(self) -> Line:
        """The line, its spans from x = 0."""
        rails, share = self.rails, 0.5 * self.rails
        length = PITCH_M * self.spans
        reach = self.approach_bays * II_SPACING_M
        whole = (-reach, length + reach)
        pads = _centred(whole, II_SPACING_M)
        spans = tuple(_centred((a, b), II_SPACING_M) for a, b in intervals([GIRDER_M], self.starts_m))
        bodies, joints, laws = self.below()
        on_pads = Joints(between=("rail", "slab"), law="pad", at=pads, scale=rails)
        mortar = Joints(
            between=("slab", "base"), law="mortar", at=pads, stiffness_is="per_metre", layer_m=whole, scale=share
        )
        sliding = Joints(
            between=("base", "girder"), law="sliding", at=spans, stiffness_is="per_metre", scale=share
        )
        layers = [on_pads, mortar, sliding]
        if self.approach_bays > 1:
            bed = tuple(_centred(part, II_SPACING_M) for part in ((-reach, 0.0), (length, length + reach)))
            layers.append(
                Joints(between=("base", GROUND), law="bed", at=bed, stiffness_is="per_metre", scale=share)
            )
            laws["bed"] = Hysteretic(stiffness=2.2e8, loss_factor=0.1)
        return Line(
            bodies={
                "rail": chn60(rails),
                "slab": concrete_row(3.6e10, 1.7e-3, 2500.0, 0.51, share, (whole,)),
                "base": concrete_row(3.0e10, 7.3125e-3, 2500.0, 0.975, share, (whole,)),
                **bodies,
            },
            joints=(*layers, *joints),
            laws={
                "pad": self.pad,
                "mortar": Hysteretic(stiffness=3.79e11 / 32.0, loss_factor=0.2),
                "sliding": Hysteretic(stiffness=2.1e11 / 32.0, loss_factor=0.2),
                **laws,
            },
        )


class CrtsIII(CrtsViaduct):
    """Options of CRTS III: finite slabs on finite base plates; what is common as in CrtsViaduct.

    ================  =================================================  ==========================================
    what              value                                              source
    ================  =================================================  ==========================================
    slabs on a span   4.925, 4 x 5.6, 4.925 m, 0.07 m apart              standard lengths; assumed here
    slab              2.5 x 0.29 m (0.2 m and 0.09 m of self-compacting  standard section; E, density and full bond
                      concrete), 3.6e10 Pa, 2500 kg/m3                   assumed
    base plate        2.9 x 0.2 m, as long as the slab, 3.25e10 Pa       standard section; assumed here
    fasteners         0.63 m apart, 9 on 5.6 m; 0.617 m, 8 on 4.925 m    standard for 5.6 m; the other assumed
    isolation layer   2.5e9 N/m2, loss factor 0.2                        assumed: 1e9 N/m3 under 2.5 m
    base on girder    1.2e10 N/m2, loss factor 0.2                       assumed: cast on; as the paper's mortar
    approaches        rail on fasteners on a rigid bed                   assumed
    ================  =================================================  ==========================================
    """

    def line(self) -> Line:
        """The line, its spans from x = 0."""
        rails, share = self.rails, 0.5 * self.rails
        slabs, local = _slabs_of_span()
        stations = repeated(local, self.starts_m)
        at = tuple(stations.tolist())
        whole = (0.0, PITCH_M * self.spans)
        row = intervals(slabs, self.starts_m)
        bodies, joints, laws = self.below()
        beyond = approaches(stations, self.approach_bays, III_SPACING_M)
        layers = [Joints(between=("rail", "slab"), law="pad", at=at, scale=rails)]
        for between, law in ((("slab", "base"), "isolation"), (("base", "girder"), "bond")):
            layers.append(
                Joints(between=between, law=law, at=at, stiffness_is="per_metre", layer_m=whole, scale=share)
            )
        if beyond:
            layers.append(Joints(between=("rail", GROUND), law="pad", at=beyond, scale=rails))
        return Line(
            bodies={
                "rail": chn60(rails),
                "slab": concrete_row(3.6e10, 2.5 * 0.29**3 / 12.0, 2500.0, 2.5 * 0.29, share, row),
                "base": concrete_row(3.25e10, 2.9 * 0.2**3 / 12.0, 2500.0, 2.9 * 0.2, share, row),
                **bodies,
            },
            joints=(*layers, *joints),
            laws={
                "pad": self.pad,
                "isolation": Hysteretic(stiffness=2.5e9, loss_factor=0.2),
                "bond": Hysteretic(stiffness=1.2e10, loss_factor=0.2),
                **laws,
            },
        )


def _slabs_of_span() -> tuple[list[tuple[float, float]], list[float]]:
    """Slabs and fasteners of one span, from its start, m; the girder's overhang is shared by both ends."""
    total = sum(length for length, _, _ in III_SLABS) + III_GAP_M * (len(III_SLABS) - 1)
    x = 0.5 * (PITCH_M - total)
    slabs, fasteners = [], []
    for length, count, spacing in III_SLABS:
        slabs.append((x, x + length))
        first = x + 0.5 * (length - (count - 1) * spacing)
        fasteners += [first + spacing * i for i in range(count)]
        x += length + III_GAP_M
    return slabs, fasteners


def _centred(reach: Interval, spacing_m: float) -> Spread:
    """As many stations as fit between two places, centred."""
    bays = int((reach[1] - reach[0]) / spacing_m - 1e-9)
    middle, half = 0.5 * (reach[0] + reach[1]), 0.5 * bays * spacing_m
    return Spread(from_m=middle - half, to_m=middle + half, spacing_m=spacing_m)


def crts_ii_viaduct_32m(**options: Any) -> Line:
    """CRTS II on a viaduct; options as in :class:`CrtsII`."""
    return chosen(CrtsII, options).line()


def crts_iii_viaduct_32m(**options: Any) -> Line:
    """CRTS III on a viaduct; options as in :class:`CrtsIII`."""
    return chosen(CrtsIII, options).line()
