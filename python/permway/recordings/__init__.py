"""Recordings: read, estimated, compared."""
