"""What every node is built from: event loop, heartbeat, futures, and a replica of the map."""
