"""Who is alive."""

import pytest

from semmap.nodes.coordinator import health_view
from semmap.nodes.coordinator.health_view import HealthView
from semmap.schemas.health import Health


def beat(state, pid=1, host="", at_s=0, node="kb_node"):
    stamp_ns = at_s * 10**9
    return Health(node=node, host=host, pid=pid, started_ns=0, stamp_ns=stamp_ns, state=state)


def test_nodes_of_one_name_on_two_hosts_are_two_rows():
    view = HealthView()
    for host in ("lab", "robot"):
        view.take(beat("starting", host=host))
        view.take(beat("ready", host=host))
    assert [(row.host, row.state) for row in view.nodes()] == [("lab", "ready"), ("robot", "ready")]


def test_the_uptime_uses_the_clock_of_the_node():
    view = HealthView()
    view.take(beat("ready", at_s=70))
    assert 70.0 <= view.nodes()[0].uptime_s < 71.0


def test_a_silent_node_is_not_alive(monkeypatch):
    view = HealthView()
    assert not view.alive("kb_node")
    view.take(beat("starting"))
    assert view.alive("kb_node")
    monkeypatch.setattr(health_view, "SILENT_AFTER_S", 0.0)
    assert not view.alive("kb_node")


def test_after_a_start_a_node_without_heartbeat_may_be_alive(monkeypatch):
    assert HealthView().may_be_alive("sim_node")
    monkeypatch.setattr(health_view, "_HEARD_WITHIN_S", 0.0)
    view = HealthView()
    assert not view.may_be_alive("kb_node")
    view.take(beat("starting"))
    assert view.may_be_alive("kb_node")


@pytest.mark.parametrize("client", ["web", "ros"])
def test_ended_clients_are_not_listed(monkeypatch, client):
    view = HealthView()
    for pid in (7, 8):
        view.take(beat("ready", pid, node=client))
    view.take(beat("ready", 9))
    assert [(row.node, row.pid) for row in view.nodes()] == [("kb_node", 9), (client, 7), (client, 8)]
    monkeypatch.setattr(health_view, "SILENT_AFTER_S", 0.0)
    (row,) = view.nodes()
    assert (row.node, row.state) == ("kb_node", "silent")
    assert row.detail.endswith("see logs/kb_node.log in its data folder")


def test_the_age_of_a_heartbeat_has_two_places_and_adds_to_the_uptime(monkeypatch):
    now_s = [50.0]
    monkeypatch.setattr(health_view.time, "monotonic", lambda: now_s[0])
    view = HealthView()
    view.take(beat("ready", at_s=70))
    now_s[0] += 1.23456
    (row,) = view.nodes()
    assert (row.heartbeat_age_s, row.uptime_s, row.state) == (1.23, 71.2, "ready")
    now_s[0] = 53.0
    (row,) = view.nodes()
    assert row.state == "silent"
    assert not view.alive("kb_node")
