"""The coordinator's view of the simulated scene, and the commands to it."""
