"""How well and how fast perception sees: `python -m benchmarks.perception`."""
