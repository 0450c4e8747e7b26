"""Compaction: a snapshot takes the place of the oldest part of the history."""
