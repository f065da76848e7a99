"""Wrong arguments and tables: one clear error each, with its place, the value and what would be right."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.errors import InputError
from permway.laws import (
    TFDV,
    WLF,
    Free,
    Hysteretic,
    Pad,
    Prony,
    Series,
    Springpot,
    Tabulated,
    law_from_dict,
)
from permway.laws.dma import DmaTable
from permway.laws.identify import identify
from permway.laws.lawfile import load_law, save_law

SPRING = Hysteretic(stiffness=1e8, loss_factor=0.1)
WLF_20 = WLF(c1=10.0, c2_K=100.0, reference_temperature_C=20.0)
SHIFTED = TFDV(law=Springpot(coefficient=1e6, order=0.2), shift=WLF_20, reference_temperature_C=20.0)
TABLE = Tabulated(frequency_Hz=(1.0, 10.0), storage=(1.0, 2.0), loss_factor=(0.1, 0.1))
FREE = Free(temperatures_C=(-10.0, 20.0), log10_shift=(1.0, 0.0))
ZENER: dict[str, Any] = {"type": "zener", "relaxed": 1.0, "unrelaxed": 2.0, "relaxation_time_s": 0.1}
AGAINST = Hysteretic(stiffness=-1e8, loss_factor=0.1)
FVMP_WITHOUT_ETA2 = {"type": "fvmp", "mu1": 1, "eta1": 1, "mu2": 1, "eta2": 0, "alpha": 1, "beta": 1, "gamma": 1}
SWEEP = DmaTable(
    frequency_Hz=np.geomspace(1.0, 100.0, 9),
    temperature_C=np.full(9, 20.0),
    storage_Pa=np.full(9, 1e6),
    loss_Pa=np.full(9, 1e5),
)


@pytest.mark.parametrize(
    ("act", "where", "message"),
    [
        (lambda: SPRING.complex([1.0, 2.0, 0.0]), "frequency_Hz[2]", "got 0.0"),
        (lambda: SPRING.complex([1.0, -3.0]), "frequency_Hz[1]", "got -3.0"),
        (lambda: SPRING.complex(np.nan), "frequency_Hz", "got nan"),
        (lambda: SPRING.complex([[1.0, np.inf]]), "frequency_Hz[0, 1]", "got inf"),
        (lambda: SPRING.complex("fast"), "frequency_Hz", "not a number"),  # type: ignore[arg-type]
        (lambda: SHIFTED.complex(5.0), "temperature_C", "none was given"),
        (lambda: SHIFTED.complex(5.0, np.nan), "temperature_C", "finite"),
        (lambda: SHIFTED.complex(5.0, -300.0), "temperature_C", "-273.15"),
        (lambda: SHIFTED.complex(5.0, -80.0), "temperature_C", "singular temperature -80 degC"),
        (lambda: SHIFTED.complex(5.0, -95.0), "temperature_C", "Arrhenius"),
        (lambda: FREE.log10_factor(25.0), "temperature_C", "does not extrapolate"),
        (lambda: TABLE.complex(0.5), "frequency_Hz", "1 to 10 Hz"),
        (lambda: TABLE.complex([5.0, 20.0]), "frequency_Hz", "got 20.0"),
        (lambda: SPRING.check((10.0, 1.0)), "band_Hz", "lowest < highest"),
        (lambda: SHIFTED.check((1.0, 10.0)), "temperature_C", "none was given"),
        (lambda: TABLE.check((0.1, 10.0)), "frequency_Hz", "does not extrapolate"),
        (lambda: Series(first=SPRING, second=AGAINST).complex(1.0), "series", "cancel"),
        (lambda: Hysteretic(stiffness=np.nan), "hysteretic.stiffness", "finite"),
        (lambda: Hysteretic(stiffness=1.0, eta=0.1), "hysteretic.eta", "unknown name"),  # type: ignore[call-arg]
        (lambda: Pad(material=SPRING, area_m2=-1.0, thickness_m=0.01), "pad.area_m2", "greater than 0"),
        (lambda: Prony(relaxed=1.0, strengths=(1.0,), relaxation_times_s=()), "prony", "1 strengths but 0"),
        (lambda: Prony(relaxed=1.0, strengths=(1.0,), relaxation_times_s=(-1.0,)), "prony", "above zero"),
        (lambda: WLF(c1=1.0, c2_K=0.0, reference_temperature_C=0.0), "wlf", "c2_K must be above zero"),
        (lambda: Free(temperatures_C=(1.0, 0.0), log10_shift=(0.0, 1.0)), "free", "increase strictly"),
        (lambda: Free(temperatures_C=(0.0, 1e200), log10_shift=(0.0, 1.0)), "free", "at most 3000"),
        (lambda: Free(temperatures_C=(0.0, 1e-200), log10_shift=(0.0, 1.0)), "free", "0.001 K apart"),
        (lambda: Free(temperatures_C=(0.0, 1.0), log10_shift=(0.0, 1e300)), "free", "within 100 decades"),
        (
            lambda: Tabulated(frequency_Hz=(1.0, 1.0), storage=(1.0, 1.0), loss_factor=(0.0, 0.0)),
            "tabulated",
            "frequency_Hz[1]",
        ),
        (lambda: TFDV(law=SHIFTED, shift=WLF_20, reference_temperature_C=0.0), "tfdv", "shift it once only"),
        (lambda: TFDV(law=SPRING, shift=WLF_20, reference_temperature_C=-90.0), "temperature_C", "singular"),
        (lambda: law_from_dict({"type": "rubbery"}), "law", "'fractional_zener'"),
        (lambda: law_from_dict({"stiffness": 1.0}), "law", "type is missing"),
        (lambda: law_from_dict({**ZENER, "relaxed": "soft"}), "law.relaxed", "got 'soft'"),
        (lambda: law_from_dict({k: v for k, v in ZENER.items() if k != "unrelaxed"}), "law.unrelaxed", "missing"),
        (
            lambda: law_from_dict(
                {"type": "pad", "area_m2": 1.0, "thickness_m": 1.0, "material": {**ZENER, "unrelaxed": None}},
                where="pad.toml: law",
            ),
            "pad.toml: law.material.unrelaxed",
            "valid number",
        ),
        (
            lambda: law_from_dict(FVMP_WITHOUT_ETA2),
            "law",
            "eta2 must not be zero",
        ),
        (lambda: identify(SWEEP, law="plastic", shift="none"), "law", "fractional_zener"),
        (lambda: identify(SWEEP, law="prony:0", shift="none"), "law", "prony:N"),
        (lambda: identify(SWEEP, shift="vogel", reference_temperature_C=20.0), "shift", "arrhenius"),
        (lambda: identify(SWEEP, shift="wlf", reference_temperature_C=20.0), "shift", "several temperatures"),
        (lambda: identify(SWEEP, shift="wlf"), "reference_temperature_C", "needs a reference"),
        (lambda: identify(SWEEP, law="prony:9", shift="none"), "table", "19 parameters"),
        (lambda: identify(SWEEP, shift="none", vertical="up"), "vertical", "paper"),
        (lambda: identify(SWEEP, shift="none", weights=(1.0, 0.0)), "weights", "above zero"),
    ],
)  # fmt: skip
def test_wrong_arguments(act: Callable[[], object], where: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        act()
    assert where in str(caught.value)
    assert message in str(caught.value)


def test_a_sweep_over_temperature_needs_a_shift() -> None:
    both = DmaTable(
        frequency_Hz=np.full(9, 2.0),
        temperature_C=np.linspace(-60.0, 40.0, 9),
        storage_Pa=np.full(9, 1e6),
        loss_Pa=np.full(9, 1e5),
    )
    with pytest.raises(InputError, match="spans 100 K"):
        identify(both, shift="none")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[law]\ntype = ", "not TOML"),
        ('name = "x"\n', "no table named law"),
        ('format = 9\n[law]\ntype = "zener"\n', "format"),
        ('[law]\ntype = "zener"\nrelaxed = 1.0\nunrelaxed = "2"\nrelaxation_time_s = 1\n', "law.unrelaxed"),
        (
            '[law]\ntype = "zener"\nrelaxed = 1.0\nunrelaxed = 2\nrelaxation_time_s = true\n',
            "law.relaxation_time_s",
        ),
        ('[law]\ntype = "zener"\nrelaxed = 1.0\nunrelaxed = 2.0\n', "law.relaxation_time_s"),
    ],
)
def test_wrong_law_files(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "LAW.toml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_law(path)
    assert message in str(caught.value)
    assert "LAW.toml" in str(caught.value)


def test_law_files_that_cannot_be_opened(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        load_law(tmp_path / "none.toml")
    with pytest.raises(InputError, match="cannot be written"):
        save_law(tmp_path / "no" / "LAW.toml", SPRING)
