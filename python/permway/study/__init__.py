"""Sweeps over models: a study file in, one file per case out, one dataset over all of them."""

from __future__ import annotations

from permway.study.collect import open_study
from permway.study.file import Study, read_study, study_from_dict
from permway.study.run import Summary, run_study

__all__ = ["Study", "Summary", "open_study", "read_study", "run_study", "study_from_dict"]
