import pytest

from semmap.nodes import bus
from semmap.nodes.coordinator.early_commands import EarlyCommands
from semmap.schemas import errors


@pytest.fixture
def early(monkeypatch):
    monkeypatch.setattr(bus, "RESTART_S", -1.0)
    made = EarlyCommands(lambda: made.there)
    made.there = True
    return made


def test_waiting_commands_are_executed_with_the_map(early):
    done = early.wait(lambda: "done")
    early.retry(has_map=False)
    assert not done.done()
    early.retry(has_map=True)
    assert done.result(0) == "done"


def test_a_knowledge_base_at_work_is_waited_for(early):
    done = early.wait(lambda: "done")
    for _ in range(3):
        early.retry(has_map=False)
    assert not done.done()
    early.there = False
    early.retry(has_map=False)
    with pytest.raises(errors.NoAnswer, match="no response from the knowledge base"):
        done.result(0)


def test_one_that_is_restarted_is_waited_for(early, monkeypatch):
    monkeypatch.setattr(bus, "RESTART_S", 10.0)
    early.there = False
    done = early.wait(lambda: "done")
    early.retry(has_map=False)
    assert not done.done()


def test_a_failure_has_a_reason(early):
    def fail():
        raise errors.Refused("no")

    done = early.wait(fail)
    early.retry(has_map=True)
    with pytest.raises(errors.Refused):
        done.result(0)
