"""What a replay waits for before its first commit."""

from nodes.kb_node.replaying import missing
from schemas.replies import NodeStatus, SystemStatus

NODES = ("kb_node", "sim_node")


def status(*ready: str, in_agreement: bool | None = True, **what: tuple[str, ...]) -> SystemStatus:
    return SystemStatus(
        truth="replayed",
        commit=1,
        entities=1,
        bodies=1,
        in_agreement=in_agreement,
        nodes=tuple(
            NodeStatus(node=node, state="ready", pid=1, uptime_s=1.0, heartbeat_age_s=0.1) for node in ready
        ),
        **what,
    )


def test_it_waits_for_its_nodes_and_then_for_the_bodies():
    assert missing(status("kb_node"), NODES) == ("sim_node is not ready",)
    assert missing(status(*NODES, in_agreement=None), NODES) == ("the scene is not known yet",)
    pending = ("cup1 has no body yet",)
    assert missing(status(*NODES, in_agreement=False, pending=pending), NODES) == pending
    assert missing(status(*NODES), NODES) == ()


def test_a_body_that_moves_does_not_hold_it_up():
    moving = ("robot1 is moving: 1.2 m from its committed pose",)
    assert missing(status(*NODES, in_agreement=False, displaced=moving), NODES) == ()


def test_without_a_simulator_it_waits_for_no_bodies():
    assert missing(status("kb_node", in_agreement=None), ("kb_node",)) == ()
