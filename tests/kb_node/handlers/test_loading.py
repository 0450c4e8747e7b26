"""Loading of documents, without the wire."""

from contextlib import nullcontext

import pytest
from msgspec import structs

from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.documents import parser_process, rdf
from semmap.nodes.kb_node.handlers import loading as handlers_loading
from semmap.nodes.kb_node.handlers.changes import ChangeHandlers
from semmap.nodes.kb_node.handlers.loading import LoadHandlers
from semmap.nodes.kb_node.reasoner.rules import closure
from semmap.nodes.kb_node.shacl.enforcement import ShapeEnforcement
from semmap.nodes.kb_node.undo import undo
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import LoadDocument, Loaded, TakeBack
from semmap.schemas.commands import Get
from semmap.schemas.entities import Pose
from tests.kb_node import home


class NoSparql:
    def prefetch(self, *document, packed):
        """Do nothing."""

    def discard_prepared(self):
        """Do nothing."""


def loading(semantic_map, said):
    def report_progress(work):
        return nullcontext(lambda text: said.append(f"{work}: {text}"))

    changing = ChangeHandlers(
        semantic_map,
        semantic_map._journal,
        publish=lambda commit, **how: None,
        on_write_error=said.append,
        report_progress=report_progress,
    )
    return LoadHandlers(
        semantic_map,
        semantic_map._journal,
        changing,
        NoSparql(),
        report_progress=report_progress,
        notes=lambda: (),
        run_soon=lambda function: function(),
    )


def test_a_load_counts_described_entities_and_not_those_with_changed_inferences(flat):
    said = []
    star = entity_triples.describe("apple9", v.dm("Apple"), pose=Pose(position_m=(9.81, 0.34, 0.1)))
    document = LoadDocument(
        id="1",
        source="file",
        content=rdf.serialise(star, "ntriples"),
        filename="apple.nt",
        replace=False,
        skip_unknown=False,
    )
    loaded = loading(flat, said).on_load(document)
    assert {entity.name for entity in loaded.commit.changed} == {
        "apple9",
        "bin1",
    }  # it is a Filled_Thing now
    assert loaded.names == ("apple9",)
    assert said[-1] == f"loading apple.nt: {len(star)} triples to check and write"


def test_a_urdf_file_is_parsed_outside_the_node(flat, monkeypatch):
    loads, requests = loading(flat, []), []
    monkeypatch.setattr(
        loads._reader.parser,
        "exchange",
        lambda request, _: requests.append(request) or parser_process.answer(request),
    )
    box = '<visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>'
    load = LoadDocument(
        id="1",
        source="file",
        content=f"<{v.ABOX}apple9> a {v.dm('Apple')} .".encode(),
        filename="apple.ttl",
        replace=False,
        skip_unknown=False,
        urdf=f'<robot><link name="apple9">{box}</link></robot>'.encode(),
    )
    loaded = loads.on_load(load).result(60)
    apple = flat.entity("apple9")
    assert (apple.pose, apple.size_m) == (Pose(position_m=(0.0, 0.0, -0.15)), (0.1, 0.2, 0.3))
    assert loaded.notes[0] == "1 pose from the URDF file: apple9"
    with pytest.raises(errors.BadFile, match="the URDF file is not valid URDF: "):
        loads.on_load(structs.replace(load, id="2", urdf=b"<robot")).result(60)
    loads.close()
    assert len(requests) == 2


SOME = "<http://o#A{}> rdfs:subClassOf [ a owl:Restriction ; owl:onProperty <http://o#p> ; {} ] ."
HEAD = f"@prefix owl: <{v.OWL}> . @prefix rdfs: <{v.RDFS}> .\n"


def restrictions(count):
    """Return a load of restrictions of one property: every pair is compared."""
    axioms = "\n".join(SOME.format(n, f"owl:someValuesFrom <http://o#A{n + 1}>") for n in range(count))
    return LoadDocument(
        id=str(count),
        source="file",
        content=(HEAD + axioms).encode(),
        filename="f.ttl",
        replace=False,
        skip_unknown=False,
    )


@pytest.mark.process
def test_very_many_axioms_are_closed_in_another_process(flat, monkeypatch):
    monkeypatch.setattr(closure.Closure, "insert", None)  # in this process
    loads = loading(flat, [])
    for dry_run in (True, False):
        loaded = loads.on_load(structs.replace(restrictions(260), dry_run=dry_run)).result(60)
        assert flat.seq == (1 if dry_run else 2)
    loads.close()
    assert loaded.commit.seq == 2
    assert len(flat.reasoner.axioms.difference(flat.tbox)) == 4 * 260


