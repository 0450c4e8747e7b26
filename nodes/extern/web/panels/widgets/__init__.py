"""Elements that several panels use."""
