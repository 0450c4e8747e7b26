"""Placement: obstacles, clearance, and how bodies are added, removed and settled."""