@pytest.mark.parametrize("replace", [False, True])
def test_the_axioms_that_are_tried_are_those_that_are_committed(flat, monkeypatch, replace):
    """Skipping an individual removes the axioms about it."""
    monkeypatch.setattr(handlers_loading, "_MANY_AXIOMS", 10)
    load = restrictions(5)
    skipped = "\n<http://o#x> a <http://o#Unknown> .\n" + SOME.format(0, "owl:hasValue <http://o#x>")
    content = load.content + skipped.encode()
    loads, tried = loading(flat, []), []
    monkeypatch.setattr(loads._reader.parser, "close_tbox", lambda known, *_, **__: tried.append(known))
    loaded = loads.on_load(structs.replace(load, content=content, skip_unknown=True, replace=replace)).result(
        60
    )
    loads.close()
    assert loaded.skipped == ("x (unknown class 'Unknown')",)
    assert not any("<http://o#x>" in triple for triple in flat.reasoner.axioms)
    assert tried == [flat.reasoner.axioms | flat.tbox]


CUPS = f"""@prefix dm: <{v.TBOX}> . @prefix owl: <{v.OWL}> .
<https://ex.org/cups/9499a8c6-2e95> a dm:Cup .
<http://ex.org/m#cup_z> a dm:Cup .
""".encode()


@pytest.mark.parametrize("dry_run", [True, False])
def test_names_that_are_made_from_iris_are_noted_once(flat, dry_run):
    def load(number):
        fields = {"replace": False, "skip_unknown": False, "dry_run": dry_run}
        return LoadDocument(id=number, source="file", content=CUPS, filename="cups.ttl", **fields)

    handlers = loading(flat, [])
    loaded = handlers.on_load(load("1"))
    assert set(loaded.names) == {"cup_z", "_9499a8c6-2e95"}
    assert loaded.notes == (
        "1 name made from IRIs, which stay as they are: _9499a8c6-2e95 (<https://ex.org/cups/9499a8c6-2e95>)",
    )
    assert bool(handlers.on_load(load("2")).notes) == dry_run


def test_the_axioms_of_the_map_are_not_collected_for_a_load_without_many(flat, monkeypatch):
    """There may be a million."""
    monkeypatch.setattr(type(flat.reasoner), "axioms", None)
    load = structs.replace(restrictions(0), content=CUPS)
    assert len(loading(flat, []).on_load(load).names) == 2


@pytest.mark.process
def test_axioms_that_take_long_are_rejected_with_a_map(flat, monkeypatch):
    monkeypatch.setattr(handlers_loading, "_AXIOMS_S", 1.0)
    loads = loading(flat, [])
    with pytest.raises(errors.BadFile, match=r"f\.ttl: its 8,000 axioms take too long .* --tbox --extend"):
        loads.on_load(restrictions(2000)).result(60)
    loads.close()
    assert flat.seq == 1


def test_notes_on_other_graphs_are_part_of_the_reply(flat):
    load = LoadDocument(
        id="1",
        source="file",
        content=f"@prefix dm: <{v.TBOX}> . <urn:m#a> a dm:Cup . <urn:m#g> {{ <urn:m#b> a dm:Cup }}".encode(),
        filename="f.trig",
        replace=False,
        skip_unknown=False,
    )
    handlers = loading(flat, [])
    document = rdf.read(load.content, load.filename)
    loaded = handlers._load(load, lambda _: document)
    assert loaded.names == ("a",)
    assert loaded.notes[0].startswith("left out: 1 statement in other graphs (g: 1)")


OWN = f"""
@prefix : <{v.ABOX}> . @prefix dm: <{v.TBOX}> . @prefix owl: <{v.OWL}> . @prefix rdfs: <{v.RDFS}> .
:Mug a owl:Class ; rdfs:subClassOf dm:Object . :holds a owl:ObjectProperty .
:mug1 a :Mug ; :holds :tea ; dm:hasPosition :at . :tea a :Drink . :Drink a owl:Class .
:at a dm:Coordinates ; dm:float_coordinates_x 1.0 ; dm:float_coordinates_y 2.0 ; dm:float_coordinates_z {{}} .
"""


def with_declarations(number, z="0.5", **fields):
    fields = {"replace": False, "skip_unknown": False, "tbox_from_abox": True, **fields}
    content = OWN.format(z).encode()
    return LoadDocument(id=str(number), source="file", content=content, filename="own.ttl", **fields)


