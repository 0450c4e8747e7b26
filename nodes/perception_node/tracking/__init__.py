"""Tracking: associates observations with things, and computes updates of the map."""
