"""Accuracy and speed of perception: `python -m benchmarks.perception`."""
