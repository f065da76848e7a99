"""Responses: receptances, pseudo-excitation, decay."""
