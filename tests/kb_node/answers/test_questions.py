import pytest

from semmap.nodes.kb_node.answers import questions
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.reasoner import GivenFacts, Reasoner
from semmap.nodes.kb_node.reasoner.entailment.explaining import nearby
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Could, Explain
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle
from tests.kb_node.reasoner.graphs import triple, triples


@pytest.fixture
def furnished(semantic_map):
    said = turtle(
        ":chair1 dm:isLocatedIn :kitchen1 ;"
        ' dm:hasSize [ a dm:3Three_Dim_Size ; dm:float_size_x "1.50"^^xsd:float ] .'
        ":chair2 a dm:Chair , owl:NamedIndividual ; dm:hasAlternativeReference :ref ."
        ':ref dm:lexicalReference "<&>" , "è"@it .'
    )
    semantic_map.commit(transaction(1, [*chair(preferred="two\nlines"), *said]))
    return semantic_map


def explain_relation(semantic_map, name, predicate, value, *, negated=False):
    question = Explain(name=name, predicate=predicate, value=value, negated=negated)
    return questions.explain(semantic_map.reasoner, questions.parse_explain(semantic_map, question))


def answered(semantic_map, name, predicate, value):
    question = Could(name=name, predicate=predicate, value=value)
    return questions.could(semantic_map.reasoner, questions.parse_could(semantic_map, question))


@pytest.mark.parametrize(
    ("name", "predicate", "value", "support"),
    [
        ("chair1", "a", "Chair", {"chair1 type Chair"}),
        ("chair1", "type", "Seat", {"chair1 type Chair", "Chair subClassOf Seat"}),
        ("chair1", "rdf:type", "dm:Seat", {"chair1 type Chair", "Chair subClassOf Seat"}),
        ("kitchen1", "a", "Location", {"chair1 isLocatedIn kitchen1", "isLocatedIn range Location"}),
        ("chair1", "isLocatedIn", "kitchen1", {"chair1 isLocatedIn kitchen1"}),
        (":chair1", "a", "Chair", {"chair1 type Chair"}),
        (v.entity_iri("chair1"), "a", "Chair", {"chair1 type Chair"}),
        (
            "chair1_preferred_reference",
            "lexicalReference",
            "two\nlines",
            {"chair1_preferred_reference lexicalReference two\nlines"},
        ),
        ("Chair", "rdfs:subClassOf", "dm:Object", {"Chair subClassOf Seat", "Seat subClassOf Object"}),
        ("chair1", "dm:isLocatedIn", ":kitchen1", {"chair1 isLocatedIn kitchen1"}),
        ("chair1", v.IS_LOCATED_IN, v.entity_iri("kitchen1"), {"chair1 isLocatedIn kitchen1"}),
    ],
)
def test_explain_returns_the_supporting_facts(furnished, name, predicate, value, support):
    explanation = explain_relation(furnished, name, predicate, value)
    assert {v.to_words(triple) for triple in explanation.support} == support


@pytest.mark.parametrize(
    ("name", "predicate", "value", "error", "text"),
    [
        ("sofa1", "a", "Chair", errors.UnknownName, "label or class 'sofa1'"),
        ("chair1", "a", "Chiar", errors.UnknownClass, "unknown class 'Chiar'; did you mean Chair"),
        ("chair1", "isLocatedAt", "kitchen1", errors.BadRequest, "'isLocatedAt'; did you mean isLocatedIn"),
        (
            "chair1",
            "xyz",
            "kitchen1",
            errors.BadRequest,
            "'xyz'; use type or a property of the TBox",
        ),
        (
            "chair1",
            "a",
            "Door",
            errors.Refused,
            "it does not hold that chair1 is a Door, and nothing excludes it",
        ),
        (
            "chair1",
            "isLocatedIn",
            "chair2",
            errors.Refused,
            "it does not hold: chair1 is not located in chair2, because chair2 is a chair",
        ),
    ],
)
def test_statements_that_cannot_be_explained_are_rejected(furnished, name, predicate, value, error, text):
    with pytest.raises(error, match=text):
        explain_relation(furnished, name, predicate, value)


