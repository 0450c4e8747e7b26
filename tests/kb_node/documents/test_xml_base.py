from xml.etree import ElementTree as Xml

import pytest

from semmap.nodes.kb_node.documents.xml_base import resolve_bases

DOCUMENT = "http://e.org/maps/map1"
BASE = "{http://www.w3.org/XML/1998/namespace}base"


def bases(content):
    resolved = resolve_bases(content.encode(), DOCUMENT)
    assert resolved.count(b"\n") == content.count("\n")
    return [element.get(BASE) for element in Xml.fromstring(resolved).iter() if element.get(BASE)]


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ('<a xml:base="kitchen"/>', ["http://e.org/maps/kitchen"]),
        ("<a\n  b='>'\n  xml:base = '/k' c=\"'\"/>", ["http://e.org/k"]),
        ('<a xml:base=""><b xml:base="c/"/></a>', [DOCUMENT, "http://e.org/maps/c/"]),
        (
            '<a xml:base="x/"><b xml:base="y/"><c xml:base="z"/></b><d xml:base="w"/></a>',
            ["x/", "x/y/", "x/y/z", "x/w"],
        ),
        ('<a xml:base="http://o.org/"><b xml:base="m&amp;n"/></a>', ["http://o.org/", "http://o.org/m&n"]),
        ('<a xml:base="k"><!-- <b xml:base="l"/> -->caffè</a>', ["http://e.org/maps/k"]),
    ],
)
def test_a_base_is_relative_to_the_enclosing_one(content, expected):
    assert bases(content) == [iri if ":" in iri else f"http://e.org/maps/{iri}" for iri in expected]


def test_a_document_with_absolute_bases_stays_as_it_is():
    content = b'<a xml:base="urn:x"/>'
    assert resolve_bases(content, DOCUMENT) is content


def test_a_base_in_an_entity_stays_as_it_is():
    content = "<!DOCTYPE a [<!ENTITY e '<b xml:base=\"l\"/>'>]><a xml:base='k'>&e;</a>"
    assert bases(content) == ["http://e.org/maps/k", "l"]
