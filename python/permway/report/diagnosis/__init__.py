"""A diagnosis as one page: where, what, how sure, how much better, what next; with its verdict and its model."""

from permway.report.diagnosis.files import write_diagnosis
from permway.report.diagnosis.writing import PAGE, write_report

__all__ = ["PAGE", "write_diagnosis", "write_report"]
