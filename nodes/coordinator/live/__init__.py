"""Live poses of tracked entities: the newest wins, and only where they stop is there a commit."""
