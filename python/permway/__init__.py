"""permway: how a train, its track and the viaduct below vibrate, frequency by frequency."""

from permway._core import __version__

__all__ = ["__version__"]
