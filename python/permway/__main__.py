"""`python -m permway`: the command line."""

from permway.cli import main

main()
