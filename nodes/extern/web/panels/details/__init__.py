"""Panels that show and change the selected entities."""
