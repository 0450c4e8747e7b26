"""Robots: an MJCF model in the world, and how its base is driven."""
