"""Backups: a journal read out in parts while commits go on, and a data folder made from one."""