def test_two_individuals_are_different_although_no_rule_derives_it(furnished):
    explanation = explain_relation(furnished, "chair1", "differentFrom", "kitchen1")
    assert explanation.conclusion == (v.entity_iri("chair1"), v.OWL_DIFFERENT_FROM, v.entity_iri("kitchen1"))
    assert explanation.supposed == (v.entity_iri("chair1"), v.OWL_SAME_AS, v.entity_iri("kitchen1"))
    assert explanation.text.startswith(
        "chair1 is different from kitchen1, because chair1 is located in kitchen1 "
    )
    assert "nothing is both a Location and an Object" in explanation.text
    with pytest.raises(errors.Refused, match="that chair1 is different from chair2, and nothing excludes it"):
        explain_relation(furnished, "chair1", "differentFrom", "chair2")


def test_a_value_may_be_an_individual_of_another_namespace(tmp_path):
    lab = """
        @prefix lab: <http://example.org/lab#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
        <http://example.org/lab> a owl:Ontology . lab:Person a owl:Class .
        lab:likes a owl:ObjectProperty . lab:ann a lab:Person . lab:bob a lab:Person .
        [] a owl:NegativePropertyAssertion ; owl:sourceIndividual lab:ann ;
            owl:assertionProperty lab:likes ; owl:targetIndividual lab:bob .
    """
    semantic_map = home.new_map(tmp_path, rdf.parse(lab.encode(), "lab.ttl", label_prefix="t"))
    told = "ann does not like bob (asserted)."
    assert explain_relation(semantic_map, "ann", "likes", "bob", negated=True).text == told
    assert answered(semantic_map, "ann", "likes", "bob").text == f"no: {told}"
    home.close(semantic_map)


def test_a_refutation_without_a_rule_is_searched_on_a_copy():
    reasoner = Reasoner(
        triples(
            ":Person owl:equivalentClass [ owl:unionOf ( :Adult :Child ) ] ."
            ":Robot owl:disjointWith :Adult , :Child . :knows a owl:ReflexiveProperty ."
            ":ann a :Person . :bob a :Adult ."
        )
    )
    robot, other = triple(":ann a :Robot"), triple(":ann a :Child")
    with pytest.raises(questions.Undecided):
        questions.explain(reasoner, questions.StatementQuestion((robot,), negated=True), recompute=False)
    found = questions.explain(reasoner, questions.StatementQuestion((robot,), negated=True))
    assert found.text.startswith("ann is not a Robot, because it is a Person (asserted), ")
    assert (found.conclusion, found.supposed) == (None, robot)
    with pytest.raises(errors.Refused, match="it does not hold: ann is not a Robot, because") as refused:
        questions.explain(reasoner, questions.StatementQuestion((robot,)))
    assert refused.value.explanation == found
    with pytest.raises(errors.Refused, match="it is not known that ann is a Child, but nothing excludes it"):
        questions.explain(reasoner, questions.StatementQuestion((other,), negated=True))
    with pytest.raises(errors.Refused, match="it holds: ann knows itself, because everything knows itself"):
        questions.explain(reasoner, questions.StatementQuestion((triple(":ann :knows :ann"),), negated=True))


def test_an_ambiguous_statement_holds_if_one_of_its_meanings_does():
    reasoner = Reasoner(triples(":ann :knows :bob . :bob a :Adult . :carl a :Adult ."))
    meanings = tuple(triple(f":ann :knows :{name}") for name in ("carl", "dora", "bob"))
    asked = questions.StatementQuestion(meanings)
    assert asked.terms == (meanings[0][0], *(o for _, _, o in meanings))
    assert questions.explain(reasoner, asked).conclusion == meanings[2]
    with pytest.raises(errors.Refused, match="it does not hold that ann knows carl, and nothing excludes it"):
        questions.explain(reasoner, questions.StatementQuestion(meanings[:2]))
    with pytest.raises(errors.Refused, match="it is not known that ann knows carl, but nothing excludes it"):
        questions.explain(reasoner, questions.StatementQuestion(meanings, negated=True))


