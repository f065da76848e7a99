"""How much the results depend on what the paper does not say."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from permway.laws import AnyLaw
from permway.model.contact import GivenContact
from permway.model.presets import slab_track_viaduct_32m
from permway.paper.conventions import CENTRE_M, FREQUENCY_HZ, Convention, train
from permway.paper.printed import TEMPERATURES_C
from permway.paper.readings import MINIMUM_BAND_HZ, PEAK_BAND_HZ, Curves, extremum
from permway.response.train import train_response


@dataclass(frozen=True)
class Choice:
    """One choice, with force peak (N, Hz) and flexibility minimum (Hz) at each temperature."""

    name: str
    force_N: dict[int, float]
    force_Hz: dict[int, float]
    minimum_Hz: dict[int, float]

    def as_dict(self) -> dict[str, Any]:
        """The choice as plain data."""
        return asdict(self)


def choices(convention: Convention, pad: AnyLaw) -> list[Choice]:
    """The base and its variations, the pad's law unchanged."""
    line: dict[str, dict[str, Any]] = {
        "base: 51 fasteners and springs, wheels over fasteners, contact 1.3 GN/m": {},
        "26 mortar and sliding springs": {"layer_springs": 26},
        "103 mortar and sliding springs": {"layer_springs": 103},
        "52 fasteners (wheels at mid-bay)": {"fasteners": 52},
        "three spans": {"spans": 3},
        "girder free on elastic bearings": {"girder": "elastic_bearings"},
    }
    cases: list[tuple[str, dict[str, Any], dict[str, Any]]] = [
        (name, options, {}) for name, options in line.items()
    ]
    cases += [
        ("train 0.3125 m further (wheels at mid-bay)", {}, {"centre_m": CENTRE_M + 0.3125}),
        ("train 4 m further", {}, {"centre_m": CENTRE_M + 3.75}),
        ("contact 1.0 GN/m", {}, {"contact": GivenContact(stiffness_N_per_m=1.0e9)}),
        ("contact 1.5 GN/m", {}, {"contact": GivenContact(stiffness_N_per_m=1.5e9)}),
    ]
    found = []
    for name, options, changes in cases:
        options = {"girder": convention.girder, **options}
        # With more spans the train stands over the middle one.
        shift = 32.0 * (options.get("spans", 1) // 2)
        standing = train().model_copy(update={"centre_m": CENTRE_M + shift, **changes})
        force, at, minimum = {}, {}, {}
        for t in TEMPERATURES_C:
            data = train_response(
                slab_track_viaduct_32m(pad=pad, **options),
                standing,
                convention.irregularity,
                FREQUENCY_HZ,
                temperature_C=t,
                conversion=convention.conversion,
            )
            curves = Curves.of(data)
            peak = extremum(FREQUENCY_HZ, curves.force, PEAK_BAND_HZ)
            force[t], at[t] = peak.value, peak.at_Hz
            minimum[t] = extremum(FREQUENCY_HZ, curves.total, MINIMUM_BAND_HZ, lowest=True).at_Hz
        found.append(Choice(name, force, at, minimum))
    return found
