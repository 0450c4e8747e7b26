"""Command understanding: semantic frames, their roles, and the entities that fill them."""
