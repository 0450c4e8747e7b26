"""Standing queries: their rows, their evaluation after commits, and the publication of changes."""
