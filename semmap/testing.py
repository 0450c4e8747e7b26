"""A system for your tests, on a free port, stopped at the end: `with own_system(tmp_path) as client:`."""

from semmap.nodes.extern.testing import own_system
from semmap.nodes.supervisor.ports import free_endpoint

__all__ = ["free_endpoint", "own_system"]