def test_a_negative_statement_is_explained(furnished):
    explanation = explain_relation(furnished, "chair1", "type", "Kitchen", negated=True)
    assert (explanation.conclusion, explanation.supposed[1:]) == (None, (v.RDF_TYPE, v.dm("Kitchen")))
    assert explanation.text.startswith("chair1 is not a Kitchen, because it is a chair (asserted), ")
    assert not {explanation.supposed} & set(explanation.support)
    with pytest.raises(
        errors.Refused, match="it is not known that chair1 is a Door, but nothing excludes it"
    ):
        explain_relation(furnished, "chair1", "type", "Door", negated=True)
    with pytest.raises(errors.Refused, match="it holds: chair1 is a Seat, because it is a chair"):
        explain_relation(furnished, "chair1", "type", "Seat", negated=True)


def test_a_computed_fact_that_is_denied_is_called_measured(furnished):
    computed = (v.entity_iri("chair2"), v.IS_LOCATED_IN, v.entity_iri("kitchen1"))
    furnished.reasoner.update_computed(add=[computed])
    with pytest.raises(errors.Refused, match=r"it holds: chair2 is located in kitchen1 \(measured\)"):
        explain_relation(furnished, "chair2", "isLocatedIn", "kitchen1", negated=True)


@pytest.mark.parametrize(
    ("question", "possible", "text"),
    [
        (("chair1", "type", "Door"), True, "yes: nothing excludes that chair1 is a Door"),
        (("chair1", "type", "Seat"), True, "yes: chair1 is a Seat already"),
        (("chair1", "type", "Kitchen"), False, "no: chair1 is not a Kitchen, because it is a chair"),
        (("chair1", "isLocatedIn", "chair2"), False, "no: chair1 is not located in chair2, because"),
        (
            ("chair2", "isLocatedIn", "kitchen1"),
            True,
            "yes: nothing excludes that chair2 is located in kitchen1",
        ),
        (("chair1", "sameAs", "chair2"), True, "yes: nothing excludes that chair1 is the same as chair2"),
        (("chair1", "SameAs", "kitchen1"), False, "no: chair1 is different from kitchen1, because"),
        (
            ("kitchen1", "differentFrom", "chair1"),
            True,
            "yes: nothing excludes that kitchen1 is different from",
        ),
        (("kitchen1", "differentFrom", "kitchen1"), False, "no: kitchen1 is the same as kitchen1."),
        (
            ("ref", "lexicalReference", "a text"),
            True,
            'yes: nothing excludes that ref has lexical reference "a text"',
        ),
    ],
)
def test_possible_and_impossible_statements(furnished, question, possible, text):
    before = set(furnished.reasoner.asserted()), set(furnished.reasoner.inferred())
    answer = answered(furnished, *question)
    assert (answer.possible, answer.text[: len(text)]) == (possible, text)
    assert (answer.explanation is None) == possible
    assert (set(furnished.reasoner.asserted()), set(furnished.reasoner.inferred())) == before


@pytest.mark.parametrize(
    ("question", "error", "text"),
    [
        (("sofa1", "type", "Chair"), errors.UnknownName, "'sofa1'"),
        (("chair1", "isLocatedIn", "sofa1"), errors.UnknownName, "label or class 'sofa1'"),
        (("chair1", "isLocatedAt", "kitchen1"), errors.BadRequest, "did you mean isLocatedIn"),
        (("chair1", "same", "kitchen1"), errors.BadRequest, "use type or a property of the TBox"),
        (("chair1", "type", "Chiar"), errors.UnknownClass, "did you mean Chair"),
        (
            ("chair1_coordinates", "float_coordinates_x", "left"),
            errors.BadRequest,
            "float_coordinates_x takes a number, not 'left'",
        ),
    ],
)
def test_invalid_statements_are_rejected(furnished, question, error, text):
    with pytest.raises(error, match=text):
        answered(furnished, *question)


def test_implied_equalities_are_reported(tmp_path):
    semantic_map = home.new_map(
        tmp_path, (*home.TBOX, *turtle("dm:isPartOf a owl:ObjectProperty , owl:FunctionalProperty ."))
    )
    semantic_map.commit(
        transaction(1, turtle(":leg a dm:Object ; dm:isPartOf :a . :a a dm:Object . :b a dm:Object ."))
    )
    answer = answered(semantic_map, "leg", "isPartOf", "b")
    assert answer.text == "yes: nothing excludes that leg is part of b; but then b is the same as a"
    home.close(semantic_map)


