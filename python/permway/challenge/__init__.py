"""Campaigns with an effect concealed in them, by finite elements that share nothing with the solver."""

from permway.challenge.case import TIERS, Case, Tier, draw, write, write_truth
from permway.challenge.make import make

__all__ = ["TIERS", "Case", "Tier", "draw", "make", "write", "write_truth"]
