"""Runs supervisord until `semmap up` ends: `python -m semmap.nodes.supervisor.daemon -n -c CONF`."""

from __future__ import annotations

from supervisor.supervisord import main

from semmap.nodes.supervisor.orphans import end_when_orphaned

if __name__ == "__main__":
    end_when_orphaned()
    main()
