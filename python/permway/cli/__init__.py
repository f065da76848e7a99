"""The command line."""

from permway.cli.commands import app, main

__all__ = ["app", "main"]
