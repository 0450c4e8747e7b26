"""Geometry on the floor plan that any node may use: convex polygons, and regions made up of them; pure."""
