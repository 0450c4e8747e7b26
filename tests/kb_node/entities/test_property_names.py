"""Words for the properties of a TBox."""

import pytest

from semmap.nodes.kb_node.entities.property_names import PropertyNames
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node.reasoner.graphs import triples

TBOX = """
:hasColor rdfs:label "has color"@en , "ha colore"@it . :hasShade rdfs:label "shade"@en .
:tint rdfs:label "shade"@en . dm:mass rdfs:label "mass"@en . :mass rdfs:label "weight"@en .
"""
EX = "http://example.org/"
COLOR, SHADE, TINT, MASS = (v.iri(EX + name) for name in ("hasColor", "hasShade", "tint", "mass"))


@pytest.fixture(scope="module")
def names():
    prefixes = {"ex": EX, "dm": v.TBOX}
    properties = [COLOR, SHADE, TINT, MASS, v.dm("mass"), "_:unnamed"]
    return PropertyNames(Reasoner(triples(TBOX)), properties, prefixes)


def test_a_property_has_its_local_name_unless_several_share_it(names):
    assert names.names[COLOR] == "hasColor"
    assert names.names[MASS] == "ex:mass"
    assert len(set(names.names.values())) == len(names.names) == 5
    assert "_:unnamed" not in names.names


@pytest.mark.parametrize(
    ("word", "found"),
    [
        ("hasColor", COLOR),
        ("has_color", COLOR),
        ("ha colore", COLOR),
        (EX + "hasColor", COLOR),
        ("ex:hasColor", COLOR),
        ("ex:mass", MASS),
        ("weight", MASS),
        ("size", None),
    ],
)
def test_a_property_is_found_by_name_label_or_iri(names, word, found):
    assert names.find(word) == found


def test_an_ambiguous_word_is_rejected_unless_one_is_wanted(names):
    with pytest.raises(
        errors.BadRequest, match=r"'shade' is ambiguous: hasShade .* tint; say which property"
    ):
        names.find("shade")
    assert names.find("shade", among=lambda p: p == TINT) == TINT
    with pytest.raises(errors.BadRequest, match="ambiguous"):
        names.find("shade", among=lambda p: p == COLOR)


def test_similar_names_are_suggested_among_the_wanted_ones(names):
    assert "hasColor" in names.did_you_mean("hasColour")
    assert names.did_you_mean("hasColour", lambda p: p == MASS) == ""
    assert names.did_you_mean("zzzzzz") == ""


def test_labels_are_in_every_language(names):
    assert sorted(names.labels(COLOR)) == ["ha colore", "has color"]
    assert list(names.labels(v.dm("hasNone"))) == []
