"""A document costs its parser process at most, and is then rejected in one line."""

import codecs
import os
import signal

import pytest

from semmap.nodes.kb_node.documents import parser_process, rdf
from semmap.nodes.kb_node.documents.isolated_parser import IsolatedParser
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.nesting import LIMIT

TURTLE = b"@prefix a: <http://a#> . a:x a a:C , a:D ."
FUNCTIONAL = b"Prefix(a:=<http://a#>) Ontology(<http://a> SubClassOf(a:C ObjectSomeValuesFrom(a:p a:D)))"


def test_a_reply_contains_the_document():
    for content in (TURTLE, FUNCTIONAL, b"# nothing"):
        document = rdf.read(content, "x", label_prefix="f")
        assert parser_process.Reply.of(document).document() == document
    with pytest.raises(errors.BadFile, match="the text"):
        parser_process.Reply(error="the text").document()


def test_turtle_needs_no_process():
    with IsolatedParser(["no such program"]) as parser:
        assert parser.read(TURTLE, "x", "f") == rdf.read(TURTLE, "x", label_prefix="f")


@pytest.mark.parametrize(
    ("content", "isolated"),
    [(TURTLE, False), (FUNCTIONAL, True), (b"<?xml version='1.0'?><a/>", True), (b'{"@id": "a"}', True)],
)
@pytest.mark.parametrize("mark", [b"", codecs.BOM_UTF8])
def test_a_byte_order_mark_does_not_change_what_is_isolated(content, isolated, mark):
    assert IsolatedParser.isolates(mark + content) == isolated


def test_deep_class_expressions_are_rejected_although_their_text_is_flat():
    inner = "".join(
        f"_:b{n} <http://www.w3.org/2002/07/owl#complementOf> _:b{n + 1} .\n" for n in range(LIMIT)
    )
    with IsolatedParser() as parser:
        assert len(parser.read(inner.encode(), "x").triples) == LIMIT
        inner += f"_:b{LIMIT} <http://www.w3.org/2002/07/owl#complementOf> _:b .\n"
        with pytest.raises(
            errors.BadFile, match=f"x: class expressions are nested deeper than {LIMIT} levels"
        ):
            parser.read(inner.encode(), "x")


@pytest.fixture
def parser():
    with IsolatedParser() as parser:
        yield parser


@pytest.mark.process
def test_documents_are_parsed_by_one_process(parser):
    assert parser.read(FUNCTIONAL, "x", "f") == rdf.read(FUNCTIONAL, "x", label_prefix="f")
    first = parser._process
    with pytest.raises(errors.BadFile, match=r"x\.ofn is not valid OWL functional syntax: line 1"):
        parser.read(FUNCTIONAL[:-1], "x.ofn")
    assert parser.read(FUNCTIONAL, "y") == rdf.read(FUNCTIONAL, "y")
    assert parser._process is first


@pytest.mark.process
def test_after_a_crash_another_process_parses_the_next_document(parser):
    parser.read(FUNCTIONAL, "x")
    os.kill(parser._process.pid, signal.SIGSEGV)
    parser._process.wait()
    assert parser.read(FUNCTIONAL, "x") == rdf.read(FUNCTIONAL, "x")


@pytest.mark.process
def test_the_closure_of_a_tbox_is_that_of_a_reasoner(parser):
    tbox = rdf.parse(HOUSEHOLD_TTL.read_bytes(), "x")
    closed = parser.close_tbox(tbox, "x")
    assert closed.facts == Reasoner(tbox).closed.facts
    assert Reasoner(tbox, closed=closed).closed.facts == closed.facts
    nothing = [("<a:C>", "<http://www.w3.org/2002/07/owl#differentFrom>", "<a:C>")]
    with pytest.raises(errors.Inconsistent, match="the TBox is inconsistent: ") as found:
        parser.close_tbox([*tbox, *nothing], "x", of="the TBox")
    assert found.value.explanation.support == tuple(nothing)


@pytest.mark.process
def test_owl_is_written_in_the_process(parser):
    triples = [("<urn:a>", v.RDF_TYPE, "<urn:C>"), ("<urn:C>", v.RDF_TYPE, v.OWL_CLASS)]
    document = parser.write_owl(triples, "functional", {})
    assert set(parser.read(document.content, "f").triples) >= set(triples)
    with pytest.raises(errors.Refused, match="RDF/XML cannot hold the character"):
        parser.write_owl([("<urn:a>", "<urn:p:>", '"\x07"')], "manchester", {})
