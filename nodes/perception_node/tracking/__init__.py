"""Tracking: which observation is which thing, and what to tell the map."""
