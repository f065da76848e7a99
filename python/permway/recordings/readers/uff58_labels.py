"""Names of channels and pairs in a universal file, each its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from permway.recordings.readers.uff58_function import End, Function

_TYPES = {
    0: "general", 1: "time response", 2: "auto spectrum", 3: "cross spectrum", 4: "frequency response",
    5: "transmissibility", 6: "coherence", 7: "auto correlation", 8: "cross correlation",
    9: "power spectral density", 10: "energy spectral density", 12: "spectrum",
}  # fmt: skip
_QUANTITIES = {
    1: "general", 2: "stress", 3: "strain", 5: "temperature", 6: "heat flux", 8: "displacement",
    9: "reaction force", 11: "velocity", 12: "acceleration", 13: "force", 15: "pressure", 16: "mass", 17: "time",
    18: "frequency", 19: "rpm", 20: "order",
}  # fmt: skip

# What states two channels of one node and direction apart, the plainest first.
_NAMINGS: tuple[Callable[[Function], str], ...] = (
    lambda item: item.response.entity,
    lambda item: _QUANTITIES.get(item.ordinate.kind, ""),
    *(lambda item, line=line: item.ids[line] for line in range(5)),
    lambda item: str(item.number),
)


def type_name(kind: int) -> str:
    """What a function of a type is."""
    return _TYPES.get(kind, "other")


def channel_labels(items: Sequence[Function]) -> tuple[str, ...]:
    """A label for each channel: node and direction, or its name; with what distinguishes it where several tie."""
    labels = [_channel(item) for item in items]
    for label in dict.fromkeys(labels):
        tied = [i for i, other in enumerate(labels) if other == label]
        if len(tied) == 1:
            continue
        for name in _NAMINGS:
            found = [name(items[i]) for i in tied]
            if len(set(found)) == len(tied) and all(found):
                for i, text in zip(tied, found, strict=True):
                    # Where there is no node, the name alone is the label.
                    labels[i] = text if items[i].response.degree is None else f"{label} ({text})"
                break
    return tuple(labels)


def _channel(item: Function) -> str:
    if item.response.degree is not None or item.response.named:
        return item.response.label
    line = item.ids[0]
    return line if line.upper() not in ("", "NONE") else item.response.label


Pair = tuple[str, str]
Naming = Callable[[Function], Pair]
"""What a function is called: its response and its reference."""


def plain_pair(item: Function) -> Pair:
    """Response and reference by node and direction, or by their names."""
    return item.response.label, item.reference.label


def _by_line(line: int) -> Naming:
    def name(item: Function) -> Pair:
        text = item.ids[line]
        response, reference = plain_pair(item)
        return (response if text.upper() in ("", "NONE") else f"{response} ({text})"), reference

    return name


# What distinguishes functions of one pair: entities' names, an identification line, number or version.
_PAIR_NAMINGS: tuple[Naming, ...] = (
    lambda item: (_named(item.response), _named(item.reference)),
    *(_by_line(line) for line in range(5)),
    lambda item: (f"{item.response.label} ({item.number})", item.reference.label),
    lambda item: (f"{item.response.label} (version {item.version})", item.reference.label),
)


def pair_namings(items: Sequence[Function]) -> dict[Pair, Naming]:
    """For each pair that several functions are of, what distinguishes these; it is missing where nothing does."""
    groups: dict[Pair, list[Function]] = {}
    for item in items:
        groups.setdefault(plain_pair(item), []).append(item)
    found: dict[Pair, Naming] = {}
    for pair, tied in groups.items():
        name = next((name for name in _PAIR_NAMINGS if len({name(item) for item in tied}) == len(tied)), None)
        if len(tied) > 1 and name is not None:
            found[pair] = name
    return found


def pair_labels(items: Sequence[Function], states: Mapping[Pair, Naming]) -> list[Pair]:
    """Labels of response and reference of each function."""
    return [states.get(plain_pair(item), plain_pair)(item) for item in items]


def _named(end: End) -> str:
    return f"{end.label} ({end.entity})" if end.degree is not None and end.named else end.label
