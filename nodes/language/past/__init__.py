"""Questions about the past: their words as elements, and what they ask. Pure."""
