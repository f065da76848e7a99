"""Units as they are written in the field, under the name that readers of recordings use."""

from __future__ import annotations

from permway.units import QUANTITIES, Unit, check_same, parse_unit

__all__ = ["QUANTITIES", "Unit", "check_same", "parse_unit"]
