"""Encoding and compression of commits and checkpoints on disk."""
