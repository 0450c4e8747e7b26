"""Shapes of entities in the map: solids, their convex parts, and outlines from above."""
