"""Common words of Turtle are converted together, and unusual ones are left to the parser."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.documents.plain_words import plain_terms

SPACES = {"ex": "http://example.org/"}
FULL = "<http://www.w3.org/2001/XMLSchema#double>"


def datatype(word):
    return FULL if word == "xsd:double" else None


def names(count, prefix="ex"):
    return [f"{prefix}:a_{k}-b" for k in range(count)]


def numbers(count, kind="xsd:double"):
    return [f'"{k}.5"^^{kind}' for k in range(count)]


def test_a_hundred_names_of_a_prefix_become_iris_and_fewer_do_not():
    found = plain_terms(names(100), SPACES, datatype)
    assert found == {word: f"<http://example.org/{word[3:]}>" for word in names(100)}
    assert plain_terms(names(99), SPACES, datatype) == {}


def test_a_hundred_literals_of_a_datatype_get_its_iri_and_fewer_do_not():
    found = plain_terms(numbers(100), SPACES, datatype)
    assert found == {word: word.replace("xsd:double", FULL) for word in numbers(100)}
    assert plain_terms(numbers(99), SPACES, datatype) == {}


def test_unknown_prefixes_and_datatypes_leave_the_known_ones_alone():
    words = [*names(100, "no"), *numbers(100, "xsd:other"), *names(100), *numbers(100)]
    assert plain_terms(words, SPACES, datatype).keys() == {*names(100), *numbers(100)}


@pytest.mark.parametrize("word", ["ex:", "ex:-a", "ex:caf\u00e9", "ex:a.b", "ex:a%20b"])
def test_one_unusual_name_leaves_all_of_its_prefix_to_the_parser(word):
    assert plain_terms([*names(100), word], SPACES, datatype) == {}
    assert plain_terms([*names(100), word, *numbers(100)], SPACES, datatype).keys() == set(numbers(100))


@pytest.mark.parametrize(
    "text", ['"a\\nb"', '"a\\"b"', '"caf\u00e9"', '"a\tb"', '"""a"""', '"a"@en'], ids=repr
)
def test_one_unusual_literal_leaves_all_of_its_datatype_to_the_parser(text):
    assert plain_terms([*numbers(100), f"{text}^^xsd:double"], SPACES, datatype) == {}


def test_kinds_after_the_twentieth_are_left_to_the_parser():
    prefixes = [f"p{k}" for k in range(21)]
    spaces = {prefix: f"http://example.org/{prefix}/" for prefix in prefixes}
    found = plain_terms([word for prefix in prefixes for word in names(100, prefix)], spaces, datatype)
    assert {word.partition(":")[0] for word in found} == set(prefixes[:20])
