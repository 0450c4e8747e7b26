"""Frames in files: PCD, PLY, and pictures of colour and depth."""
