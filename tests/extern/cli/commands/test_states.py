"""States from the command line and from a client, over a real system."""

from __future__ import annotations

import json

import pytest

from semmap.schemas import codec, commands, errors, replies


@pytest.fixture(scope="module")
def system(flat_map):
    """The shipped flat without a simulator; `door1` is closed."""
    return flat_map


def test_a_state_is_set_read_conditioned_and_taken_back(system):
    assert "door1: isOpen: false → true (commit " in system.cli("set", "door1", "is open", "yes")
    assert "isOpen (is open)" in system.cli("get", "door1")
    assert "isOpen is true, not false" in system.cli(
        "set", "door1", "isOpen", "true", "--if-is", "no", status=1
    )
    system.cli("set", "door1", "hasColor", "red", "blue")
    said = json.loads(system.cli("get", "door1", "--format", "json"))["properties"]
    assert said == {"connects": ["corridor1"], "hasColor": ["color_blue", "color_red"], "isOpen": True}
    assert "color_red (red)" in system.cli("get", "door1")
    assert "door1: hasColor: - color_red" in system.cli("unset", "door1", "hasColor", "color_red")
    system.cli("undo")
    assert "did you mean isOpen" in system.cli("set", "door1", "isOpne", "true", status=2)
    assert "--at X Y Z" in system.cli("set", "door1", "hasPosition", "x", status=2)
    assert "isOpen takes true or false" in system.cli("set", "door1", "isOpen", "ajar", status=2)
    assert "no individual is named 'table99'" in system.cli("set", "door1", "isOn", "table99", status=1)
    assert "isOpen: false → true" in system.cli("history", "door1")
    assert "isSwitchedOn" in system.cli("properties")
    assert "no SWRL rules" in system.cli("rules")


def test_a_client_sets_states(system):
    with system.client() as client:
        client.set("door1", "mass", 2)
        client.update("door1", set=("isOpen=false",), unset=("mass",))
        assert client.get("door1").properties["isOpen"] is False
        with pytest.raises(errors.PreconditionFailed):
            client.set("door1", "isOpen", True, if_is=True)
        assert client.set("door1", "isOpen", True, if_is=False).commit is not None
        client.set("door1", "isOpen", False)
        (last,) = client.history("door1", limit=1)
        (change,) = last.changes
        assert (change.kind, change.property_, change.was, change.now) == ("property", "isOpen", True, False)
        assert "isOpen" in {row.name for row in client.properties()}


def test_a_selector_and_a_json_message_set_states(system):
    with system.client() as client:
        client.set("door1", "isOpen", False)
        parameters = "name=door1;property=isOpen;values=true"
        (reply,) = client.session.get(f"semmap/cmd/set?{parameters}")
        assert codec.decode(reply.ok.payload.to_bytes(), replies.Changed).commit is not None
        message = b'{"name": "door1", "property": "isOpen", "values": [false], "if_is": true}'
        (reply,) = client.session.get("semmap/cmd/set", payload=message)
        assert "true → false" in json.loads(reply.ok.payload.to_bytes())["text"]


@pytest.mark.parametrize(
    "words",
    [
        ("add", "Cup", "cup99", "--set", "isOpen=no"),
        ("update", "door1", "--ref", "gate"),
        ("set", "door1", "hasMainColor", "red"),
        ("remove", "door1"),
        ("clear",),
        ("undo",),
    ],
    ids=lambda words: words[0],
)
def test_a_dry_run_does_nothing(system, words):
    with system.client() as client:
        client.add("Cup", at=(1, 1, 1))  # something to undo
        before = client.status().commit, client.list()
        assert "dry run, nothing changed; it would be: " in system.cli(*words, "--dry-run")
        assert (client.status().commit, client.list()) == before


def test_a_dry_run_of_a_load_and_of_what_is_refused(system, tmp_path):
    scene = tmp_path / "scene.json"
    scene.write_text('{"entities": [{"class": "Cup", "name": "cup98", "at": [1, 1, 1]}]}')
    assert "loaded 1 entity" in system.cli("load", scene, "--dry-run")
    turtle = tmp_path / "cup.ttl"
    turtle.write_text(
        "@prefix : <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_1#> .\n"
        "@prefix dm: <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#> .\n"
        ":cup97 a dm:Cup ."
    )
    said = system.cli("load", turtle, "--dry-run")
    assert "would be inferred: cup97 type Object" in said
    assert "cannot" in system.cli("set", "door1", "isOn", "door1", "--dry-run", status=1)
    with system.client() as client:
        assert not {"cup97", "cup98"} & {e.name for e in client.list()}
        tried = client.send(commands.Set("door1", "hasMainColor", ("green",), dry_run=True))
        assert (tried.dry_run, tried.commit, tried.follows) == (True, None, ("door1 hasColor color_green",))


def test_a_class_of_another_nature_needs_force(system):
    system.cli("add", "Fridge", "fridge9", "--at", "1", "1", "0")
    assert "add --force" in system.cli("update", "fridge9", "--class", "Kitchen", status=1)
    assert "class Fridge → Kitchen" in system.cli("update", "fridge9", "--class", "Kitchen", "--force")
    assert "outside every place" in system.cli("add", "Cup", "--at", "500", "0", "0")
