"""Reply types of requests, at run time and for mypy."""

from __future__ import annotations

import pytest
from mypy import api

from semmap.schemas import bridge, commands
from semmap.schemas.calls import Call, Handler, by_verb, reply_type
from semmap.schemas.commits import Commit, Effects, Transaction
from semmap.schemas.relations import Described
from semmap.schemas.scenes import Scene, SceneQuery

WIRE = """
from concurrent.futures import Future
from semmap.nodes.extern.client import Client
from semmap.schemas.commands import Get, Pause
from semmap.schemas.relations import Described
from semmap.schemas.replies import Done

def entity(query: Get) -> Described: ...
def later(query: Get) -> Future[Described]: ...
def done(query: Get) -> Done: ...

def use(client: Client) -> None:
    Get.answered_by(entity)
    Get.answered_by(later)
    Get.answered_by(done)
    Pause.answered_by(entity)
    found: Described = client.send(Get("cup1"))
    wrong: Done = client.send(Get("cup1"))
    client.add("Cup", at="there")
    client.step(0.5).text
    client.step(0.5).texts
"""


def test_each_call_says_what_it_is_answered_with():
    for kind in (*commands.COMMANDS.values(), *bridge.BRIDGE.values()):
        assert reply_type(kind) is not None
    assert reply_type(commands.Get) is Described
    assert reply_type(SceneQuery) is Scene
    assert reply_type(Transaction) == Effects | None
    assert reply_type(bridge.Recall) == tuple[Commit, ...]


def test_a_kind_of_a_call_is_answered_like_it():
    assert reply_type(type("Take", (commands.Get,), {})) is Described


@pytest.mark.parametrize("kind", [Call, commands.Command])
def test_base_classes_have_no_reply_type(kind):
    with pytest.raises(TypeError, match="has no reply type"):
        reply_type(kind)


def test_a_verb_is_a_command_s_tag_or_a_call_s_own():
    assert {verb: kind.VERB for verb, kind in commands.COMMANDS.items()} == {v: v for v in commands.COMMANDS}
    assert (Transaction.VERB, SceneQuery.VERB) == ("commit", "snapshot")


def test_handlers_are_found_by_their_verbs():
    handlers = by_verb(commands.Get.answered_by(str), SceneQuery.answered_by(repr))
    assert handlers == {"get": Handler(commands.Get, str), "snapshot": Handler(SceneQuery, repr)}


def test_mypy_checks_the_wire(tmp_path):
    (tmp_path / "wire.py").write_text(WIRE)
    said, _, status = api.run(
        [
            str(tmp_path / "wire.py"),
            "--no-error-summary",
            "--disable-error-code=empty-body",
            "--num-workers=0",
        ]
    )
    lines = WIRE.splitlines()
    found = {lines[int(line.split(":")[1]) - 1].strip() for line in said.splitlines() if ": error:" in line}
    assert status == 1
    assert found == {
        "Get.answered_by(done)",
        "Pause.answered_by(entity)",
        'wrong: Done = client.send(Get("cup1"))',
        'client.add("Cup", at="there")',
        "client.step(0.5).texts",
    }
