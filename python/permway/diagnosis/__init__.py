"""Where model and recordings part: likelihood, recalibration, location, names, decisions."""
