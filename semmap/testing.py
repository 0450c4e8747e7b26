"""A system for your tests, on a free port, stopped at the end: `with own_system(tmp_path) as client:`."""

from semmap.nodes.extern.testing import free_endpoint, own_system

__all__ = ["free_endpoint", "own_system"]
