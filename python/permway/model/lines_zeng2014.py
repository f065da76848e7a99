"""The nine-span line of Zeng et al. (2014)."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from pydantic import Field

from permway.laws import AnyLaw, KelvinVoigt
from permway.model.bodies import Beam
from permway.model.joints import GROUND, Ends, Joints
from permway.model.line import Line
from permway.model.line_parts import approaches, chosen, concrete_row, fastener_of_zeng, intervals, repeated
from permway.records import FrozenModel

SPAN_M = 32.5
SLABS = 5
PITCH_M = SPAN_M / SLABS
SLAB_M = 6.45
SPACING_M = 0.65


class ZengLine(FrozenModel):
    """Options of the slab track on nine simply supported spans of Zeng et al. 2014 [1]_, both rails as one beam.

    ================  ====================================================  =======================================
    what              value                                                 source
    ================  ====================================================  =======================================
    rails             2.06e11 Pa, 2 x 3.217e-5 m4, 2 x 60.64 kg/m, Euler    Table 2
    slab              3.6e10 Pa, 1.6e-3 m4, 1200 kg/m                       Table 2
    girder            3.45e10 Pa, 12.744 m4, 29720 kg/m                     Table 2
    girder's damping  5 % of critical                                       Table 2; as a loss factor of 0.1
    fastener          2 x 5.0e7 N/m, 2 x 3.625e4 N s/m                      Table 2
    mortar            2 x 1.5e9 N/m2, 2 x 8.3e4 N s/m2                      Table 2
    bearing           6.0e9 N/m, 2.0e6 N s/m                                Table 2; of each end of a girder
    span              32.5 m                                                from the printed 5.72 and 22.89 Hz
    slabs             6.45 m, five on a span, 0.05 m apart                  assumed: not in the table
    fastener spacing  0.65 m, ten on a slab                                 assumed: not printed
    mortar springs    at the fasteners                                      assumed
    loss of steel     none                                                  not printed; the slab's likewise
    approaches        rails on fasteners on a rigid bed                     assumed
    ================  ====================================================  =======================================

    Parameters
    ----------
    spans : int
    girder : "elastic_bearings" or "pinned"
        Free girders on their bearings, or simply supported ones, which alone have the printed frequencies.
    approach_bays : int
        Bays of 0.65 m before and behind the bridge.
    pad : law
        Complex stiffness of one fastener, N/m.

    References
    ----------
    .. [1] Numerical Simulation of Vertical Random Vibration of Train-Slab Track-Bridge Interaction System by PEM,
       Shock and Vibration 2014, 304219.
    """

    spans: int = Field(default=9, ge=1, le=1000, strict=True)
    girder: Literal["elastic_bearings", "pinned"] = "elastic_bearings"
    approach_bays: int = Field(default=40, ge=0, le=10_000, strict=True)
    pad: AnyLaw = Field(default_factory=fastener_of_zeng)

    def line(self) -> Line:
        """The line, its spans from x = 0."""
        starts = SPAN_M * np.arange(self.spans, dtype=np.float64)
        gap = 0.5 * (PITCH_M - SLAB_M)
        slabs = [(PITCH_M * i + gap, PITCH_M * (i + 1) - gap) for i in range(SLABS)]
        stations = repeated(SPACING_M * (np.arange(round(SPAN_M / SPACING_M), dtype=np.float64) + 0.5), starts)
        at = tuple(stations.tolist())
        whole = (0.0, SPAN_M * self.spans)
        beyond = approaches(stations, self.approach_bays, SPACING_M)
        joints = [
            Joints(between=("rail", "slab"), law="pad", at=at, scale=2.0),
            Joints(between=("slab", "girder"), law="mortar", at=at, stiffness_is="per_metre", layer_m=whole),
            Joints(between=("girder", GROUND), law="bearing", at=Ends(of="girder")),
        ]
        if beyond:
            joints.append(Joints(between=("rail", GROUND), law="pad", at=beyond, scale=2.0))
        return Line(
            bodies={
                "rail": _rail(),
                # Areas follow from a density of 2500 kg/m3; only their product is printed.
                "slab": concrete_row(3.6e10, 1.6e-3, 2500.0, 0.48, 1.0, intervals(slabs, starts), loss_factor=0.0),
                "girder": concrete_row(
                    3.45e10,
                    12.744,
                    2500.0,
                    11.888,
                    1.0,
                    intervals([(0.0, SPAN_M)], starts),
                    pinned=self.girder == "pinned",
                ),
            },
            joints=tuple(joints),
            laws={
                "pad": self.pad,
                "mortar": KelvinVoigt(stiffness=3.0e9, damping=1.66e5),
                "bearing": KelvinVoigt(stiffness=6.0e9, damping=2.0e6),
            },
        )


def _rail() -> Beam:
    area = 7.745e-3
    return Beam(
        youngs_modulus_Pa=2.06e11,
        second_moment_m4=3.217e-5,
        density_kg_per_m3=60.64 / area,
        area_m2=area,
        share=2.0,
    )


def zeng2014_nine_spans(**options: Any) -> Line:
    """The line of Zeng et al. 2014; options as in :class:`ZengLine`."""
    return chosen(ZengLine, options).line()
