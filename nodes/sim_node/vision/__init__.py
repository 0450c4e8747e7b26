"""Cameras in the simulated world."""
