"""Frames in files: PCD, PLY, and images of colour and depth."""
