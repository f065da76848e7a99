"""Settings of all tests; having this file here lets them import `lines`."""

from hypothesis import HealthCheck, settings

# Whole lines are slow to draw, and a machine under load slower still.
settings.register_profile("permway", deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True)
settings.load_profile("permway")
