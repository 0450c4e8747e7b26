"""Words of queries as terms: names, labels, prefixed names, IRIs and literals."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.answers import term_resolution
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

TBOX = (
    *home.TBOX,
    *turtle(
        'dm:Stool a owl:Class ; rdfs:label "low chair" . dm:Bench a owl:Class ; rdfs:label "low chair" .'
        "dm:count a owl:DatatypeProperty ; rdfs:range xsd:integer . dm:remark a owl:DatatypeProperty ."
        'dm:note a owl:AnnotationProperty . dm:isLocatedIn rdfs:label "is located in" .'
        "<urn:k:Kettle> a owl:Class ; rdfs:subClassOf dm:Object ."
        "dm:oak a dm:Wood . <urn:one#pine> a dm:Wood . <urn:two#pine> a dm:Wood ."
    ),
)
MAP = (
    ':door1 a dm:Door , owl:NamedIndividual . :chair1 dm:count 4 ; dm:remark "a, b" ; dm:isLocatedIn :here .'
)


@pytest.fixture(scope="module")
def rooms(tmp_path_factory):
    made = home.new_map(tmp_path_factory.mktemp("map"), TBOX)
    made.commit(transaction(1, [*chair(), *turtle(MAP)]))
    yield made
    home.close(made)


@pytest.mark.parametrize(
    "word", ["Chair", "dm:Chair", v.dm("Chair"), v.bare(v.dm("Chair")), "chair", "sedia"]
)
def test_a_class_has_several_words(rooms, word):
    assert term_resolution.resolve_class(rooms, word) == v.dm("Chair")


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("low chair", "'low chair' is ambiguous: Bench or Stool; say which class"),
        ("Chairr", "unknown class 'Chairr'; did you mean Chair"),
    ],
)
def test_an_unclear_class_is_an_error(rooms, word, text):
    with pytest.raises(errors.UnknownClass) as caught:
        term_resolution.resolve_class(rooms, word)
    assert caught.value.text.startswith(text)


@pytest.mark.parametrize(
    ("word", "term"),
    [
        ("<urn:any>", "<urn:any>"),
        ('"4"', '"4"'),
        ("_:b1", "_:b1"),
        ("dm:Chair", v.dm("Chair")),
        ("owl:Thing", v.OWL_THING),
        ("unknown:Chair", None),
        ("Chair", None),
        ("dm", None),
    ],
)
def test_a_term_is_written_as_such_or_with_a_known_prefix(rooms, word, term):
    assert term_resolution.parse_term(rooms, word) == term


@pytest.mark.parametrize(
    ("word", "term"),
    [
        ("chair1", v.entity_iri("chair1")),
        (":chair1", v.entity_iri("chair1")),
        ("here", v.entity_iri("here")),
        ("oak", v.dm("oak")),
        ("dm:oak", v.dm("oak")),
        ("<urn:one#pine>", "<urn:one#pine>"),
        ("urn:one#pine", "<urn:one#pine>"),
        ("Chair", v.dm("Chair")),
        ("door", v.entity_iri("door1")),  # the only one of its class
    ],
)
def test_an_individual_is_an_entity_or_something_that_the_map_or_its_tbox_names(rooms, word, term):
    assert term_resolution.resolve_individual(rooms, word) == term


@pytest.mark.parametrize(
    ("word", "error"), [("dm:nothing", errors.UnknownName), ("<urn:no>", errors.UnknownName)]
)
def test_what_the_map_does_not_mention_is_unknown(rooms, word, error):
    with pytest.raises(error):
        term_resolution.resolve_individual(rooms, word)


@pytest.mark.parametrize(
    ("word", "term"),
    [
        ("a", v.RDF_TYPE),
        ("Type", v.RDF_TYPE),
        ("sameAs", v.OWL_SAME_AS),
        ("differentfrom", v.OWL_DIFFERENT_FROM),
        ("SUBCLASSOF", v.RDFS_SUB_CLASS_OF),
        ("disjointWith", v.iri(f"{v.OWL}disjointWith")),
        ("equivalentClass", v.iri(f"{v.OWL}equivalentClass")),
        ("count", v.dm("count")),
        ("is located in", v.IS_LOCATED_IN),
        ("urnless:p", None),
        ("rdfs:seeAlso", v.iri(f"{v.RDFS}seeAlso")),
    ],
)
def test_a_property_is_a_relation_of_every_map_or_of_the_tbox(rooms, word, term):
    if term is None:
        with pytest.raises(errors.BadRequest, match="unknown property 'urnless:p'"):
            term_resolution.resolve_property(rooms, word)
    else:
        assert term_resolution.resolve_property(rooms, word) == term


@pytest.mark.parametrize(
    ("predicate", "word", "term"),
    [
        (v.RDF_TYPE, "chair", v.dm("Chair")),
        (v.RDF_TYPE, "owl:Thing", v.OWL_THING),
        (v.RDF_TYPE, "_:b1", "_:b1"),
        (v.dm("count"), "4", '"4"^^' + v.iri(f"{v.XSD}integer")),
        (v.dm("remark"), "free text", '"free text"'),
        (v.dm("note"), "free text", '"free text"'),
        (v.dm("count"), '"4"', '"4"'),
        (v.IS_LOCATED_IN, "here", v.entity_iri("here")),
        (v.IS_LOCATED_IN, "dm:oak", v.dm("oak")),
        (v.OWL_SAME_AS, "chair1", v.entity_iri("chair1")),
    ],
)
def test_a_value_is_read_by_its_property(rooms, predicate, word, term):
    assert term_resolution.resolve_value(rooms, predicate, word) == term


def test_a_value_outside_the_range_is_an_error(rooms):
    with pytest.raises(errors.BadRequest, match="count"):
        term_resolution.resolve_value(rooms, v.dm("count"), "four")


@pytest.mark.parametrize(
    ("predicate", "word", "terms"),
    [
        (v.RDF_TYPE, "chair", [v.dm("Chair")]),
        (v.dm("count"), "4", ['"4"^^' + v.iri(f"{v.XSD}integer")]),
        (v.dm("count"), "5", ['"5"^^' + v.iri(f"{v.XSD}integer")]),
        (v.dm("remark"), "a, b", ['"a, b"']),
        (v.dm("remark"), '"x"@en', ['"x"@en']),
        (v.IS_LOCATED_IN, "here", [v.entity_iri("here")]),
        (v.IS_LOCATED_IN, "door1", [v.entity_iri("door1")]),
        (v.OWL_SAME_AS, "door", [v.entity_iri("door1")]),
    ],
)
def test_a_value_that_is_held_comes_before_one_that_could_be(rooms, predicate, word, terms):
    assert term_resolution.resolve_values(rooms, v.entity_iri("chair1"), predicate, word) == terms


def test_the_name_of_a_class_is_its_only_entity_where_individuals_are_related(rooms):
    assert term_resolution.resolve_end(rooms, v.IS_LOCATED_IN, "Door") == v.entity_iri("door1")
    assert term_resolution.resolve_end(rooms, v.RDFS_SUB_CLASS_OF, "Door") == v.dm("Door")
    assert term_resolution.resolve_end(rooms, v.dm("note"), "Door") == v.dm("Door")
    assert term_resolution.resolve_end(rooms, v.dm("count"), "Door") == v.dm("Door")
    assert term_resolution.resolve_end(rooms, v.IS_LOCATED_IN, "chair1") == v.entity_iri("chair1")
