"""Which options of load go together, and what its reply says."""

from __future__ import annotations

import pytest

from semmap.nodes.coordinator.commands import load as loading
from semmap.nodes.coordinator.commands.commit import commit
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import Loaded, LoadTBox
from semmap.schemas.commits import Effects, Trial

SCENE = b'{"entities": [{"class": "Chair", "name": "a"}, {"class": "Chair"}]}'
ABOX = b"<urn:a> <urn:b> <urn:c> ."
TRIAL = Trial(inserted=1, retracted=0, changed=(), gained=(), lost=())


def scene(**fields):
    return c.Load(**{"content": SCENE, "filename": "scene.json", **fields})


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"parts": True, "replace": True}, "--replace makes one commit"),
        ({"parts": True, "tbox": True}, "--tbox makes one commit"),
        ({"parts": True, "dry_run": True}, "a dry run covers one commit"),
        ({"spatial_root": "Object"}, "--spatial-root is for a TBox"),
        ({"add_only": True, "replace": True}, "give either --add-only or --replace"),
        ({"extend": True}, "--extend applies to TBoxes only"),
        ({"urdf": True}, "--urdf applies to maps in RDF or OWL only"),
        ({"tbox_from_abox": True}, "--tbox-from-abox applies to maps in RDF or OWL only"),
        ({"graph": "urn:g"}, "--graph applies to TriG, N-Quads and JSON-LD files only"),
        ({"tbox": True, "replace": True}, "apply to maps only"),
        ({"tbox": True, "add_only": True}, "apply to maps only"),
        ({"tbox": True, "skip_unknown": True}, "apply to maps only"),
        ({"tbox": True, "strict": True}, "apply to maps only"),
        ({"tbox": True, "urdf": True}, "--urdf applies to maps only"),
    ],
)
def test_options_that_do_not_go_together_are_rejected_before_anything_is_asked(fields, text):
    with pytest.raises(errors.BadRequest, match=text):
        next(loading.load(MapView(), scene(**fields)))


def test_a_file_of_an_operator_is_of_the_source_file_and_that_of_an_agent_is_not(dispatcher):
    dispatcher.change(scene())
    assert dispatcher.map.entity("a").provenance.source == "file"
    dispatcher.change(scene(content=SCENE.replace(b'"a"', b'"b"'), source="agent"))
    assert dispatcher.map.entity("b").provenance.source == "agent"


def test_only_an_operator_may_replace_what_operators_have_added(dispatcher):
    dispatcher.change(c.Add(class_="Chair", name="old"))
    with pytest.raises(errors.Refused, match="operator"):
        dispatcher.change(scene(source="agent", replace=True))
    assert set(dispatcher.map.entities) == {"old"}


def test_the_reply_counts_what_is_new_changed_and_left_out(dispatcher):
    assert dispatcher.change(scene()).text == "loaded 2 entities from scene.json"
    mixed = SCENE.replace(b'"a"', b'"a", "ref": "seat"').replace(b'{"class": "Chair"}', b'{"class": "Ghost"}')
    reply = dispatcher.change(scene(content=mixed, skip_unknown=True, filename=""))
    assert reply.text == "loaded 1 entity from the file: 1 relabelled, left out 1"
    assert reply.skipped == ("entity 2 (unknown class 'Ghost')",)
    assert reply.names == ("a",)


def test_names_are_generated_around_those_of_the_file_and_of_the_map(dispatcher):
    dispatcher.change(c.Add(class_="Chair", name="chair1"))
    items = b'{"class": "Chair"}, {"class": "Chair", "name": "chair4"}, {"class": "Chair"}'
    reply = dispatcher.change(scene(content=b'{"entities": [' + items + b"]}"))
    assert reply.names == ("chair2", "chair4", "chair3")
    replaced = dispatcher.change(scene(content=b'{"entities": [{"class": "Chair"}]}', replace=True))
    assert replaced.names == ("chair1",)


