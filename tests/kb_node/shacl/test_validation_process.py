"""The validation of shapes of unknown origin, without its process."""

import pytest
from msgspec import msgpack, structs

from semmap.nodes.kb_node.shacl import validation_process
from semmap.nodes.kb_node.shacl.validation_process import Request, Validation, answer
from tests.kb_node import home
from tests.kb_node.home import PREFIXES, turtle
from tests.kb_node.shacl.test_shapes import FACTS, SH, of_chairs

SHAPE = of_chairs("sh:path dm:isLocatedIn ; sh:minCount 1")


def validate(content, tbox=""):
    text = (PREFIXES + SH + content).encode() if content else b""
    facts = [*home.TBOX, *turtle(FACTS + SH + tbox)]
    return msgpack.decode(answer(msgpack.encode(Request(facts, [], text, "s.ttl"))), type=Validation)


@pytest.mark.parametrize(("content", "tbox", "shapes"), [(SHAPE, "", 1), ("", SHAPE, 1), (SHAPE, SHAPE, 2)])
def test_shapes_of_map_and_document_are_validated(content, tbox, shapes):
    found = validate(content, tbox)
    assert (found.error, found.shapes, len(found.results)) == ("", shapes, shapes)


@pytest.mark.parametrize(
    ("content", "error"),
    [
        (":a :b", "s.ttl is not valid Turtle"),
        (":a :b :c .", "s.ttl: no SHACL shapes with a target"),
        (":s sh:targetNode :a ; sh:minLength 'x' .", "s.ttl: invalid SHACL shape"),
    ],
)
def test_an_invalid_document_is_an_error(content, error):
    assert validate(content).error.startswith(error)


def test_a_shape_of_the_map_that_fails_hides_no_violations():
    found = validate(SHAPE, SHAPE + ":s sh:targetNode :chair1 ; sh:pattern '(' .")
    assert (found.error, found.shapes, found.count, found.is_complete) == ("", 2, 2, False)
    (note,) = found.notes
    assert note.startswith("shapes not evaluated: the map: invalid SHACL shape: missing )")
    found = validate("", SHAPE + ":s sh:targetNode :a ; sh:property [ sh:path dm:a , dm:b ] .")
    assert (found.shapes, found.count, found.is_complete, len(found.notes)) == (0, 0, False, 1)
    assert validate(SHAPE).is_complete


def test_what_is_not_evaluated_is_noted():
    found = validate(SHAPE + " :s sh:sparql [ sh:select '' ] ; sh:rule [] .")
    assert found.notes == ["s.ttl: stored, but not evaluated: 1 SHACL SPARQL constraint, 1 SHACL rule"]


def test_of_many_violations_the_first_are_listed(monkeypatch):
    monkeypatch.setattr(validation_process, "MOST_RESULTS", 2)
    found = validate("".join(f"[] sh:targetNode :c{n} ; sh:class dm:Door ." for n in (3, 1, 2)))
    assert (len(found.results), found.count) == (2, 3)
    assert found.notes == ["the first 2 of 3 violations are listed; use fewer shapes to list others"]
    assert validate(SHAPE).count == 1


def test_texts_of_any_length_are_short_in_results():
    long = "x" * 5000
    found = validate(f"""
        <urn:{long}> sh:targetNode "{long}" , <urn:i{long}> ; sh:class dm:Door ;
            sh:message "{long}"@en , "{long}"@it .
        [] sh:targetNode :a ; sh:property [ sh:path ( <urn:{long}> dm:near ) ; sh:minCount 1 ] ;
            sh:property [ sh:path dm:near ; sh:hasValue "{long}" ] .
    """)
    assert found.count == 4
    assert all(len(text) < 600 for one in found.results for text in structs.astuple(one))
