"""Backups: reading a journal in parts while commits continue, and restoring a data folder."""
