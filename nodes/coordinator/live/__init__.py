"""Live poses of tracked entities: the newest is used, and poses at rest are committed."""
