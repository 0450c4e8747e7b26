"""Measurement of relations between shapes, and search for neighbours."""
