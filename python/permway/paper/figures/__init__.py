"""The paper's figures 7 to 18, one function each."""

from permway.paper.figures.decay import figure_15
from permway.paper.figures.flexibility import figure_11, figure_12, figure_13, figure_14
from permway.paper.figures.irregularity import figure_10
from permway.paper.figures.pad import figure_7, figure_8, figure_9_loss_factor, figure_9_storage
from permway.paper.figures.spectra import figure_16, figure_17, figure_18

__all__ = [
    "figure_7",
    "figure_8",
    "figure_9_loss_factor",
    "figure_9_storage",
    "figure_10",
    "figure_11",
    "figure_12",
    "figure_13",
    "figure_14",
    "figure_15",
    "figure_16",
    "figure_17",
    "figure_18",
]
