"""Entities and their stars: read from triples, changed in triples, and the table of their classes."""
