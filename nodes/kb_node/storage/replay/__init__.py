"""Replaying: a copy of a journal, also of one in use, and a map that begins anew in the middle of it."""
