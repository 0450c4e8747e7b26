"""The ABox: individuals in columns, and their conclusions, maintained incrementally."""
