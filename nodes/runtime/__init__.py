"""Common parts of all nodes: event loop, heartbeat, futures, and a replica of the map."""
