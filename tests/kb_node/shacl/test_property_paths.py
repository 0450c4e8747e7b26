"""Which steps the paths of shapes take, and from where they lead to a fact."""

from __future__ import annotations

from math import inf

import pytest

from semmap.nodes.kb_node.shacl.property_paths import PropertyPaths, find_property_paths, push_inverses
from semmap.ontology import vocabulary as v
from tests.kb_node.home import turtle

P, Q, R = v.dm("p"), v.dm("q"), v.dm("r")
A, B, C, D = (v.entity_iri(name) for name in "abcd")
LINE = [(A, P, B), (B, P, C), (C, P, D)]


def shapes(text):
    return turtle(f"@prefix sh: <http://www.w3.org/ns/shacl#> .\n{text}")


def with_path(path):
    return find_property_paths(shapes(f":shape a sh:NodeShape ; sh:property [ sh:path {path} ] ."))


@pytest.mark.parametrize(
    ("path", "forward", "inverse", "length"),
    [
        ("dm:p", {P}, set(), 1),
        ("[ sh:inversePath dm:p ]", set(), {P}, 1),
        ("( dm:p [ sh:inversePath dm:q ] dm:p )", {P}, {Q}, 3),
        ("[ sh:alternativePath ( dm:p ( dm:q dm:r ) ) ]", {P, Q, R}, set(), 2),
        ("[ sh:zeroOrOnePath ( dm:p dm:q ) ]", {P, Q}, set(), 2),
        ("[ sh:zeroOrMorePath dm:p ]", {P}, set(), inf),
        ("( dm:q [ sh:oneOrMorePath [ sh:inversePath dm:p ] ] )", {Q}, {P}, inf),
        ("[ sh:inversePath [ sh:inversePath dm:p ] ]", {P}, set(), 1),
        ("[ sh:inversePath [ sh:alternativePath ( dm:p [ sh:zeroOrOnePath dm:q ] ) ] ]", set(), {P, Q}, 1),
    ],
)
def test_a_path_has_properties_by_direction_and_a_number_of_steps(path, forward, inverse, length):
    assert with_path(path) == PropertyPaths(frozenset(forward), frozenset(inverse), length)


def test_the_longest_path_of_all_shapes_counts_and_nested_shapes_make_it_longer():
    text = """
    :one a sh:NodeShape ; sh:property [ sh:path dm:p ] , [ sh:path ( dm:q dm:q ) ] .
    :two a sh:NodeShape ; sh:property [ sh:path dm:p ; sh:node :three ] .
    :three a sh:NodeShape ; sh:or ( [ sh:path dm:p ] [ sh:not [ sh:path ( dm:r dm:r ) ] ] ) .
    """
    assert find_property_paths(shapes(text)).length == 3
    assert find_property_paths(shapes(text.partition(":two")[0])).length == 2


def test_a_shape_that_refers_to_itself_reaches_everything():
    text = ":loop a sh:NodeShape ; sh:property [ sh:path dm:p ; sh:node :loop ] ."
    assert find_property_paths(shapes(text)).length == inf


def test_without_shapes_there_is_no_path():
    assert find_property_paths(turtle(":a dm:p :b .")) == PropertyPaths()


def facts_of(triples):
    def find(s, p, o):
        return [t for t in triples if s in (None, t[0]) and p in (None, t[1]) and o in (None, t[2])]

    return find


@pytest.mark.parametrize(
    ("length", "starts"), [(0, {D}), (1, {D, C}), (2, {D, C, B}), (3, {D, C, B, A}), (inf, {D, C, B, A})]
)
def test_starts_are_at_most_as_many_steps_away_as_a_path_has(length, starts):
    paths = PropertyPaths(forward=frozenset({P}), length=length)
    assert paths.find_starts([D], facts_of(LINE)) == starts


def test_an_inverse_step_begins_at_the_value_and_other_properties_are_not_followed():
    facts = facts_of([*LINE, (A, Q, D), (A, P, '"a literal"')])
    assert PropertyPaths(inverse=frozenset({P}), length=1).find_starts([A], facts) == {A, B}
    assert PropertyPaths(forward=frozenset({Q}), length=9).find_starts([D], facts) == {A, D}
    both = PropertyPaths(frozenset({Q}), frozenset({P}), 2)
    assert both.find_starts([D], facts) == {D, A, B}


def test_a_circle_of_facts_is_followed_once():
    circle = [*LINE, (D, P, A)]
    assert PropertyPaths(frozenset({P}), length=inf).find_starts([A], facts_of(circle)) == {A, B, C, D}


@pytest.mark.parametrize(
    ("path", "same"),
    [
        ("( dm:p dm:q dm:r )", "( [ sh:inversePath dm:r ] [ sh:inversePath dm:q ] [ sh:inversePath dm:p ] )"),
        ("[ sh:zeroOrMorePath dm:p ]", "[ sh:zeroOrMorePath [ sh:inversePath dm:p ] ]"),
        ("[ sh:oneOrMorePath dm:p ]", "[ sh:oneOrMorePath [ sh:inversePath dm:p ] ]"),
        ("[ sh:zeroOrOnePath dm:p ]", "[ sh:zeroOrOnePath [ sh:inversePath dm:p ] ]"),
        (
            "[ sh:alternativePath ( dm:p dm:q ) ]",
            "[ sh:alternativePath ( [ sh:inversePath dm:p ] [ sh:inversePath dm:q ] ) ]",
        ),
        (
            "( dm:r [ sh:alternativePath ( ( dm:p dm:q ) ) ] )",
            "( [ sh:alternativePath ( ( [ sh:inversePath dm:q ] [ sh:inversePath dm:p ] ) ) ]"
            " [ sh:inversePath dm:r ] )",
        ),
    ],
)
def test_the_inverse_of_a_path_becomes_a_path_of_inverses(path, same):
    pushed = push_inverses(shapes(f":shape sh:path [ sh:inversePath {path} ] ."))
    assert describe(":shape", pushed) == describe(":shape", shapes(f":shape sh:path {same} ."))


@pytest.mark.parametrize("path", ["dm:p", "[ sh:inversePath dm:p ]", "( dm:p dm:q )"])
def test_a_path_without_an_inverse_of_more_than_a_property_stays(path):
    triples = shapes(f":shape sh:path {path} .")
    assert push_inverses(triples) == list(triples)


def describe(node, triples):
    """Return what can be reached from a node, without the labels of blank nodes."""
    term = v.entity_iri(node.removeprefix(":")) if node.startswith(":") else node
    about = sorted((p, o) for s, p, o in triples if s == term)
    return [(p, describe(o, triples) if o.startswith("_:") else o) for p, o in about]
