"""What in the paper contradicts itself or its sources, and what is done about it here."""

from __future__ import annotations

import math
from dataclasses import dataclass

from permway.model.irregularity import GermanLow, Sato
from permway.paper.conventions import PAPER, train
from permway.paper.printed import LOSS_FACTOR_PEAK, PRINTED, SPEED_M_PER_S
from permway.paper.reproduce import Reproduction, table_1_pair
from permway.paper.tables import ONE_LAW

TO_HERTZ = SPEED_M_PER_S / (2.0 * math.pi)
"""V / (2 pi) at 350 km/h: a density over wavenumber divided by this is a density per hertz."""


@dataclass(frozen=True)
class Misprint:
    """One misprint.

    Attributes
    ----------
    where : str
        Section, equation or table of the paper.
    what : str
        What is wrong, and how that shows.
    here : str
        What is done about it here.
    """

    where: str
    what: str
    here: str


def misprints(result: Reproduction) -> list[Misprint]:
    """All misprints found, those that change numbers first."""
    return [*_mechanics(), *_irregularity(), *_pad(result), *_tables(result), *_wording()]


def _mechanics() -> list[Misprint]:
    return [
        Misprint(
            "2.2, equations (10), (11)",
            "The girder is simply supported at both ends, and its bearings stand 32 m apart, at those ends. All "
            "its modes vanish there, so the bearing springs of Table 3 carry nothing.",
            "Both are computed. The right convention has a free-free girder on elastic bearings.",
        ),
        Misprint(
            "2.2, equation (14), last row",
            "The sliding layer ties the girder to the slab, Z_s. By equation (12) and the text it lies between "
            "girder and base plate, Z_d. The sentence before cites (14) itself where (12) is meant.",
            "Tied to the base plate.",
        ),
        Misprint(
            "2.2 and Table 3",
            f"32 m hold {32 / 0.625:g} fastener spacings of 0.625 m. The numbers of mortar and sliding springs "
            "are not given.",
            "51 of each; what other choices do is in the table of choices.",
        ),
        Misprint(
            "Table 3",
            "Its rows are displaced: the slab's modulus stands beside the fastener, the mortar's stiffness "
            "beside the slab, and so on.",
            "Read in the order rail, fastener, slab, mortar, base plate, sliding layer, viaduct, bearing.",
        ),
        Misprint(
            "4.2.1, Figure 11",
            "The wheel's flexibility is stated to be largest at 1 Hz because a natural frequency of the secondary "
            f"suspension lies there. The body's bounce lies at "
            f"{train().vehicle.natural_frequencies_Hz()[4]:.2f} Hz by Table 2, and the flexibility of a free "
            "vehicle grows without limit towards 0 Hz: 1 Hz is merely the lowest frequency drawn.",
            "Nothing to change.",
        ),
    ]


def _irregularity() -> list[Misprint]:
    low = 2.0 * math.pi / SPEED_M_PER_S
    more = float(
        GermanLow(form="paper_eq28").wavenumber_density([low])[0] / GermanLow().wavenumber_density([low])[0]
    )
    metre = 2.0 * math.pi
    jump = float(
        Sato().wavenumber_density([metre * (1.0 + 1e-6)])[0]
        / GermanLow(form="paper_eq28").wavenumber_density([metre])[0]
    )
    return [
        Misprint(
            "4.1, equation (28)",
            "w_s where the German spectrum has w_c. The tables were computed with it: at 1 Hz the density is "
            f"{more:.2f} times the right one.",
            "Both are computed.",
        ),
        Misprint(
            "2.4 and all spectra",
            "The density over wavenumber, m²/(rad/m), is used as one over frequency. A true density per hertz is "
            f"smaller by V/(2π) = {TO_HERTZ:.2f} at 350 km/h, an amplitude by {math.sqrt(TO_HERTZ):.2f}.",
            "Both are computed; the right convention has true densities per hertz.",
        ),
        Misprint(
            "Table 5 and Figure 16",
            "The force is called N. It is the root of a density: N/√(rad/m) as computed, N/√Hz if converted.",
            "Axis and button say which.",
        ),
        Misprint(
            "4.1, equation (29)",
            "A/ω^(−n) would grow with wavenumber, m²/rad is not its unit, and A = 0.065 has none. With A in mm² "
            f"and a negative power, Sato's spectrum starts {jump:.2f} times above the German one at 1 m; with A "
            "in m² it would start 10⁶ times above. That step, at 97.2 Hz, makes the peak of Table 8 at 98 Hz.",
            "A = 6.5e-8 m², S = A/ω^n.",
        ),
        Misprint(
            "Table 6",
            "Pitch acceleration is given in (m/s²)²/Hz; it is an angular acceleration, (rad/s²)²/Hz. Its text "
            "states 0.0081 and 0.0079 where the table has 0.00081 and 0.00079; the table's values come out.",
            "The table is followed.",
        ),
    ]


