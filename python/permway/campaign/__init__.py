"""Campaigns: records, sensors and conditions with the nominal model, and the prediction of each record."""
