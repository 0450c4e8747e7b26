"""A tour through all commands on running systems."""
