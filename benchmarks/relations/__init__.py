"""Spatial relations: against MuJoCo's contacts, against what a person said of the flat, and how quick they are."""
