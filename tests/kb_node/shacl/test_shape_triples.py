"""The statements of a document that define shapes."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.shacl.shape_triples import (
    find_cycle,
    find_shapes,
    find_unsupported,
    read_list,
    select_shapes,
)
from semmap.ontology import vocabulary as v
from tests.kb_node.home import turtle


def shapes(text):
    return turtle(f"@prefix sh: <http://www.w3.org/ns/shacl#> .\n{text}")


def names(terms):
    return {v.entity_name(term) for term in terms if term.startswith("<")}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (":s a sh:NodeShape .", {"s"}),
        (":s a sh:PropertyShape .", {"s"}),
        (":s sh:targetClass dm:Chair .", {"s"}),
        (":s sh:targetNode :chair1 .", {"s"}),
        (":s sh:targetSubjectsOf dm:p .", {"s"}),
        (":s sh:targetObjectsOf dm:p .", {"s"}),
        (":s sh:property :t .", {"s"}),
        (":s sh:minCount 1 .", set()),
        (":s a owl:Class .", set()),
    ],
)
def test_a_shape_has_the_type_or_a_target_or_a_property(text, found):
    assert names(find_shapes(shapes(text))) == found


def test_constraints_that_are_not_evaluated_are_named_by_their_kind():
    found = find_unsupported(
        shapes(":s sh:sparql :q ; sh:rule :r ; sh:minCount 1 . :c sh:validator :x ; sh:nodeValidator :y .")
    )
    assert {(kind, v.entity_name(term)) for kind, term in found} == {
        ("SHACL SPARQL constraint", "q"),
        ("SHACL rule", "r"),
        ("SHACL constraint component", "c"),
    }


def test_shapes_that_refer_to_each_other_are_a_cycle():
    found = find_cycle(shapes(":a sh:node :b . :b sh:or ( :c :d ) . :d sh:not :a . :e sh:node :a ."))
    assert names(found) == {"a", "b", "d"}
    assert found[0] == found[-1]
    assert find_cycle(shapes(":a sh:node :b . :b dm:isOn :a . :c sh:path :c .")) == []


def test_a_list_is_read_once_though_it_returns_to_itself():
    first, rest = v.RDF_FIRST, v.RDF_REST
    triples = shapes(f":l {first} :a ; {rest} :m . :m {first} :b ; {rest} :l .")
    values = {(s, p): o for s, p, o in triples}
    assert [v.entity_name(one) for one in read_list(v.entity_iri("l"), values)] == ["a", "b"]
    assert list(read_list(v.entity_iri("x"), values)) == []


def test_only_the_statements_about_shapes_are_selected():
    text = """
    :s a sh:NodeShape , owl:Class ; sh:targetClass dm:Chair ; sh:sparql :q ; dm:isOn :t ; sh:in ( 1 2 ) .
    dm:Chair a owl:Class . :chair1 a dm:Chair .
    """
    found = select_shapes(shapes(text))
    about = sorted(p.rpartition("#")[2].rstrip(">") for s, p, _ in found if s == v.entity_iri("s"))
    assert about == ["in", "targetClass", "type", "type"]
    assert sum(p == v.RDF_FIRST for _, p, _ in found) == 2
    assert not any(s in (v.dm("Chair"), v.entity_iri("chair1")) for s, _, _ in found)
