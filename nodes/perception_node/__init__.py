"""Perception: from RGB-D frames to observations, and from those to commands."""
