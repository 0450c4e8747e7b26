"""Validates the facts of a map against SHACL shapes, with pySHACL."""
