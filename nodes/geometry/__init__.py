"""Geometry on the floor plan: convex polygons, and regions made of them. Pure."""