def _pad(result: Reproduction) -> list[Misprint]:
    check = result.table_1
    printed = table_1_pair()
    eta = float(printed.loss_factor(55.0)[()])
    needed = {t: pad.eta for t, pad in result.free[PAPER.name].items()}
    faults = "; ".join([*check.reasons, *check.caveats])
    return [
        Misprint(
            "Table 1",
            f"Storage and loss are fitted separately with different parameters, so the pair is no material: "
            f"{faults}. Nor does it belong to the tables: its loss factor at 20 °C and 55 Hz is {eta:.2f}, "
            f"tables 5 and 7 ask for {needed[20]:.2f}.",
            "One complex law with orders between 0 and 1, passive and causal at all frequencies.",
        ),
        Misprint(
            "3.1, equations (21), (22)",
            "The shift factor is printed nowhere, and of Table 4 only the title is there. Nor are area and "
            "thickness of the pad, which equation (1) needs.",
            "Law and shift are identified from tables 5 and 7 and the minima of figures 11 to 13.",
        ),
        Misprint(
            "3.5.1 against tables 5 and 7",
            f"The DMA test finds no loss factor above {LOSS_FACTOR_PEAK}. A shift over frequency and temperature "
            f"leaves its largest value as it is, yet the tables at −30 °C ask for {needed[-30]:.2f} near 85 Hz.",
            "The tables are followed; Figure 7 shows the difference.",
        ),
        Misprint(
            "3.5.3",
            "The test data shown are stated to cover (−30, −20) °C; the results are for 20, −20 and −30 °C.",
            "Figure 9 covers −30 to 20 °C.",
        ),
    ]


def _tables(result: Reproduction) -> list[Misprint]:
    rows = {(r.quantity, r.temperature_C): r for r in PRINTED}
    runs = result.runs[PAPER.name, ONE_LAW]
    asked = {}
    for t in (20, -20, -30):
        row = rows["force", t]
        asked[t] = math.sqrt(float(runs[t]["irregularity_psd"].sel(frequency=row.at_Hz))) / row.value
    over = "; ".join(
        f"{b.printed:g} printed, {b.bound:.0f} at most, at {b.temperature_C:g} °C".replace("-", "−")
        for b in result.bounds
    )
    return [
        Misprint(
            "Table 8 against Tables 5 and 7",
            "The contact condition (19) bounds the rail's acceleration by those of wheel, irregularity and "
            f"contact spring. Table 8 exceeds that bound ((m/s²)²/Hz: {over}), whatever track and pad.",
            "Left open; see Table 8.",
        ),
        Misprint(
            "Conclusion 2 and 4.2.1 against Table 5",
            "The minimum of the total flexibility is stated to get smaller in the cold. The printed forces ask "
            "for "
            + ", ".join(f"{v * 1e9:.2f} nm/N at {t} °C".replace("-", "−") for t, v in asked.items())
            + " where they peak (irregularity over force, one wheel alone): larger in the cold, for the loss "
            "factor fills the minimum.",
            "The computed minima are larger in the cold as well.",
        ),
    ]


def _wording() -> list[Misprint]:
    return [
        Misprint(
            "4.2.2 (1)",
            "“The stiffness of the rubber pad under the track decreases with the decrease of temperature.” It "
            "increases, as 3.5.3 and 4.2.1 say and as the frequencies of tables 5, 7 and 8 need.",
            "It increases.",
        ),
        Misprint(
            "4.2.2 (3), last paragraph",
            "“In the higher frequency band, the higher the temperature is, the greater the power spectrum "
            "amplitude.” The paragraphs before it and conclusion 4 say the opposite.",
            "Conclusion 4 is judged.",
        ),
        Misprint(
            "4.2.1, Figure 14",
            "The curves are stated to coincide below 25 Hz because the pad's viscoelasticity “affects the wheel "
            "movement”. It must mean that it does not, as 4.2.2 and conclusion 3 say.",
            "Read so.",
        ),
        Misprint(
            "Conclusion 1",
            "Storage modulus and loss factor are stated to “decrease with temperature and increase frequency”; "
            "the abstract states that they increase as temperature falls and frequency rises.",
            "The abstract is judged.",
        ),
    ]
