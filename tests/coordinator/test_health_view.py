"""Who is alive."""

from nodes.coordinator import health_view
from nodes.coordinator.health_view import HealthView
from schemas.health import Health


def beat(state, pid=1):
    return Health(node="kb_node", pid=pid, started_ns=0, stamp_ns=0, state=state)


def test_a_silent_node_is_not_alive(monkeypatch):
    view = HealthView()
    assert not view.alive("kb_node")
    view.take(beat("starting"))
    assert view.alive("kb_node")
    monkeypatch.setattr(health_view, "SILENT_AFTER_S", 0.0)
    assert not view.alive("kb_node")


def test_just_after_a_start_a_node_that_was_not_heard_of_may_be_there(monkeypatch):
    assert HealthView().may_be_there("sim_node")
    monkeypatch.setattr(health_view, "_HEARD_WITHIN_S", 0.0)
    view = HealthView()
    assert not view.may_be_there("kb_node")
    view.take(beat("starting"))
    assert view.may_be_there("kb_node")
