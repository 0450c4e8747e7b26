"""A tour through every command, run for real."""
