from itertools import groupby
from operator import itemgetter

import pytest

from semmap.nodes.kb_node.answers import answers, dry_runs
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.abox_document import filter_document
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.rules.general import GeneralEngine
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import RuleInfo
from tests.kb_node import home
from tests.kb_node.graphs import canonical
from tests.kb_node.home import chair, transaction, turtle
from tests.kb_node.reasoner.graphs import triple, triples
from tests.kb_node.reasoner.swrl import PREFIXES
from tests.kb_node.reasoner.swrl import rule as swrl_rule

SYNTAXES = ["rdfxml", "turtle", "ntriples", "jsonld"]

MAPS_OWN = (
    "only the map declares {}: nothing can be added by such classes; to add them to the TBox, load the map"
    " with --tbox-from-abox"
)


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


def names(entities):
    return [entity.name for entity in entities]


def test_listing_is_by_exact_class_name(furnished):
    assert names(answers.find_entities(furnished, None)) == ["chair1", "chair2", "kitchen1"]
    assert names(answers.find_entities(furnished, "Seat")) == ["chair1", "chair2"]
    assert answers.find_entities(furnished, "Door") == ()
    with pytest.raises(errors.UnknownClass, match="unknown class 'Saet'; did you mean Seat"):
        answers.find_entities(furnished, "Saet")


def test_infer_returns_only_inferred_facts(furnished):
    inferred = answers.infer(furnished, "kitchen1")
    assert "kitchen1 type Location" in inferred.text
    assert "chair1 type Chair" not in answers.infer_all(answers.inference_input(furnished)).text
    assert "chair1 type Seat" in answers.infer_all(answers.inference_input(furnished)).text
    with pytest.raises(errors.UnknownName):
        answers.infer(furnished, "sofa1")


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_an_export_can_replace_the_map_without_a_difference(furnished, syntax):
    document = answers.export(answers.export_snapshot(furnished, inferred=False), syntax)
    before = furnished.abox()
    assert (document.seq, document.triples) == (1, len(before))
    kept, skipped, _ = filter_document(
        rdf.parse(document.content, "export"), furnished.classes, skip_unknown=False
    )
    furnished.commit(transaction(2, kept, furnished.abox()))
    assert skipped == []
    assert canonical(furnished.abox()) == canonical(before)


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_an_export_with_inferences_can_be_loaded(furnished, syntax):
    document = answers.export(answers.export_snapshot(furnished, inferred=True), syntax)
    triples = rdf.parse(document.content, "export")
    assert set(turtle(":kitchen1 a dm:Location . :chair1 a dm:Seat .")) <= set(triples)
    assert not {v.OWL_THING, v.dm("Chair")} & {s for s, _, _ in triples}
    before = list(furnished.entities())
    kept, *_ = filter_document(triples, furnished.classes, skip_unknown=False)
    furnished.commit(transaction(2, kept, furnished.abox()))
    assert names(furnished.entities()) == names(before)


def test_an_inconsistent_map_is_not_exported():
    wrong = answers.ExportSnapshot([*home.TBOX, *turtle(":a a dm:Chair , dm:Kitchen .")], [], 0)
    with pytest.raises(errors.Inconsistent, match="inconsistent: a cannot be") as caught:
        answers.export(wrong, "turtle")
    assert caught.value.explanation is not None


def test_check_explains_an_inconsistency():
    good = answers.check([*home.TBOX, *turtle(":a a dm:Chair .")], "semmap")
    assert (good.consistent, good.text, good.explanation) == (True, "consistent", None)
    assert good.triples == len(home.TBOX) + 1
    bad = answers.check([*home.TBOX, *turtle(":a a dm:Chair , dm:Kitchen .")], "semmap")
    assert not bad.consistent
    assert bad.text.startswith("inconsistent: a cannot be")
    assert bad.explanation is not None


@pytest.mark.parametrize(("more", "consistent"), [("", True), (", dm:Kitchen", False)])
def test_owlrl_agrees(more, consistent):
    checked = answers.check([*home.TBOX, *turtle(f":a a dm:Chair {more} .")], "owlrl")
    assert (checked.consistent, checked.engine) == (consistent, "owlrl")
    assert checked.text.startswith("consistent" if consistent else "inconsistent: ")


