"""Frames: a tree of coordinate systems, in which positions can be given and requested."""