def load_now(semantic_map, load):
    handlers = loading(semantic_map, [])
    handlers._reader.parser.close_tbox = lambda tbox, filename, **_: None  # computed without a process
    loaded = handlers.on_load(load)
    try:
        return loaded if isinstance(loaded, Loaded) else loaded.result(60)
    finally:
        handlers.close()


def test_declarations_of_a_map_become_part_of_the_tbox_in_the_same_commit(semantic_map):
    tried = load_now(semantic_map, with_declarations(1, dry_run=True))
    assert (tried.names, tried.commit.trial is None, semantic_map.seq) == (("mug1",), False, 0)
    loaded = load_now(semantic_map, with_declarations(2))
    assert (loaded.commit.seq, loaded.commit.tbox, loaded.names) == (1, True, ("mug1",))
    assert loaded.counts == {"new": 1}
    assert loaded.notes[0] == "added to the TBox: 2 classes and 1 property of the file"
    assert semantic_map.entity("mug1").pose.position_m == (1.0, 2.0, 0.5)
    assert {"Mug", "Drink"} <= set(semantic_map.classes.names.values())
    assert not any(s.endswith(("Mug>", "holds>")) for s, _, _ in semantic_map.abox())
    before, after = home.state(semantic_map), semantic_map.tbox
    semantic_map = home.reopened(semantic_map)
    assert (home.state(semantic_map), semantic_map.tbox) == (before, after)
    semantic_map._journal.close()


def test_loading_it_again_changes_the_facts_only_and_an_undo_takes_back_all(semantic_map):
    load_now(semantic_map, with_declarations(1))
    tbox = semantic_map.tbox
    again = load_now(semantic_map, with_declarations(2, z="0.7"))
    assert (again.commit.tbox, again.counts, semantic_map.tbox) == (False, {"moved": 1}, tbox)
    with pytest.raises(errors.Refused, match="commit 1 cannot be undone: its facts were changed later"):
        undo(semantic_map, semantic_map._journal, TakeBack(id="3", source="operator", commit=1))
    undo(semantic_map, semantic_map._journal, TakeBack(id="4", source="operator", commit=2))
    undo(semantic_map, semantic_map._journal, TakeBack(id="5", source="operator", commit=1))
    assert (semantic_map.abox(), len(semantic_map), semantic_map.tbox) == ([], 0, frozenset(home.TBOX))


def test_a_present_entity_moves_with_the_provenance_of_the_load(semantic_map):
    load_now(semantic_map, with_declarations(1, z="0.1", tbox_from_abox=False))
    assert "Mug" not in semantic_map.classes.names.values()
    shown = CurrentState(semantic_map).entity(Get(name="mug1"))
    assert (shown.class_, shown.types[-1], shown.properties["holds"]) == ("Object", "Mug", ("tea",))
    loaded = load_now(semantic_map, with_declarations(2))
    assert (loaded.commit.tbox, loaded.names) == (True, ("mug1",))
    assert semantic_map.entity("mug1").pose_provenance.commit == 2
    assert semantic_map.entity("mug1").class_ == "Mug"
    assert not any(s.endswith("Mug>") for s, _, _ in semantic_map.abox())


def test_a_map_that_contradicts_its_own_declarations_changes_nothing(semantic_map):
    content = OWN.format("0.5") + ":Mug owl:disjointWith dm:Chair . :mug1 a dm:Chair ."
    load = structs.replace(with_declarations(1), content=content.encode())
    before = home.state(semantic_map), semantic_map.tbox
    with pytest.raises(errors.Inconsistent, match="mug1"):
        load_now(semantic_map, load)
    assert (home.state(semantic_map), semantic_map.tbox) == before


def test_declarations_and_their_entities_are_validated_together(semantic_map):
    shapes = home.turtle(
        "@prefix sh: <http://www.w3.org/ns/shacl#> . :S sh:targetClass dm:Object ;"
        " sh:property [ sh:path :holds ; sh:maxCount 0 ; sh:message 'holds nothing' ] ."
    )
    tbox = {*semantic_map.tbox, *shapes}
    semantic_map.replace_tbox(home.transaction("shapes"), tbox)
    semantic_map.enforcement = ShapeEnforcement(tbox)
    with pytest.raises(errors.Refused, match=r"^mug1: holds nothing; holds; required by the shapes"):
        load_now(semantic_map, with_declarations(1))
    assert (semantic_map.seq, semantic_map.tbox) == (1, tbox)
    semantic_map.enforcement = None
    assert load_now(semantic_map, with_declarations(2)).counts == {"new": 1}
