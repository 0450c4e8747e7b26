import pyoxigraph
import pytest
from msgspec import structs

from semmap.nodes.extern.web.views.class_details import (
    axiom_sentences,
    axioms_query,
    clash_sentence,
    class_details,
    class_names,
    class_options,
    is_unsatisfiable,
    users_query,
)
from semmap.nodes.extern.web.views.proof_lines import words_of
from semmap.nodes.kb_node.proofs import to_error
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import PropertyInfo
from tests.extern.web.views.sample_maps import by_name, class_, thing

CUP, MUG, VESSEL, THING = (
    class_("Cup", "Vessel", comment="For drinks."),
    class_("Mug", "Cup"),
    class_("Vessel", "Thing"),
    class_("Thing"),
)
TTL = """
@prefix : <%s> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
:Cup rdfs:subClassOf :Vessel, [ a owl:Restriction ; owl:onProperty :holds ; owl:allValuesFrom :Drink ] ;
  owl:disjointWith :Book ; rdfs:label "cup" .
:Vessel rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :madeOf ; owl:hasValue :clay ] .
:Set owl:equivalentClass [ owl:intersectionOf ( :Thing [ owl:unionOf ( :Cup :Mug ) ] ) ] .
"""


def _parse(turtle):
    prefixes = f"@prefix : <{v.TBOX}> . @prefix owl: <{v.OWL}> . @prefix rdfs: <{v.RDFS}> .\n"
    quads = pyoxigraph.parse((prefixes + turtle).encode(), format=pyoxigraph.RdfFormat.TURTLE)
    return {tuple(str(term) for term in quad.triple) for quad in quads}


def property_(name, **fields):
    return PropertyInfo(name=name, iri=name, kind="object", functional=False, labels={}, values={}, **fields)


@pytest.fixture(scope="module")
def ask():
    store = pyoxigraph.Store()
    store.load((TTL % v.TBOX).encode(), format=pyoxigraph.RdfFormat.TURTLE)
    prefixes = {"owl": v.OWL, "rdf": v.RDF, "rdfs": v.RDFS}
    return lambda query: list(store.query(query, prefixes=prefixes))


def sentences(ask, class_, superclasses=()):
    rows = ask(axioms_query(class_.iri))
    triples = [(str(row.subject), str(row.predicate), str(row.object)) for row in rows]
    return axiom_sentences(triples, map(v.dm, superclasses), words_of((), ()))


def test_axioms_are_those_of_the_class_itself(ask):
    assert sentences(ask, CUP, ["Vessel"]) == (
        "every Cup holds only something that is a Drink",
        "nothing is both a Cup and a Book",
    )
    assert sentences(ask, VESSEL) == ("every Vessel is made of clay",)
    assert sentences(ask, MUG) == ()


def test_users_mention_the_class_in_an_anonymous_class(ask):
    classes = [CUP, MUG, VESSEL, class_("Set")]
    rows = [[str(term) for term in row] for row in ask(users_query(CUP.iri))]
    assert class_names(rows, classes) == ("Set",)
    assert ask(users_query(VESSEL.iri)) == []


def test_a_class_has_its_neighbours_properties_and_entities():
    classes = {c.name: c for c in (CUP, MUG, VESSEL, THING)}
    classes["Cup"] = class_("Cup", "Vessel", comment="For drinks.", labels={"en": "cup"})
    held = property_("holds", domain=("Cup",), range=("Cup",))
    other = property_("of", domain=(), range=("Mug",))
    entities = by_name(
        thing("b"), thing("a"), thing("m", "Mug", types=("Cup", "Vessel")), thing("x", "Thing")
    )
    found = class_details("Cup", classes, [held, other], entities.values())
    assert (found.title, found.comment) == ("cup", "For drinks.")
    assert (found.superclasses, found.subclasses) == (("Vessel",), ("Mug",))
    assert found.properties == ("holds: domain and range",)
    assert (found.asserted, found.inferred) == (("a", "b"), ("m",))


def test_the_chosen_class_is_offered_even_if_it_is_not_of_physical_things():
    classes = [CUP, structs.replace(class_("Action"), spatial=False), class_("Bed")]
    assert list(class_options(classes, "")) == ["Bed", "Cup"]
    assert list(class_options(classes, "Cup")) == ["Bed", "Cup"]
    assert class_options(classes, "Action")["Action"] == "Action"
    assert "Removed" not in class_options(classes, "Removed")


ONTOLOGY = """
:Pan rdfs:subClassOf :Hot, :Cold . :Hot owl:disjointWith :Cold .
:Tool rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :size ; owl:hasValue 1 ] .
:size a owl:DatatypeProperty, owl:FunctionalProperty .
:Lid rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :closes ; owl:hasValue :pot1 ] .
:closes a owl:ObjectProperty ; rdfs:range :Hot .
"""


@pytest.mark.parametrize(
    ("name", "facts", "expected"),
    [
        ("Pan", ":new a :Pan", True),
        ("Pan", ":new a :Pan ; :size 2", True),  # the size is not part of the proof
        ("Tool", ":new a :Tool ; :size 2", False),
        ("Lid", ":pot1 a :Cold . :new a :Lid", False),  # another entity
    ],
)
def test_a_class_is_unsatisfiable_if_the_proof_uses_axioms_only(name, facts, expected):
    reasoner = Reasoner(_parse(ONTOLOGY))
    with pytest.raises(Inconsistent) as raised:
        reasoner.apply(insert=_parse(f"{facts} ."))
    known, clash = class_(name), to_error(raised.value)
    assert is_unsatisfiable(known, clash.explanation) is expected
    text = clash_sentence(known, clash, 12)
    assert text.startswith("Unsatisfiable: ") is expected
    assert text.endswith(f"cannot be added to this map (as of commit 12): {clash.text}") is not expected


def test_a_clash_without_a_proof_is_about_the_map():
    assert "to this map (as of commit 3): no" in clash_sentence(CUP, errors.Inconsistent("no"), 3)
