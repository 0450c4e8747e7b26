"""The simulator: a MuJoCo world that follows orders and physics, and what its cameras see."""
