"""Completion requests of a shell."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import BashComplete

from semmap.nodes import bus
from semmap.nodes.extern.cli import known_names, shell_completion
from semmap.nodes.extern.cli.all_commands import app
from semmap.schemas import keys
from semmap.schemas.entities import ClassInfo, Entity, Provenance
from tests.conftest import free_endpoint

SEMMAP = Path(sys.executable).parent / "semmap"
BY = Provenance(commit=1, stamp_ns=1, source="file")


def entity(name, class_):
    return Entity(
        name=name, class_=class_, iri=f"x#{name}", types=(class_,), provenance=BY, pose_provenance=BY,
        shape_provenance=BY, reference_provenance=BY,
    )  # fmt: skip


def row(name, *, spatial=True):
    return ClassInfo(
        name=name, iri=f"x#{name}", parents=(), ancestors=(), labels={}, spatial=spatial, place=False,
        fixed=False, model="",
    )  # fmt: skip


@pytest.fixture
def endpoint():
    """That of a system with two cups and a chair."""
    answers = {
        "list": (entity("cup2", "Cup"), entity("cup1", "Cup"), entity("chair1", "Chair")),
        "classes": (row("Cup"), row("Cupboard"), row("Cubic_Size", spatial=False)),
    }
    endpoint = free_endpoint()
    with bus.open_session(bus.Network(mode="peer", connect=(), listen=(endpoint,))) as session:
        bus.serve(session, keys.CMD, lambda request: request.reply(answers[request.verb]))
        yield endpoint


def completed(words, incomplete):
    """What the shell may put in place of the incomplete word."""
    shell = BashComplete(app, {}, "semmap", "_SEMMAP_COMPLETE")
    return [item.value for item in shell.get_completions(words, incomplete)]


@pytest.mark.parametrize(
    ("words", "incomplete", "said"),
    [
        (["get"], "c", ["chair1", "cup1", "cup2"]),
        (["remove", "cup1"], "cup2", ["cup2"]),
        (["move"], "ch", ["chair1"]),
        (["history"], "x", []),
        (["add"], "Cu", ["Cup", "Cupboard"]),
        (["list", "--class"], "Cupb", ["Cupboard"]),
    ],
)
def test_names_of_entities_and_classes_come_from_the_running_system(endpoint, words, incomplete, said):
    assert completed([*words[:1], "--connect", endpoint, *words[1:]], incomplete) == said


def test_commands_and_options_need_no_system(monkeypatch):
    monkeypatch.setenv("SEMMAP_CONNECT", "tcp/127.0.0.1:9")
    assert completed([], "he") == []
    assert completed([], "hi") == ["history"]
    assert completed(["list"], "--fo") == ["--format"]


def test_without_a_system_nothing_is_completed_and_nothing_said(monkeypatch, capfd):
    monkeypatch.setenv("SEMMAP_CONNECT", "tcp/127.0.0.1:9")
    patience_s, open_session = [], bus.open_session

    def noted(network):
        patience_s.append(network.patience_s)
        return open_session(network)

    monkeypatch.setattr(bus, "open_session", noted)
    assert completed(["get"], "c") == []
    assert patience_s == [0.0]
    assert capfd.readouterr() == ("", "")


def test_a_system_that_does_not_answer_is_not_waited_for_long(monkeypatch):
    monkeypatch.setattr(known_names, "_ANSWER_S", 0.2)
    endpoint, kept = free_endpoint(), []
    with bus.open_session(bus.Network(mode="peer", connect=(), listen=(endpoint,))) as session:
        queryable = session.declare_queryable(f"{keys.CMD}/*", kept.append)
        assert completed(["get", "--connect", endpoint], "c") == []
        queryable.undeclare()
    assert len(kept) == 1


@pytest.mark.parametrize("shell", shell_completion.SHELLS)
def test_the_script_of_a_shell(shell):
    said = subprocess.run([SEMMAP, "completion", shell], capture_output=True, text=True, check=True).stdout
    assert "_SEMMAP_COMPLETE" in said
    assert f"{shell}_complete" in said


def test_bash_completes(endpoint):
    script = f'PATH={SEMMAP.parent}:$PATH; eval "$(semmap completion bash)";'
    script += " COMP_WORDS=(semmap get cup); COMP_CWORD=2; _semmap_completion semmap cup get;"
    script += ' echo "${COMPREPLY[@]}"'
    environment = {**os.environ, "SEMMAP_CONNECT": endpoint}
    ended = subprocess.run(["bash", "-c", script], capture_output=True, text=True, env=environment)
    assert (ended.stdout, ended.stderr) == ("cup1 cup2\n", "")