@pytest.mark.parametrize(("count", "sizes"), [(1, [1]), (2, [2]), (3, [2, 1]), (4, [2, 2]), (5, [2, 2, 1])])
def test_parts_have_a_size_an_id_and_a_reason_each(dispatcher, monkeypatch, count, sizes):
    monkeypatch.setattr(loading, "PART", 2)
    made = []

    def record(view, part):
        made.append(part)
        return commit(view, part)

    monkeypatch.setattr(loading, "commit", record)
    items = b", ".join(b'{"class": "Chair"}' for _ in range(count))
    dispatcher.change(scene(id="load", content=b'{"entities": [' + items + b"]}", parts=True))
    assert [len(part.add) for part in made] == sizes
    assert [part.id for part in made] == [*(f"load/{n}" for n in range(1, len(sizes))), "load"]
    assert made[0].reason == f"load scene.json, part 1 of {len(sizes)}"
    assert len(dispatcher.map.entities) == count


def test_if_a_part_fails_the_error_names_it_and_those_before(dispatcher, monkeypatch):
    monkeypatch.setattr(loading, "PART", 1)

    def reject(view, part):
        if part.id == "load":
            raise errors.Refused("it is inconsistent")
        return (yield from commit(view, part))

    monkeypatch.setattr(loading, "commit", reject)
    with pytest.raises(errors.Refused, match="it is inconsistent") as caught:
        dispatcher.change(scene(id="load", parts=True))
    assert "part 2 of 2" in caught.value.text
    assert set(dispatcher.map.entities) == {"a"}


def replies(command, *answers):
    """Run a load and answer its requests; return the requests and the reply."""
    running, asked = loading.load(MapView(), command), []
    try:
        asked.append(next(running))
        for answer in answers:
            asked.append(running.send(answer))
    except StopIteration as end:
        return asked, end.value
    raise AssertionError("it asks for more")


def loaded(commit=None, **fields):
    return Loaded(commit=commit, **{"skipped": (), "notes": (), **fields})


@pytest.mark.parametrize(
    ("extend", "reason", "text"),
    [
        (False, "load the TBox t.ttl", "unchanged: the TBox is already that of t.ttl"),
        (True, "extend the TBox t.ttl", "unchanged: the TBox already contains t.ttl"),
    ],
)
def test_a_tbox_that_is_there_already_is_reported(extend, reason, text):
    command = c.Load(id="1", content=ABOX, filename="t.ttl", tbox=True, extend=extend, graph="urn:g")
    asked, reply = replies(command, loaded(notes=("a note",)), (None,))
    order = asked[0]
    assert isinstance(order, LoadTBox)
    assert (order.reason, order.extend, order.graph, order.source) == (reason, extend, "urn:g", "file")
    assert (reply.commit, reply.text, reply.notes) == (None, text, ("a note",))


@pytest.mark.parametrize(
    ("extend", "text"),
    [(False, "the TBox of t.ttl replaces the present one"), (True, "the TBox extended by t.ttl")],
)
def test_a_dry_run_of_a_tbox_does_not_count_its_classes(extend, text):
    command = c.Load(id="1", content=ABOX, filename="t.ttl", tbox=True, extend=extend, dry_run=True)
    made = Effects(id="1", seq=1, tbox=True, trial=TRIAL)
    _, reply = replies(command, loaded(made))
    assert (reply.commit, reply.dry_run) == (None, True)
    assert reply.text == f"dry run, nothing changed; it would be: {text}"


@pytest.mark.parametrize(
    ("source", "what"), [("agent", "replace the TBox"), ("perception", "replace the TBox")]
)
def test_only_an_operator_may_replace_the_tbox(source, what):
    for extend, does in ((False, what), (True, "extend the TBox")):
        with pytest.raises(errors.Refused, match=f"only an operator may {does}"):
            next(loading.load(MapView(), c.Load(content=ABOX, tbox=True, extend=extend, source=source)))


@pytest.mark.parametrize(("count", "words"), [(0, "0 classes"), (1, "1 class"), (2, "2 classes")])
def test_classes_are_counted(count, words):
    assert loading._classes(count) == words
