"""How inputs are damaged: bytes, and tables of files that are text."""

from __future__ import annotations

import copy
import datetime
import math
from collections.abc import Iterator
from typing import Any

from hypothesis import strategies as st

TOKENS = [
    *(b"-1", b"    -1\n", b"nan", b"1e999", b",", b";", b"\n", b"\x00", b"\xff\xff\xff\xff", b"\x7f\xff\xff\xff"),
    *(b"9" * 12, b"[", b"]", b"{", b'"', b"\t", b"=", b"\x00\x00\x00\x80", b"inf", b"-0", b"../", b"\xef\xbb\xbf"),
]
NUMBERS = [
    *(0, -1, 1, 2, 3, 255, 65536, 2**31 - 1, 2**31, 2**63, 10**30, -(2**63)),
    *(0.0, -0.0, 1e-300, 1e300, -1e300, 5e-324, 1e9, 1e6, 1e-9, math.nan, math.inf, -math.inf, 0.1, 100.5),
]
TEXTS = [
    *(
        "",
        "x",
        "ground",
        "rail",
        "rail[2]",
        "rail[999999999]",
        "hysteretic",
        "beam",
        "mass",
        "shaft",
        "..",
        "/",
        "a\0b",
    ),
    *(
        "../model.toml",
        "/etc/hostname",
        "model.toml",
        "frf.npz",
        "run.csv",
        "nan",
        "line.laws.pad.stiffness",
        "meetings",
    ),
    *(
        "é" * 40,
        "a" * 5000,
        "line.joints[0].at[3]",
        'campaign.sensors["rail@12"].chain.gain',
        "campaign.records",
        "[]",
    ),
]


KINDS = [*["value"] * 3, *["scale"] * 4, "drop", "double", "move", "rename", "nest"]


def values() -> st.SearchStrategy[Any]:
    """What may stand anywhere in a table, right or wrong."""
    plain = st.one_of(
        st.sampled_from(NUMBERS),
        st.sampled_from(TEXTS),
        st.booleans(),
        st.just(datetime.date(2024, 1, 1)),
        st.floats(allow_nan=False),
        st.integers(-3, 2000),
    )
    return st.one_of(
        plain,
        plain,
        st.lists(plain, max_size=4),
        st.dictionaries(
            st.sampled_from(["type", "from_m", "to_m", "spacing_m", "of", "file", "x"]), plain, max_size=3
        ),
        st.just({"from_m": 0.0, "to_m": 1e6, "spacing_m": 1.0}),
        st.just({"from": 0.0, "to": 1.0, "count": 1_000_000}),
    )


def places(table: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of everything in a table."""
    items = table.items() if isinstance(table, dict) else enumerate(table) if isinstance(table, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from places(value, (*path, key))


def at(table: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        table = table[key]
    return table


@st.composite
def damaged_table(draw: st.DrawFn, tables: list[dict[str, Any]]) -> dict[str, Any]:
    """One of some tables with one to four changes in it: values, keys, parts dropped, doubled, moved, nested."""
    table = copy.deepcopy(draw(st.sampled_from(tables)))
    for _ in range(draw(st.sampled_from([1, 1, 1, 2, 2, 3, 4]))):
        known = list(places(table))
        if not known:
            break
        path = draw(st.sampled_from(known))
        holder, key = at(table, path[:-1]), path[-1]
        kind = draw(st.sampled_from(KINDS))
        if kind == "value":
            holder[key] = draw(values())
        elif kind == "scale":
            number = holder[key]
            if isinstance(number, int | float) and not isinstance(number, bool) and abs(number) < 1e300:
                factor = draw(st.sampled_from([-1, 0, 2, 10, 1000, 10**6]) | st.floats(0.2, 5.0))
                holder[key] = type(number)(number * factor)
        elif kind == "drop":
            del holder[key]
        elif kind == "double" and isinstance(holder, list):
            for _ in range(draw(st.integers(1, 6))):
                holder.append(copy.deepcopy(holder[key]))
        elif kind == "move":
            holder[key] = copy.deepcopy(at(table, draw(st.sampled_from(known))))
        elif kind == "rename" and isinstance(holder, dict):
            holder[draw(st.sampled_from(TEXTS[:-3]))] = holder.pop(key)
        else:
            for _ in range(draw(st.sampled_from([1, 3, 60]))):
                holder[key] = [holder[key]] if draw(st.booleans()) else {"x": holder[key]}
    return table


@st.composite
def damaged_bytes(draw: st.DrawFn, content: bytes) -> bytes:
    """Content with one to four places damaged."""
    data = bytearray(content)
    for _ in range(draw(st.integers(1, 4))):
        # Heads are small and decide most.
        end = len(data) if draw(st.booleans()) else min(len(data), 512)
        where = draw(st.integers(0, max(end - 1, 0)))
        kind = draw(st.sampled_from(["flip", "flip", "set", "cut", "drop", "insert", "repeat", "zero"]))
        if kind == "flip" and data:
            data[where] ^= draw(st.integers(1, 255))
        elif kind == "set":
            token = draw(st.sampled_from(TOKENS) | st.binary(min_size=1, max_size=8))
            data[where : where + len(token)] = token
        elif kind == "cut":
            del data[where:]
        elif kind == "drop":
            del data[where : where + draw(st.integers(1, 40))]
        elif kind == "insert":
            data[where:where] = draw(st.sampled_from(TOKENS) | st.binary(min_size=1, max_size=8))
        elif kind == "repeat":
            data[where:where] = data[where : where + draw(st.integers(1, 200))] * draw(st.sampled_from([1, 2, 50]))
        else:
            stop = min(where + draw(st.integers(1, 16)), len(data))
            data[where:stop] = bytes(stop - where)
    return bytes(data)


def toml(table: dict[str, Any]) -> bytes:
    """A table as TOML on inline tables, whatever stands in it."""
    return "\n".join(f"{_key(key)} = {_value(value)}" for key, value in table.items()).encode("utf-8", "replace")


def _key(key: str) -> str:
    return _text(key)


def _text(text: str) -> str:
    inner = "".join(f"\\u{ord(c):04x}" if ord(c) < 32 or c in '"\\\x7f' else c for c in text)
    return f'"{inner}"'


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    return repr(value) if isinstance(value, int | float) else str(value)
