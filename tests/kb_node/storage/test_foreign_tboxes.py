"""Maps can use TBoxes written in the style of other projects. Each is represented by a small example."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.documents.tbox import tbox_notes
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.seed import seed
from semmap.ontology import vocabulary as v
from tests.data import data_folder
from tests.kb_node.home import transaction

TURTLE = f"""
@prefix owl: <{v.OWL}> . @prefix rdf: <{v.RDF}> . @prefix rdfs: <{v.RDFS}> . @prefix xsd: <{v.XSD}> .
@prefix : <http://x.org/o#> . @prefix skos: <http://www.w3.org/2004/02/skos/core#> .
@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix voaf: <http://purl.org/vocommons/voaf#> .
"""
MANNERS = {
    "schema.org: only rdfs:Class": """
        :Thing a rdfs:Class ; rdfs:label "Thing" . :Place a rdfs:Class ; rdfs:subClassOf :Thing .
        :name a rdf:Property ; :domainIncludes :Thing ; :rangeIncludes :Text .
        :Text a :DataType , rdfs:Class . :True a :Boolean . :Boolean a rdfs:Class , :DataType .
        :DataType a rdfs:Class ; rdfs:subClassOf rdfs:Class .""",
    "SSN: a slash and a Vocabulary": """
        <http://x.org/ssn/> a owl:Ontology , voaf:Vocabulary ; owl:imports <http://x.org/sosa/> .
        <http://x.org/ssn/System> a rdfs:Class , owl:Class ; rdfs:subClassOf
          [ a owl:Restriction ; owl:onProperty <http://x.org/ssn/hasSubSystem> ;
          owl:allValuesFrom <http://x.org/ssn/System> ] .
        <http://x.org/ssn/hasSubSystem> a owl:ObjectProperty ;
          <http://x.org/domainIncludes> <http://x.org/ssn/System> .
        voaf:Vocabulary a owl:Class .""",
    "Brick: classes that are shapes and individuals": """
        <http://x.org/o> a owl:Ontology . :Equipment a owl:Class , sh:NodeShape ;
          skos:definition "what works"@en .
        :Fan a owl:Class , sh:NodeShape ; rdfs:subClassOf :Equipment ; :hasAssociatedTag :FanTag ;
          sh:rule [ a sh:TripleRule ; sh:object :FanTag ; sh:predicate :hasTag ; sh:subject sh:this ] .
        :FanTag a :Tag . :Tag a owl:Class . :hasTag a owl:ObjectProperty .
          :hasAssociatedTag a owl:ObjectProperty .""",
    "BFO: annotated axioms and many annotations": """
        <http://x.org/o> a owl:Ontology ; owl:versionIRI <http://x.org/2> . :Entity a owl:Class .
        :Object a owl:Class ; rdfs:subClassOf :Entity ; :elucidation "an object"@en .
          :elucidation a owl:AnnotationProperty .
        [] a owl:Axiom ; owl:annotatedSource :Object ; owl:annotatedProperty :elucidation ;
          owl:annotatedTarget "an object"@en ; rdfs:seeAlso <http://x.org/axiom> ;
          :note "(forall (x) (if ...))" .
        :partOf a owl:ObjectProperty , owl:TransitiveProperty ; owl:inverseOf :hasPart .
          :hasPart a owl:ObjectProperty .""",
    "oro: top properties, odd datatypes": """
        <http://x.org/o> a owl:Ontology . owl:topObjectProperty a owl:ObjectProperty .
        owl:topDataProperty a owl:DatatypeProperty . :Agent a owl:Class . :knows a owl:ObjectProperty ;
          rdfs:subPropertyOf owl:topObjectProperty ; rdfs:domain :Agent ; rdfs:range rdfs:Resource .
        :birthday a owl:DatatypeProperty ; rdfs:subPropertyOf owl:topDataProperty ; rdfs:range xsd:gDay .
        :lasts a owl:DatatypeProperty ; rdfs:range xsd:duration .""",
    "pizza: defined, covered and closed classes": """
        <http://x.org/o> a owl:Ontology . :Food a owl:Class . :Topping a owl:Class ; rdfs:subClassOf :Food .
        :Pizza a owl:Class ; rdfs:subClassOf :Food , [ a owl:Restriction ; owl:onProperty :has ;
          owl:someValuesFrom :Topping ] ;
          owl:disjointWith :Topping . :has a owl:ObjectProperty , owl:InverseFunctionalProperty .
        :Spicy a owl:Class ; owl:equivalentClass [ a owl:Class ; owl:intersectionOf ( :Pizza
          [ a owl:Restriction ; owl:onProperty :has ; owl:someValuesFrom :Hot ] ) ] .
        :Hot a owl:Class ; owl:equivalentClass [ a owl:Class ; owl:unionOf ( :Mild :Fierce ) ] .
          :Mild a owl:Class .
        :Fierce a owl:Class . [] a owl:AllDisjointClasses ; owl:members ( :Mild :Fierce :Pizza ) .
        :America a owl:NamedIndividual , owl:Thing .""",
}


def opened(data):
    return SemanticMap(Journal(data / FILENAME))


@pytest.mark.parametrize("manner", MANNERS)
def test_a_map_can_be_created_and_continued(tmp_path, manner):
    (tmp_path / "o.ttl").write_text(TURTLE + MANNERS[manner])
    seed(tmp_path / "data", tmp_path / "o.ttl", None)
    semantic_map = opened(tmp_path / "data")
    assert semantic_map.reasoner.not_incremental is None
    class_ = next(iter(semantic_map.classes.names))
    semantic_map.commit(transaction(1, [("<urn:i>", v.RDF_TYPE, class_)]))
    held = set(semantic_map.reasoner.types("<urn:i>"))
    semantic_map._journal.close()
    again = opened(tmp_path / "data")
    assert again.reasoner.types("<urn:i>") == held >= {class_}
    assert again.reasoner.not_incremental is None
    again._journal.close()


def test_missing_imports_are_kept_after_a_restart(tmp_path):
    (tmp_path / "o.ttl").write_text(TURTLE + MANNERS["SSN: a slash and a Vocabulary"])
    seed(tmp_path / "data", tmp_path / "o.ttl", None)
    for _ in range(2):
        semantic_map = opened(tmp_path / "data")
        said = tbox_notes.notes(semantic_map.tbox, semantic_map.reasoner, semantic_map.classes)
        assert said[0] == "1 import was not found; the TBox is used without: http://x.org/sosa/"
        semantic_map._journal.close()


@pytest.mark.parametrize(
    ("file", "class_"),
    [
        pytest.param(
            "soma/SOMA-ALL.owl",
            "http://www.ease-crc.org/ont/SOMA.owl#DesignedContainer",
            marks=pytest.mark.long,
        ),
        ("soma/DUL.owl", "http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#PhysicalObject"),
        ("knowrob/knowrob.owl", "http://knowrob.org/kb/knowrob.owl#Candle"),
        ("oro/oro.owl", "http://kb.openrobots.org#Agent"),
        ("bfo/bfo-2.0.owl", "http://purl.obolibrary.org/obo/BFO_0000030"),
    ],
)
@pytest.mark.process  # not Turtle
def test_a_map_with_a_real_tbox_can_be_created_and_continued(tmp_path, file, class_):
    path = data_folder() / "ontologies" / file
    if not path.exists():
        pytest.skip(f"there is no {path}")
    seed(tmp_path, path, None)
    semantic_map = opened(tmp_path)
    assert semantic_map.reasoner.not_incremental is None
    assert v.iri(class_) in semantic_map.classes.names
    semantic_map.commit(transaction(1, [("<urn:i>", v.RDF_TYPE, v.iri(class_))]))
    held = semantic_map.reasoner.types("<urn:i>")
    semantic_map._journal.close()
    again = opened(tmp_path)
    assert again.reasoner.types("<urn:i>") == held
    again._journal.close()
