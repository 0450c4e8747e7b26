"""The simulator: a MuJoCo world with cameras, controlled by the coordinator or interactively."""
