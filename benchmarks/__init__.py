"""Measurements of semmap, each runnable as `python -m benchmarks.<name>`."""
