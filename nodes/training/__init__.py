"""What perception learns from: simulated scenes, and the makers of what it ships. Part of no node."""
