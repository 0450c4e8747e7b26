"""Spatial relations between entities, computed from poses, sizes and shapes."""
