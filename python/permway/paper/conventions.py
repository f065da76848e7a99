"""Under which conventions the paper's numbers come out, and the right ones beside them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import xarray as xr

from permway.laws import AnyLaw
from permway.model.contact import GivenContact
from permway.model.irregularity import Conversion, GermanForm, GermanSato
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m
from permway.model.train import Train
from permway.model.vehicle_presets import crh380a
from permway.paper.printed import SPEED_M_PER_S
from permway.response.receptance import Progress
from permway.response.train import train_response

CENTRE_M = 16.0
"""The train stands over mid-span: its wheels at 6, 8.5, 23.5 and 26 m each stand over a fastener."""
CONTACT_N_PER_M = 1.3e9
FREQUENCY_HZ = np.arange(1.0, 201.0)
"""The paper's range; its printed frequencies are whole hertz."""


@dataclass(frozen=True)
class Convention:
    """A set of choices, with what it says of itself.

    Attributes
    ----------
    name, description : str
    girder : "pinned" or "elastic_bearings"
    german : "paper_eq28" or "right"
    conversion : "per_hertz" or "wavenumber_density_called_per_hertz"
    """

    name: str
    description: str
    girder: Literal["pinned", "elastic_bearings"]
    german: GermanForm
    conversion: Conversion

    @property
    def irregularity(self) -> GermanSato:
        """German low disturbance down to 1 m wavelength, Sato below."""
        return GermanSato(form=self.german)

    def run(
        self, pad: AnyLaw, temperature_C: float, *, threads: int | None = None, progress: Progress | None = None
    ) -> xr.Dataset:
        """Response of the paper's train on the paper's line with this pad, 1 to 200 Hz."""
        return train_response(
            slab_track_viaduct_32m(pad=pad, girder=self.girder),
            train(),
            self.irregularity,
            FREQUENCY_HZ,
            sensors=[Place(body="girder", x_m=CENTRE_M), Place(body="slab", x_m=CENTRE_M)],
            temperature_C=temperature_C,
            conversion=self.conversion,
            threads=threads,
            progress=progress,
        )


def train() -> Train:
    """CRH380A, half model, 350 km/h, over mid-span."""
    return Train(
        vehicle=crh380a(share=0.5),
        contact=GivenContact(stiffness_N_per_m=CONTACT_N_PER_M),
        centre_m=CENTRE_M,
        speed_m_per_s=SPEED_M_PER_S,
    )


PAPER = Convention(
    name="paper",
    description=(
        "as the paper computed: half model; girder modes simply supported, so that its bearings carry nothing; "
        "equation (28) as printed, with w_s where the German spectrum has w_c; densities over wavenumber called "
        "per hertz; Sato below 1 m wavelength"
    ),
    girder="pinned",
    german="paper_eq28",
    conversion="wavenumber_density_called_per_hertz",
)
PAPER_FREE_GIRDER = Convention(
    name="paper, free girder",
    description="as the paper computed, but the girder free-free on its elastic bearings",
    girder="elastic_bearings",
    german="paper_eq28",
    conversion="wavenumber_density_called_per_hertz",
)
RIGHT = Convention(
    name="right",
    description=(
        "half model; girder free-free on elastic bearings; German spectrum with w_c; true densities per hertz; "
        "Sato below 1 m wavelength"
    ),
    girder="elastic_bearings",
    german="right",
    conversion="per_hertz",
)
CONVENTIONS: Mapping[str, Convention] = {c.name: c for c in (PAPER, PAPER_FREE_GIRDER, RIGHT)}
