"""How far a change may be from the individuals that become valid or invalid by it."""

import pytest

from semmap.nodes.kb_node.shacl.touched_individuals import Reach
from semmap.ontology import vocabulary as v
from tests.kb_node.home import turtle

P, Q, R = v.dm("p"), v.dm("q"), v.dm("r")
PATH = ":shape a sh:NodeShape ; sh:property [ sh:path dm:p ] ."
RULE = """[] a swrl:Imp ; swrl:body () ;
    swrl:head ( [ a swrl:IndividualPropertyAtom ; swrl:propertyPredicate dm:r ] ) ."""


def reach(text):
    prefixes = (
        "@prefix sh: <http://www.w3.org/ns/shacl#> .",
        "@prefix swrl: <http://www.w3.org/2003/11/swrl#> .",
    )
    return Reach.of(turtle("\n".join((*prefixes, text))))


def test_a_tbox_without_shapes_reaches_nothing():
    found = reach("dm:p rdfs:subPropertyOf dm:q .")
    assert not any((found.paths.length, found.closes_values, found.follows_values, found.concluded))
    for some in (found.forward, found.inverse, found.compared, found.targeted, found.chained):
        assert some == (frozenset(), frozenset(), frozenset())


@pytest.mark.parametrize(
    ("text", "field", "properties"),
    [
        (PATH, "forward", {P}),
        (":shape a sh:NodeShape ; sh:property [ sh:path [ sh:inversePath dm:p ] ] .", "inverse", {P}),
        (":shape a sh:NodeShape ; sh:property [ sh:path dm:p ; sh:equals dm:q ] .", "compared", {Q}),
        (":shape a sh:NodeShape ; sh:targetObjectsOf dm:q .", "targeted", {Q}),
        ("dm:p a owl:TransitiveProperty .", "chained", {P}),
        ("dm:r owl:propertyChainAxiom ( dm:p dm:q ) .", "chained", {P, Q}),
    ],
)
def test_the_properties_that_shapes_and_axioms_follow(text, field, properties):
    assert getattr(reach(text), field).properties == properties


@pytest.mark.parametrize(
    ("text", "follows"),
    [
        (PATH, False),
        (":shape a sh:NodeShape ; sh:property [ sh:path [ sh:inversePath dm:p ] ] .", True),
        (PATH + "dm:q owl:inverseOf dm:p .", False),
        (PATH + "dm:q owl:inverseOf dm:p ; a owl:TransitiveProperty .", True),
        (
            PATH + "dm:q owl:inverseOf dm:p ; a owl:TransitiveProperty . dm:p a owl:TransitiveProperty .",
            False,
        ),
        (PATH + "dm:q owl:inverseOf dm:p ; owl:propertyChainAxiom ( dm:r dm:r ) .", True),
    ],
)
def test_paths_may_begin_at_values_of_chains(text, follows):
    assert reach(text).follows_values == follows


def test_closed_shapes_and_rules_reach_further():
    assert reach(PATH + ":shape sh:closed true .").closes_values
    assert not reach(":shape a sh:NodeShape ; sh:closed true .").closes_values
    assert reach(RULE).concluded == {R}
