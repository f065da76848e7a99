"""Spectral estimates with their uncertainty: arrays in, arrays or labelled datasets out."""
