"""Queries: which are allowed, which commits may change their rows, and their evaluation."""
