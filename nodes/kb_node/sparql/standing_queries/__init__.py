"""Queries that are watched: their rows, the looks that commits make necessary, and the news on the wire."""
