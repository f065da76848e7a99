"""Readers of recordings, behind one front."""

from permway.recordings.readers.front import read_frf, read_table, read_time, time_blocks

__all__ = ["read_frf", "read_table", "read_time", "time_blocks"]
