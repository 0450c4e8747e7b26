"""Robots: an MJCF model in the world, and control of its base."""