def test_a_slow_test_does_not_use_the_reasoner_of_the_map(furnished):
    crowd = "".join(f":thing{n} a dm:Door ; dm:isLocatedIn :kitchen1 ." for n in range(questions._QUICK + 1))
    ask = Could(name="kitchen1", predicate="sameAs", value="chair2")
    assert questions.is_quick(furnished.reasoner, questions.parse_could(furnished, ask))
    furnished.commit(transaction(2, turtle(crowd)))
    asked = questions.parse_could(furnished, ask)
    assert not questions.is_quick(furnished.reasoner, asked)
    beside = Reasoner(furnished.reasoner.asserted())
    assert questions.could(beside, asked).text == questions.could(furnished.reasoner, asked).text
    classes = questions.parse_could(furnished, Could(name="Chair", predicate="sameAs", value="Door"))
    with pytest.raises(NotCompilable):
        questions.could(furnished.reasoner, classes, recompute=False)


@pytest.mark.parametrize(
    ("question", "text"),
    [
        (("Chair", "disjointWith", "Kitchen"), "nothing is both a chair and a Kitchen, because "),
        (
            ("chair1", "owl:topObjectProperty", "kitchen1"),
            "chair1 has top object property kitchen1 (axiomatic).",
        ),
        (("Chair", "subClassOf", "Object"), "every chair is an Object, because "),
        (("chair1", "type", "owl:Thing"), "chair1 is something"),
    ],
)
def test_a_statement_without_a_rule_is_explained_by_a_proof(furnished, question, text):
    assert explain_relation(furnished, *question).text.startswith(text)


def test_a_proof_is_not_searched_in_the_reasoner_of_the_map(furnished):
    asked = questions.parse_explain(
        furnished, Explain(name="Chair", predicate="disjointWith", value="Kitchen")
    )
    with pytest.raises(NotCompilable):
        questions.explain(furnished.reasoner, asked, recompute=False)
    asked = questions.parse_explain(furnished, Explain(name="chair1", predicate="type", value="Door"))
    with pytest.raises(questions.Undecided):
        questions.explain(furnished.reasoner, asked, recompute=False)
    beside = questions.copy_reasoner(
        GivenFacts(nearby(furnished.reasoner, asked.terms), []), furnished.classes.prefixed
    )
    with pytest.raises(
        errors.Refused, match="it does not hold that chair1 is a Door, and nothing excludes it"
    ):
        questions.explain(beside, asked)


def test_ambiguous_class_names_have_prefixes_in_sentences(tmp_path):
    twin = turtle('<http://a.org/lab.owl#Seat> a owl:Class ; rdfs:label "chair"@en .')
    semantic_map = home.new_map(tmp_path, (*home.TBOX, *twin))
    semantic_map.commit(transaction(1, turtle(":chair1 a dm:Chair . :a a <http://a.org/lab.owl#Seat> .")))
    said = explain_relation(semantic_map, "chair1", "type", "dm:Seat").text
    assert said == "chair1 is a Seat, because it is a dm:Chair (asserted), and every dm:Chair is a Seat."
    copied = questions.copy_reasoner(semantic_map.reasoner.given_facts(), semantic_map.classes.prefixed)
    asked = questions.parse_explain(semantic_map, Explain(name="a", predicate="type", value="lab:Seat"))
    assert questions.explain(copied, asked).text == "a is a lab:Seat (asserted)."
    home.close(semantic_map)


def test_sentences_have_the_names_of_the_map_and_the_individual_that_was_named(tmp_path):
    semantic_map = home.new_map(tmp_path)
    same = "<urn:x#4711> a dm:Chair . <urn:x#m1> owl:sameAs <urn:x#m2> . <urn:x#m2> owl:sameAs <urn:x#4711> ."
    semantic_map.commit(transaction(1, turtle(same)))
    assert explain_relation(semantic_map, "_4711", "type", "Seat").text.startswith("_4711 is a Seat, because")
    semantic_map.commit(transaction(2, turtle("<urn:y#4712> a dm:Chair .")))  # a proof of the same shape
    assert explain_relation(semantic_map, "_4712", "type", "Seat").text.startswith("_4712 is a Seat, because")
    said = explain_relation(semantic_map, "m1", "sameAs", "_4711").text
    assert said.startswith("m1 is the same as _4711, because m1 is the same as m2 (asserted)")
    home.close(semantic_map)
