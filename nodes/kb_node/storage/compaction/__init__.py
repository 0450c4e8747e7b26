"""Compaction: replaces the oldest part of the history by a snapshot."""
