"""Answers to questions about the map: what follows and why, what could be, snapshots, and dry runs."""
