"""Relations stored as computed facts of the map, and updated with it."""
