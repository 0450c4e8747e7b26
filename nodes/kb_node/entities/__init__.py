"""Entities and their triples: reading, writing, and the class and property tables."""
