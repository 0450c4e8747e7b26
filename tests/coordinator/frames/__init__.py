"""Frames: the tree, published frames, and positions in frames."""
