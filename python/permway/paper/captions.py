"""What stands under each figure: the paper's caption in short, and how it is drawn here."""

CAPTIONS: dict[int, tuple[str, str]] = {
    7: (
        "DMA test of the pad at 2 Hz, −60 to 40 °C",
        "The paper's measured points are not printed. Drawn is the law identified from its tables, dotted where "
        "it is extrapolated (below −30 and above 20 °C), beside the three printed facts of the test: the loss "
        "factor peaks at −45.7 °C with 0.55, the loss modulus at −50.7 °C.",
    ),
    8: (
        "Modulus and loss factor over frequency at 20 °C",
        "Table 1's curves beside the identified law. Area and thickness of the pad are not printed, so the law is "
        "scaled by one factor, by which the two storage curves meet at 55 Hz. Table 1's loss factor passes 1 at "
        "1.7 kHz.",
    ),
    9: (
        "Storage stiffness and loss factor over temperature and frequency",
        "The identified law, −30 to 20 °C, 1 to 200 Hz. The paper draws moduli in MPa.",
    ),
    10: (
        "Irregularity spectrum",
        "One-sided densities over wavenumber: German low disturbance for wavelengths of 1 to 100 m, Sato below "
        "1 m. The grey band is what the paper's tables were computed with.",
    ),
    11: (
        "Dynamic flexibility at 20 °C: amplitude and phase",
        "At the first wheel. Dotted: the printed frequency of the minimum of the total.",
    ),
    12: (
        "Dynamic flexibility at −20 °C: amplitude and phase",
        "At the first wheel. Dotted: the printed frequency of the minimum of the total.",
    ),
    13: (
        "Dynamic flexibility at −30 °C: amplitude and phase",
        "At the first wheel. Dotted: the printed frequency of the minimum of the total.",
    ),
    14: (
        "Total dynamic flexibility at the three temperatures",
        "Dotted: the printed frequencies of the minima, 59, 75 and 93 Hz.",
    ),
    15: (
        "Decay rate of the track",
        "Between contact points 1 and 3, 17.5 m apart. Shaded: the bands of the two statements.",
    ),
    16: ("Amplitude of the wheel-rail force", "At the first wheel; diamonds: Table 5."),
    17: (
        "Car body: bounce and pitch acceleration",
        "Diamonds: Table 6; those of the three temperatures lie on each other.",
    ),
    18: (
        "Wheelset and rail acceleration",
        "At the first wheel; diamonds: Table 7 above, Table 8 below, which lies above every curve (see Table 8).",
    ),
}
"""Figure's number to caption and note."""
