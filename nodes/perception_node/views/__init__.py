"""What one look shows: segments of each view, and the things that the views show together."""
