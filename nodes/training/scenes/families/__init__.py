"""Families of things: each time it is drawn, another bottle, cup or pear, of other proportions and curves.

A model that is only stretched keeps its profile: all its bottles have their shoulders at the same share of
their height, and all its cups the same walls. What people make, and what grows, does not.
"""
