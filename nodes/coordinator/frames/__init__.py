"""Frames: a tree of coordinate systems, in any of which positions are given and asked."""