def test_inferences_are_the_same_with_both_engines(furnished):
    """The incremental engine, and the general one for graphs that the first cannot compile."""
    compiled = (
        answers.infer_all(answers.inference_input(furnished)),
        answers.export_snapshot(furnished, inferred=True),
    )
    assert furnished.reasoner.is_compiled
    furnished.reasoner._engine = GeneralEngine(furnished.reasoner.asserted())
    assert not furnished.reasoner.is_compiled
    general = (
        answers.infer_all(answers.inference_input(furnished)),
        answers.export_snapshot(furnished, inferred=True),
    )
    assert set(general[0].triples) == set(compiled[0].triples)
    assert general[0].text == compiled[0].text
    assert set(general[1].written) == set(compiled[1].written)


def test_measured_pairs_are_inferred_and_exported(flat):
    near = {t[2] for t in answers.infer(flat, "milk1").triples if t[1] == v.dm("isNear")}
    assert v.entity_iri("stove1") in near
    assert v.entity_iri("counter1") not in near  # it supports the entity
    of_stove = answers.infer(flat, "stove1").triples
    assert (v.entity_iri("stove1"), v.dm("isNear"), v.entity_iri("milk1")) in of_stove
    assert len(set(of_stove)) == len(of_stove)
    picture = answers.export_snapshot(flat, inferred=True)
    exported = rdf.parse(answers.export(picture, "turtle").content, "export")
    in_order = answers.infer_all(answers.inference_input(flat)).triples
    assert tuple(t for t in in_order if t[0] == v.entity_iri("stove1")) == of_stove
    assert len([*groupby(in_order, key=itemgetter(0))]) == len({s for s, _, _ in in_order})
    everything = set(in_order)
    for name in ("isNear", "isNextTo", "touches", "isUnder", "isAbove"):
        found = {t for t in exported if t[1] == v.dm(name)}
        assert found == {t for t in everything if t[1] == v.dm(name)} != set()
    plain = rdf.parse(
        answers.export(answers.export_snapshot(flat, inferred=False), "turtle").content, "export"
    )
    assert not any(p == v.dm("isNear") for _, p, _ in plain)


def test_ambiguous_class_names_have_prefixes_in_inferences(tmp_path):
    other = turtle(
        "@prefix lab: <http://lab.org/lab#> . lab:Chair a owl:Class . dm:Chair rdfs:subClassOf lab:Chair ."
    )
    semantic_map = home.new_map(tmp_path, [*home.TBOX, *other])
    tried = dry_runs.dry_run(semantic_map, lambda: semantic_map.commit(transaction(1, chair("chair1"))))
    semantic_map.commit(transaction(1, chair("chair1")))
    for said in (
        tried.trial.gained,
        answers.infer(semantic_map, "chair1").text,
        answers.infer_all(answers.inference_input(semantic_map)).text,
    ):
        assert {"chair1 type lab:Chair", "chair1 type Seat"} <= set(said)
    home.close(semantic_map)


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_an_export_declares_the_classes_that_only_its_map_has(semantic_map, syntax):
    said = turtle(":chair1 a dm:Chair ; dm:hasJoint [ a :swivel ] . :swivel a owl:Class .")
    kept, _, _ = filter_document(said, semantic_map.classes, skip_unknown=False)
    semantic_map.commit(transaction(1, kept))
    document = answers.export(answers.export_snapshot(semantic_map, inferred=False), syntax)
    triples = rdf.parse(document.content, "export")
    assert len(triples) == len(set(triples)) == document.triples
    again, skipped, notes = filter_document(triples, semantic_map.classes, skip_unknown=False)
    assert canonical(again) == canonical(kept)
    assert skipped == []
    assert notes[-1] == MAPS_OWN.format("swivel")


def test_rules_are_listed_with_their_labels_and_those_without_effect_last():
    labelled = triple(':r rdfs:label "unused"@en')
    off, on = (swrl_rule(text) for text in ("Mug(x), b.stringConcat(y, x, x) -> Cup(y)", "Mug(x) -> Cup(x)"))
    rules = triples(PREFIXES + off.replace("[]", ":r", 1) + on)
    reasoner = Reasoner([*rules, labelled])
    reasoner.apply(insert=[triple(":mug1 a :Mug"), triple(":mug2 a :Mug")])
    assert list(answers.list_rules(reasoner)) == [
        RuleInfo(name="", text="if x is a Mug, then x is a Cup", holds=2),
        RuleInfo(name="unused", text="", holds=0, unsupported="unsupported built-in stringConcat"),
    ]
