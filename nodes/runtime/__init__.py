"""What every node is made of: its loop, its heartbeat, futures, and the map as a follower knows it."""
