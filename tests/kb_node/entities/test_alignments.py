"""Files of alignments with other vocabularies."""

import pytest

from semmap.nodes.kb_node.entities import alignments
from semmap.nodes.kb_node.entities.alignments import PoseMapping, SizeMapping
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node import home

IFC = "http://standards.buildingsmart.org/IFC/DEV/"
FILE = """
title = "a:title stays as written"
namespaces = ["a"]
things = ["a:Thing", "<urn:x>"]
names = ["b:name"]

[prefixes]
a = "http://a.org#"
b = "http://b.org/"

[[pose]]
path = ["a:at", "a:region"]
position = "a:xyz"
orientation = "a:turn"
order = "wxyz"
origin = "bottom"

[[pose]]
position = "b:direct"

[[size]]
path = ["a:shape"]
x = "a:depth"
y = "a:width"
z = "a:height"

[[size]]
x = "b:depth"
y = "b:width"
z = "b:height"

[[set_aside]]
triple = ["a:s", "a:p", "a:o"]
why = "b: because"

[relations]
isOn = "b:on"
"""


def a(name):
    return v.iri("http://a.org#" + name)


def b(name):
    return v.iri("http://b.org/" + name)


@pytest.fixture
def read():
    return alignments.read(FILE, "a.toml")


def test_prefixed_names_become_terms(read):
    assert read.title == "a:title stays as written"
    assert read.prefixes == {"a": "http://a.org#", "b": "http://b.org/"}
    assert read.namespaces == ("http://a.org#",)
    assert read.things == (a("Thing"), "<urn:x>")
    assert read.names == (b("name"),)
    assert read.relations == {"isOn": b("on")}
    (ignored,) = read.set_aside
    assert (ignored.triple, ignored.why, ignored.instead) == ((a("s"), a("p"), a("o")), "b: because", None)


def test_poses_and_sizes_are_found_along_paths(read):
    assert read.pose == (
        PoseMapping(
            path=(a("at"), a("region")),
            position=a("xyz"),
            orientation=a("turn"),
            order="wxyz",
            origin="bottom",
        ),
        PoseMapping(position=b("direct"), order="xyzw", origin="middle"),
    )
    assert read.size[0] == SizeMapping(path=(a("shape"),), x=a("depth"), y=a("width"), z=a("height"))
    assert read.edges == {a("at"), a("region"), a("shape")}


def test_the_entry_properties_are_those_of_the_entity_itself(read):
    assert read.entry_properties == {
        *(a("at"), b("direct"), a("shape"), b("depth"), b("width"), b("height")),
        *(b("name"), v.RDFS_LABEL),
    }


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("title = ", "a.toml is not an alignment: "),
        (FILE.replace("a:Thing", "c:Thing"), "a.toml is not an alignment: it has no prefix 'c'"),
        (FILE.replace('["a"]', '["c"]'), "it has no prefix 'c'"),
        ("more = true" + FILE, "a.toml is not an alignment: .*more"),
        (FILE.replace('"wxyz"', '"xwyz"'), "a.toml is not an alignment: "),
        ('title = "t"', "a.toml is not an alignment: .*prefixes"),
    ],
)
def test_an_invalid_file_is_named(text, said):
    with pytest.raises(errors.BadFile, match=said):
        alignments.read(text, "a.toml")


def test_the_shipped_alignments_are_found_by_their_namespaces():
    shipped = alignments.shipped()
    assert len(shipped) > 3
    assert alignments.shipped() is shipped
    for known in shipped:
        for namespace in known.namespaces:
            assert known in alignments.find_for_namespaces(["http://else.org/", namespace])
    assert alignments.find_for_namespaces(["http://else.org/"]) == ()
    every = [namespace for known in shipped for namespace in known.namespaces]
    assert alignments.find_for_namespaces(every) == shipped


@pytest.mark.parametrize(
    ("namespace", "element", "zone"),
    [
        ("https://w3id.org/bot#", "Element", "Zone"),
        (f"{IFC}IFC4/ADD2/OWL#", "IfcElement", "IfcSpatialElement"),
        (f"{IFC}IFC2x3/TC1/OWL#", "IfcElement", "IfcSpatialStructureElement"),
        ("https://brickschema.org/schema/Brick#", "Equipment", "Location"),
    ],
)
def test_the_elements_of_buildings_are_things_and_their_spaces_are_places(namespace, element, zone):
    below = {"Chair": element, "Office": zone}
    names = (element, zone, *below)
    triples = [(v.iri(namespace + name), v.RDF_TYPE, v.OWL_CLASS) for name in names]
    triples += [
        (v.iri(namespace + c), v.RDFS_SUB_CLASS_OF, v.iri(namespace + root)) for c, root in below.items()
    ]
    rows = {row.name: row for row in ClassTable(Reasoner(triples)).rows}
    assert all(rows[name].spatial for name in names)
    assert [rows[name].place for name in ("Chair", "Office")] == [False, True]


def test_the_names_of_ifc_are_labels(tmp_path):
    ifc, string = f"{IFC}IFC4/ADD2/OWL#", "<https://w3id.org/express#hasString>"
    element, label = v.iri(f"{ifc}IfcElement"), v.iri(f"{ifc}IfcLabel")
    semantic_map = home.new_map(tmp_path, {(c, v.RDF_TYPE, v.OWL_CLASS) for c in (element, label)})
    wall = ("<urn:x:wall1>", v.RDF_TYPE, element)
    named = ("<urn:x:wall1>", v.iri(f"{ifc}name_IfcRoot"), "<urn:x:label1>")
    text = ("<urn:x:label1>", string, v.literal("north wall"))
    semantic_map.commit(home.transaction(1, [wall, named, ("<urn:x:label1>", v.RDF_TYPE, label), text]))
    assert semantic_map.entity("wall1").preferred_reference == "north wall"
    assert semantic_map.individuals.list() == ()
    new = ("<urn:x:label1>", string, v.literal("south wall"))
    semantic_map.commit(home.transaction(2, [new], retract=[text]))
    assert semantic_map.entity("wall1").preferred_reference == "south wall"
    home.close(semantic_map)
