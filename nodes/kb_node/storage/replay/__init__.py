"""Replay: a copy of a journal, possibly one in use, and a map that starts in the middle of it."""
