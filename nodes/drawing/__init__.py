"""Rendering of map and scene for the page and for recordings, independent of a renderer."""
