"""Predicted against measured: a page, pictures and a file of numbers."""

from permway.report.compare.writing import NUMBERS, PAGE, PICTURES, write_comparison

__all__ = ["NUMBERS", "PAGE", "PICTURES", "write_comparison"]
