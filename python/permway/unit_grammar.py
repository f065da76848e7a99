"""How a unit is written: factors, powers, brackets."""

from __future__ import annotations

import math
import re

from permway.unit_symbols import NONE, PREFIXES, SYMBOLS, Dimension, unknown

_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][-+]?\d+)?)|([A-Za-zε%]+)|(.))")


_POWER = re.compile(r"\s*\^\s*(?:([-+]?\d)|\(\s*([-+]?\d)\s*\))(?![\d.])|([-+]?\d)(?![\d.])")


class Grammar:
    """product = factor {("*" | "." | " " | "/") factor}; factor = ("(" product ")" | symbol) [power] | number."""

    def __init__(self, text: str, plain: str, where: str) -> None:
        self.text, self.rest, self.where = text, plain.strip(), where
        self.depth = 0

    def read(self) -> tuple[float, Dimension]:
        """Factor to SI and dimension, or an error that states what it may have been."""
        if not self.rest:
            raise unknown(self.text, self.where, "the unit is empty")
        if len(self.rest) > 80:
            raise unknown(self.text, self.where, "longer than any unit")
        found = self._product()
        if self.rest.strip():
            raise unknown(self.text, self.where)
        if not (math.isfinite(found[0]) and found[0] > 0.0):
            raise unknown(self.text, self.where, "the factor is not a number above zero")
        return found

    def _product(self) -> tuple[float, Dimension]:
        factor, dimension = self._factor()
        divided = False
        while (rest := self.rest.lstrip()) and rest[0] != ")":
            if rest[0] == "/":
                self.rest, divided, sign = rest[1:], True, -1
            elif divided:
                # "N/m s" is read either way by people, and is refused.
                raise unknown(
                    self.text, self.where, "a product after a quotient can be read two ways, set brackets"
                )
            else:
                self.rest, sign = (rest[1:] if rest[0] in "*." else rest), 1
            one, powers = self._factor()
            factor = _times(factor, one, sign)
            dimension = tuple(a + sign * b for a, b in zip(dimension, powers, strict=True))
        return factor, dimension

    def _factor(self) -> tuple[float, Dimension]:
        token = _TOKEN.match(self.rest)
        if token is None:
            raise unknown(self.text, self.where)
        self.rest = self.rest[token.end() :]
        number, symbol, mark = token.groups()
        if number is not None:
            return float(number), NONE
        if symbol is not None:
            factor, dimension = self._symbol(symbol)
        elif mark == "(" and self.depth < 8:
            self.depth += 1
            factor, dimension = self._product()
            self.depth -= 1
            if not self.rest.lstrip().startswith(")"):
                raise unknown(self.text, self.where, "a bracket is not closed")
            self.rest = self.rest.lstrip()[1:]
        else:
            raise unknown(self.text, self.where)
        power = _POWER.match(self.rest)
        if power is None:
            return factor, dimension
        self.rest = self.rest[power.end() :]
        n = int(power[1] or power[2] or power[3])
        return factor**n, tuple(n * p for p in dimension)

    def _symbol(self, symbol: str) -> tuple[float, Dimension]:
        if symbol in SYMBOLS:
            return SYMBOLS[symbol][:2]
        known = SYMBOLS.get(symbol[1:])
        if known is None or symbol[0] not in known[2]:
            raise unknown(self.text, self.where)
        return known[0] * PREFIXES[symbol[0]], known[1]


def _times(a: float, b: float, sign: int) -> float:
    if sign > 0:
        return a * b
    return a / b if b else math.inf
