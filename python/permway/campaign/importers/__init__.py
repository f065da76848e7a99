"""Folders as others hand them over, turned into campaigns."""
