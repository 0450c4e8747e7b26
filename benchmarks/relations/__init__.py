"""Spatial relations against MuJoCo's contacts, and against what a person said of the flat."""
