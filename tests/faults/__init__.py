"""Faults that are done to whole systems, and what is promised of them: `make test-faults`."""
