"""What it means that a coordinate of the search ends at the limit of its range, and what to do about it."""

from __future__ import annotations

_WORDS: dict[tuple[str, bool], str] = {
    (
        "floor",
        False,
    ): "no modulus at rest is seen above zero; measure warmer or at lower frequencies, or use a law "
    "without a spring of its own (springpot, maxwell:N)",
    (
        "floor",
        True,
    ): "the whole table looks like the modulus at rest; use a law with fewer parameters (hysteretic)",
    ("strength", False): "this part of the law adds nothing here; use a law with fewer parameters",
    ("strength", True): "the modulus still rises at the cold end; measure colder or at higher frequencies, or use "
    "springpot_parallel, which needs no upper limit",
    (
        "time",
        False,
    ): "the relaxation is faster than anything in the table; measure colder or at higher frequencies, "
    "or use springpot_parallel, which needs no relaxation time",
    ("time", True): "the relaxation is slower than anything in the table; measure warmer or at lower frequencies",
    ("gap", False): "two relaxation times coincide; use one element fewer",
    ("gap", True): "two relaxation times lie as far apart as they may; use one element fewer",
    ("order", False): "hardly any change with frequency; measure over a wider range, or use hysteretic",
    (
        "order",
        True,
    ): "the fractional element is a dashpot; use the law with a dashpot (kelvin_voigt, zener, prony:N)",
    ("rise", False): "the second branch is that of a fractional Zener solid; use fractional_zener",
    ("rise", True): "the second branch grows like a dashpot; use springpot_parallel or havriliak_negami",
    ("loss", False): "hardly any loss; check the column of the loss",
    ("loss", True): "more loss than a constant loss factor can stand for; use kelvin_voigt or springpot",
    ("damping", False): "no loss that grows with frequency; use hysteretic",
    ("damping", True): "all of the modulus is a dashpot's; check the column of the storage modulus",
    ("coefficient", False): "the springpot adds nothing here; use hysteretic",
    ("coefficient", True): "the modulus is far above the table's at 1 rad/s; use fractional_zener",
    ("slope", False): "temperature hardly moves the curves; use --shift none, or measure over a wider range",
    ("slope", True): "a decade of frequency per kelvin, more than any rubber; check the column of the temperature",
    ("c2", False): "WLF runs into its singularity just below the coldest rows, which lie in the glass; use "
    "--shift wlf_arrhenius, or leave the coldest rows out",
    ("c2", True): "the shift is a straight line over temperature; use --shift arrhenius",
    ("c2_above", False): "WLF runs into its singularity at the transition; measure at more temperatures around it",
    ("c2_above", True): "above the transition the shift is a straight line; use --shift arrhenius",
    ("energy", False): "below the transition temperature moves nothing; measure colder, or use --shift wlf",
    ("energy", True): "a steeper shift than any rubber; check the column of the temperature",
    ("transition", False): "no row lies below the transition; use --shift wlf, or measure colder",
    ("transition", True): "no row lies above the transition; use --shift arrhenius, or measure warmer",
    ("fall", False): "two neighbouring temperatures do not differ; leave one out, or use --shift wlf",
    ("fall", True): "eight decades between neighbouring temperatures; measure at temperatures between",
}


def limit_words(kind: str, high: bool) -> str:
    """What a coordinate of a kind at its lower or upper limit means, and what to do.

    Parameters
    ----------
    kind : str
        As in :class:`permway.laws.families.Family` and :class:`permway.laws.shift_fit.ShiftFamily`.
    high : bool
        Whether it is the upper limit.
    """
    return _WORDS[kind, high]
