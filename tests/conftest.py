"""Settings of all tests; having this file here lets them import `lines`."""

import pytest
from hypothesis import HealthCheck, settings

# Whole lines are slow to draw, and a machine under load slower still.
settings.register_profile("permway", deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True)
settings.load_profile("permway")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what tests tell beyond that they passed: what came of seeds that were drawn anew."""
    for reports in terminalreporter.stats.values():
        for report in reports:
            for name, value in getattr(report, "user_properties", ()):
                if name == "told" and report.when == "call":
                    terminalreporter.write_line(str(value))
