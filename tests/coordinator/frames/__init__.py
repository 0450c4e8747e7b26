"""Frames: the tree, what is published, and positions in one."""
