"""What a started system waits for, by the coordinator's status."""

from __future__ import annotations

from collections.abc import Mapping

from semmap.schemas import keys
from semmap.schemas.replies import SystemStatus

NO_REPLY = "a reply of the coordinator"


def missing(status: SystemStatus, pids: Mapping[str, int], *, with_scene: bool) -> str:
    """Return what the coordinator has not received yet, or "" if it knows the whole system.

    `pids` are the process ids of the ready nodes by name. `with_scene` is whether map and scene follow each
    other.
    """
    known = {node.pid for node in status.nodes if node.state == "ready"}
    if late := sorted(node for node, pid in pids.items() if node != keys.WEB and pid not in known):
        return f"a heartbeat of {', '.join(late)} to reach the coordinator"
    if with_scene and status.in_agreement is None:
        return "the scene of the simulator to reach the coordinator"
    return ""
