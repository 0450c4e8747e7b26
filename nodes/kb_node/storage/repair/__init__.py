"""Repair: what of a damaged journal is sound, and a journal made of that."""
