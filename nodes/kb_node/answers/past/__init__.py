"""Answers about the past of the map, from the journal."""
