"""Conversion of the recorder's state to Rerun archetypes."""
