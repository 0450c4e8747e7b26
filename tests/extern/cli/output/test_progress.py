"""Progress messages of a large change."""

from functools import partial
from types import SimpleNamespace

import pytest

from semmap.nodes.extern.cli.output import progress as module
from semmap.schemas.health import Health

HEALTH = partial(Health, node="kb_node", pid=1, started_ns=1, stamp_ns=1, state="ready")


@pytest.fixture
def tell(monkeypatch):
    """`tell(at_s, detail)` while a change is under way."""
    clock = SimpleNamespace(now=0.0)
    followers, ended = [], []
    monkeypatch.setattr(module.time, "monotonic", lambda: clock.now)
    monkeypatch.setattr(
        module.bus,
        "follow",
        lambda session, topic, handle: (
            followers.append(handle) or SimpleNamespace(undeclare=lambda: ended.append(1))
        ),
    )

    def tell(at_s, detail):
        clock.now = at_s
        followers[-1]("", HEALTH(detail=detail))

    with module.progress(SimpleNamespace(session=None)):
        yield tell
    assert ended == [1]


def test_the_same_is_not_said_each_second(tell, capsys):
    work = "loading m.ttl: 420,000 triples to check and write"
    tell(1.0, "loading m.ttl: 100 triples read")
    tell(3.0, "78 entities, 4846 triples, commit 1")
    for at_s in range(4, 15):
        tell(float(at_s), work)
    tell(15.0, "undoing commit 3: 3 entities to check and write")
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines() == [
        f"semmap: {work} (4 s)",
        f"semmap: {work} (10 s)",
        "semmap: undoing commit 3: 3 entities to check and write (15 s)",
    ]
