"""Lines by name, and the paper's own line."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from pydantic import Field

from permway.errors import InputError
from permway.laws import FVMP, TFDV, WLF, AnyLaw, Hysteretic
from permway.model.joints import Ends, Joints
from permway.model.line import Line
from permway.model.line_parts import chn60, chosen, concrete_row
from permway.model.lines_ballasted import ballasted_b91_60e1
from permway.model.lines_crts import crts_ii_viaduct_32m, crts_iii_viaduct_32m
from permway.model.lines_zeng2014 import zeng2014_nine_spans
from permway.records import FrozenModel, Number

SPAN_M = 32.0
SPACING_M = 0.625


def wj7b() -> TFDV:
    """Pad of the WJ-7B fastener over temperature and frequency: FVMP and WLF shift, equation (27).

    The paper prints no parameters that are one material, and no shift factors. These were identified by `permway
    reproduce` from tables 5 and 7 (convention "paper, free girder"; the law in its `tables.json`, to six digits).
    They are bound to 40 to 130 Hz at 20, -20 and -30 degC; elsewhere they extrapolate.
    """
    return TFDV(
        law=FVMP(
            mu1=4.51394e7,
            eta1=4.12694e6,
            mu2=1.66295e3,
            eta2=8.31033e3,
            alpha=0.00781863,
            beta=0.781728,
            gamma=0.254587,
        ),
        shift=WLF(c1=26.7139, c2_K=416.837, reference_temperature_C=20.0),
        reference_temperature_C=20.0,
        vertical="paper",
    )


def wj7b_constant(temperature_C: Literal[20, -20, -30] = 20) -> Hysteretic:
    """Pad of the WJ-7B fastener as a constant stiffness and loss factor, for one of the paper's temperatures.

    Identified freely at each temperature by `permway reproduce` (convention "paper, free girder").

    Parameters
    ----------
    temperature_C : 20, -20 or -30
    """
    identified = {20: (61.84e6, 0.1175), -20: (129.3e6, 0.4311), -30: (215.7e6, 0.7372)}
    if not isinstance(temperature_C, int | float) or temperature_C not in identified:
        raise InputError(
            "the paper has no such temperature",
            where="temperature_C",
            value=temperature_C,
            remedy='use 20, -20 or -30, or the law "wj7b", which depends on temperature',
        )
    stiffness, loss_factor = identified[temperature_C]
    return Hysteretic(stiffness=stiffness, loss_factor=loss_factor)


class SlabTrackViaduct(FrozenModel):
    """Options of the paper's line: rail, slab, base plate and box girder, Tables 2 and 3.

    32 m is 51.2 fastener spacings of 0.625 m, and the numbers of mortar and sliding springs are not printed.
    Chosen here: stations every 0.625 m, as many as fit, centred on each span (51 on one span); mortar and sliding
    springs at the fasteners, their printed stiffness being the total of a span.

    Parameters
    ----------
    model : "half" or "full"
        One rail with half of everything else, or both rails as one beam with everything whole.
    girder : "elastic_bearings" or "pinned"
        A free-free girder on its bearings, or the paper's: simply supported modes, which vanish at the
        bearings, so that the bearing springs carry nothing.
    spans : int
        Number of equal spans in a row; slab and base plate go on over all of them.
    fasteners : int
        Fasteners on a span.
    fastener_spacing_m : float
        Distance between them, m.
    layer_springs : int, optional
        Springs of the mortar and of the sliding layer on a span; by default at the fasteners.
    modes : int, optional
        Modes of slab, base plate and girder for the receptance formulation.
    pad : law
        Complex stiffness of one fastener, N/m; by default :func:`wj7b`, which needs a temperature.
    """

    model: Literal["half", "full"] = "half"
    girder: Literal["elastic_bearings", "pinned"] = "elastic_bearings"
    spans: int = Field(default=1, ge=1, le=1000, strict=True)
    fasteners: int = Field(default=51, ge=1, le=1000, strict=True)
    fastener_spacing_m: Number = Field(default=SPACING_M, gt=0.0)
    layer_springs: int | None = Field(default=None, ge=2, le=1000, strict=True)
    modes: int | None = Field(default=None, ge=1, le=10_000, strict=True)
    pad: AnyLaw = Field(default_factory=wj7b)

    def line(self) -> Line:
        """The line, spans running from x = 0.

        Raises
        ------
        InputError
            If the fasteners do not fit on a span.
        """
        reach = (self.fasteners - 1) * self.fastener_spacing_m
        if reach > SPAN_M:
            raise InputError(
                f"{self.fasteners} fasteners at {self.fastener_spacing_m:g} m do not fit on {SPAN_M:g} m",
                where="fasteners",
                value=self.fasteners,
                remedy="take fewer, or closer ones",
            )
        share, rails = (0.5, 1.0) if self.model == "half" else (1.0, 2.0)
        starts = SPAN_M * np.arange(self.spans)
        local = 0.5 * (SPAN_M - reach) + self.fastener_spacing_m * np.arange(self.fasteners)
        stations = tuple(float(x) for start in starts for x in start + local)
        layers = stations
        if self.layer_springs is not None:
            cell = SPAN_M / self.layer_springs
            layers = tuple(float(x) for s in starts for x in s + cell * (np.arange(self.layer_springs) + 0.5))
        # Equal springs, each with its part of the span's total.
        each = share / (self.layer_springs or self.fasteners)
        whole = (0.0, SPAN_M * self.spans)
        return Line(
            bodies={
                "rail": chn60(rails),
                "slab": concrete_row(3.6e10, 1.7e-3, 2500.0, 0.51, share, (whole,), self.modes),
                "base": concrete_row(3.0e10, 7.3125e-3, 2500.0, 0.975, share, (whole,), self.modes),
                "girder": concrete_row(
                    3.6e10,
                    11.056,
                    2650.0,
                    9.089,
                    share,
                    tuple((float(s), float(s) + SPAN_M) for s in starts),
                    self.modes,
                    pinned=self.girder == "pinned",
                ),
            },
            joints=(
                Joints(between=("rail", "slab"), law="pad", at=stations, scale=rails),
                Joints(between=("slab", "base"), law="mortar", at=layers, scale=each),
                Joints(between=("base", "girder"), law="sliding", at=layers, scale=each),
                Joints(between=("girder", "ground"), law="bearing", at=Ends(of="girder"), scale=share),
            ),
            laws={
                "pad": self.pad,
                "mortar": Hysteretic(stiffness=3.79e11, loss_factor=0.2),
                "sliding": Hysteretic(stiffness=2.1e11, loss_factor=0.2),
                "bearing": Hysteretic(stiffness=6e9, loss_factor=0.25),
            },
        )


def slab_track_viaduct_32m(**options: Any) -> Line:
    """The paper's line; options as in :class:`SlabTrackViaduct`."""
    return chosen(SlabTrackViaduct, options).line()


LINES: dict[str, Callable[..., Line]] = {
    "ballasted_b91_60e1": ballasted_b91_60e1,
    "crts_ii_viaduct_32m": crts_ii_viaduct_32m,
    "crts_iii_viaduct_32m": crts_iii_viaduct_32m,
    "slab_track_viaduct_32m": slab_track_viaduct_32m,
    "zeng2014_nine_spans": zeng2014_nine_spans,
}
"""Lines by the name that a model file uses."""

LAWS: dict[str, Callable[..., TFDV | Hysteretic]] = {"wj7b": wj7b, "wj7b_constant": wj7b_constant}
"""Laws by the name that a model file uses."""
