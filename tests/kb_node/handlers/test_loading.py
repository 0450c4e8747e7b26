"""Loading of documents, without the wire."""

from contextlib import nullcontext

import pytest
from msgspec import structs

from semmap.nodes.kb_node.documents import parser_process, rdf
from semmap.nodes.kb_node.handlers import loading as handlers_loading
from semmap.nodes.kb_node.handlers.changes import ChangeHandlers
from semmap.nodes.kb_node.handlers.loading import LoadHandlers
from semmap.nodes.kb_node.reasoner.rules import closure
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import LoadDocument
from semmap.schemas.entities import Pose


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
        loads._parser,
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
    monkeypatch.setattr(loads._parser, "close_tbox", lambda known, *_, **__: tried.append(known))
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
