"""Accuracy of command understanding: frames, roles and resolved entities."""
