"""The simulator: a MuJoCo world with cameras, controlled by the map and by hand."""
