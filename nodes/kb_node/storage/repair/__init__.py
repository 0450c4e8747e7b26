"""Repair: extracts the intact commits of a damaged journal into a new one."""
