"""Inferences of owlrl from the TBox, as the reference for other reasoners.

Closing the TBox with the flat takes owlrl a good while, so one closure, with the examples below, serves the
file. It is long: our own reasoner checks the shipped files at every start.
"""

import pytest
from rdflib import OWL, RDF, Graph, URIRef
from rdflib.term import Node

from benchmarks.relations.accuracy import FLAT_BY_HAND
from semmap.nodes.kb_node.owlrl.closure_process import close
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from tests.ontology.graphs import DM, MAP, classes, forget_unused_classes, local, named, read

pytestmark = pytest.mark.long

PREFIXES = """
@prefix : <urn:example:> .
@prefix dm: <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""

EXAMPLES = """
:yogurt a dm:Yogurt ; dm:isInside :fridge . :fridge a dm:Fridge ; dm:isLocatedIn :kitchen .
:chair a dm:Chair ; dm:supports :ann . :ann a dm:Person .
:picture a dm:Picture ; dm:isAttachedTo :wall . :wall a dm:Wall .
:trunk a dm:Furniture ; dm:hasAffordance dm:containing .
:tatami a dm:Furniture ; dm:hasAffordance dm:lying .
:gourd a dm:Plant ; dm:hasAffordance dm:drinking_from , dm:containing .
:mug a dm:Object ; dm:hasMaterial dm:material_ceramic .
:drawer a dm:Drawer ; dm:hasHandle :handle . :drawer dm:isPartOf :desk .
:hall a dm:Hall . :stairs a dm:Stairs ; dm:connects :hall , :upstairs .
:hook a dm:Handle . :coat dm:isDirectPartOf :hook , :peg .
"""
"""Maps of one line each, consistent and apart from one another."""


@pytest.fixture(scope="module")
def inferred() -> tuple[Graph, list[str]]:
    graph = read(HOUSEHOLD_TTL, FLAT_TTL, FLAT_BY_HAND)  # owlrl computes nothing from poses
    graph.parse(data=PREFIXES + EXAMPLES, format="turtle")
    forget_unused_classes(graph)
    return graph, close(graph)


def test_flat_is_consistent(inferred: tuple[Graph, list[str]]) -> None:
    graph, errors = inferred
    assert errors == []
    assert not list(graph.subjects(RDF.type, OWL.Nothing))


def test_no_named_class_is_unsatisfiable() -> None:
    graph = read(HOUSEHOLD_TTL)
    named_classes = classes(graph)
    for cls in named_classes:
        graph.add((URIRef(f"urn:fresh:{local(cls)}"), RDF.type, cls))
    assert close(graph) == []
    assert not list(graph.subjects(RDF.type, OWL.Nothing))
    for cls in named_classes:
        assert named_classes & set(graph.objects(cls, OWL.equivalentClass)) == {cls}, cls


@pytest.mark.parametrize(
    ("name", "members"),
    [
        ("Seat", {"chair1", "chair5", "couch1", "armchair1"}),
        ("Sleeping_Furniture", {"bed1", "couch1"}),
        ("Storage_Furniture", {"cabinet1", "counter1", "wardrobe1"}),
        ("Containing_Thing", {"bowl1", "fridge1", "bin1"}),
        ("Supporting_Thing", {"table1", "desk1", "shelf1"}),
        ("Drinkable", {"milk1", "water1"}),
        ("Edible", {"apple1", "bread1", "milk1"}),
        ("Drinking_Vessel", {"cup1", "glass1"}),
        ("Graspable_Thing", {"book1", "apple1", "plate1"}),
        ("Openable_Thing", {"door1", "fridge1", "window1"}),
        ("Switchable_Thing", {"light1", "television1", "lamp1"}),
        ("Light_Source", {"light1", "lamp1", "abat_jour1"}),
        ("Heat_Source", {"stove1", "kettle1"}),
        ("Cooking_Appliance", {"oven1", "stove1"}),
        ("Reading_Matter", {"book1", "book2", "book3"}),
        ("Passage", {"door1", "door7"}),
        ("Breakable_Thing", {"cup1", "glass1", "window1"}),
        ("Dishwasher_Load", {"plate1", "pan1", "cup1"}),
        ("Laundry", {"towel1"}),
        ("Filled_Thing", {"bowl1"}),
        ("Laden_Thing", {"table1", "cabinet1", "shelf1"}),
        ("Controlled_Thing", {"light1", "television1", "sink1"}),
        ("Personal_Belonging", {"keys1", "laptop1", "smartphone1"}),
        ("Wet_Room", {"bathroom1", "kitchen1"}),
        ("Furnished_Room", {"livingroom1", "bedroom1", "studio1"}),
        ("Occupied_Location", {"studio1", "flat1"}),
    ],
)
def test_flat_fills_the_defined_classes(
    inferred: tuple[Graph, list[str]], tbox: Graph, name: str, members: set[str]
) -> None:
    graph, _ = inferred
    assert (named(name), OWL.equivalentClass, None) in tbox
    found = {local(s) for s in graph.subjects(RDF.type, named(name)) if str(s).startswith(str(MAP))}
    assert members <= found


@pytest.mark.parametrize(
    ("name", "strangers"),
    [
        ("Seat", {"toilet1", "table1", "bed1"}),
        ("Drinkable", {"apple1", "bottle1", "glass1"}),
        ("Wet_Room", {"bedroom1", "flat1"}),
        ("Graspable_Thing", {"table1", "person1"}),
        ("Light_Source", {"window1", "mirror1"}),
        ("Occupied_Location", {"kitchen1"}),
    ],
)
def test_defined_classes_do_not_hold_strangers(
    inferred: tuple[Graph, list[str]], name: str, strangers: set[str]
) -> None:
    graph, _ = inferred
    found = {local(s) for s in graph.subjects(RDF.type, named(name))}
    assert not strangers & found


def example(name: str) -> URIRef:
    return URIRef(f"urn:example:{name}")


@pytest.mark.parametrize(
    ("subject", "predicate", "value"),
    [
        # the flat
        (MAP.plate1, DM.isLocatedIn, MAP.kitchen1),
        (MAP.book3, DM.isLocatedIn, MAP.flat1),
        (MAP.apple1, DM.isLocatedIn, MAP.dining_corner1),
        (MAP.bedroom1, DM.contains, MAP.smartphone1),
        (MAP.corridor1, DM.isConnectedTo, MAP.studio1),
        (MAP.kitchen1, DM.isConnectedTo, MAP.livingroom1),
        (MAP.kitchen1, DM.isAdjacentTo, MAP.livingroom1),
        (MAP.flat1, DM.hasSubLocation, MAP.reading_corner1),
        (MAP.table1, DM.touches, MAP.plate1),
        (MAP.couch1, DM.hasColor, DM.color_blue),
        (MAP.person1, DM.owns, MAP.keys1),
        # the examples
        (example("yogurt"), RDF.type, DM.Chilled_Food),
        (example("yogurt"), DM.isLocatedIn, example("kitchen")),
        (example("chair"), RDF.type, DM.Taken_Seat),
        (example("picture"), RDF.type, DM.Wall_Mounted_Thing),
        (example("trunk"), RDF.type, DM.Storage_Furniture),
        (example("tatami"), RDF.type, DM.Sleeping_Furniture),
        (example("gourd"), RDF.type, DM.Drinking_Vessel),
        (example("mug"), RDF.type, DM.Breakable_Thing),
        (example("desk"), DM.hasPart, example("handle")),
        (example("handle"), DM.isDirectPartOf, example("drawer")),
        (example("hall"), DM.isConnectedTo, example("upstairs")),
        (example("upstairs"), RDF.type, DM.Location),
        (example("kitchen"), RDF.type, DM.Location),
        (example("hook"), OWL.sameAs, example("peg")),
    ],
)
def test_follows(inferred: tuple[Graph, list[str]], subject: Node, predicate: Node, value: Node) -> None:
    graph, _ = inferred
    assert (subject, predicate, value) in graph


FAULTS = {
    "disjoint by inheritance": ":a a dm:Kitchen , dm:Chair .",
    "disjoint kinds of furniture": ":a a dm:Armchair , dm:Dining_Table .",
    "abstract and physical": ":a a dm:Coordinates , dm:Wall .",
    "disjoint through a range": ":a a dm:Chair ; dm:isLocatedIn :b . :b a dm:Table .",
    "irreflexive through a subproperty": ":a a dm:Cup ; dm:isAttachedTo :a .",
    "asymmetric through an inverse": ":a dm:isOn :b ; dm:supports :b .",
    "properties disjoint": ":a dm:isOn :b ; dm:isInside :b .",
    "two values of a functional property": ':a dm:float_coordinates_x "1.0"^^xsd:float , "2.0"^^xsd:float .',
    "cardinality of positions": """
        :a a dm:Chair ; dm:hasPosition :b , :c .
        :b a dm:Coordinates ; dm:float_coordinates_x "1.0"^^xsd:float .
        :c a dm:Coordinates ; dm:float_coordinates_x "2.0"^^xsd:float .""",
    "two preferred texts": """
        :a a dm:Chair ; dm:hasPreferredReference :b , :c .
        :b dm:lexicalReference "chair" . :c dm:lexicalReference "seat" .""",
    "two main colors": ":a a dm:Cup ; dm:hasMainColor dm:color_red , dm:color_blue .",
    "one shape by its class, another said": ":a a dm:Can ; dm:hasShape dm:shape_cuboid .",
    "inverse functional": ":a dm:hasHandle :c . :b dm:hasHandle :c . :a owl:differentFrom :b .",
    "only building subparts in a corner": ":a a dm:Corner ; dm:hasSubLocation :b . :b a dm:Bathroom .",
    "a place on a thing": ":a a dm:Kitchen ; dm:isOn :b . :b a dm:Table .",
    "a place in a thing": ":a a dm:Corner . :b a dm:Fridge ; dm:holds :a .",
    "a tap controls plumbing only": ":a a dm:Tap ; dm:controls :b . :b a dm:Heating .",
    "complement": ":a a dm:Aspirin ; dm:hasAffordance dm:eating .",
    "defined class": ":a a dm:Soap ; dm:hasAffordance dm:drinking .",
    "ill-typed literal": ':a dm:float_size_x "wide"^^xsd:float .',
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_inconsistent(fault: str) -> None:
    graph = read(HOUSEHOLD_TTL)
    graph.parse(data=PREFIXES + FAULTS[fault], format="turtle")
    forget_unused_classes(graph)
    assert close(graph)
