"""A whole diagnosis of a campaign that comes with the package."""

from permway.demo.run import run

__all__ = ["run"]
