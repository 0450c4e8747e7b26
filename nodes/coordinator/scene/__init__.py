"""Reconciler map and scene in agreement, and commands to the scene."""
