"""The format number must grow with every change of inferences or of their layout."""

from __future__ import annotations

import hashlib
import re

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.entities.entity_reading import read_entity
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.abox.columns import Columns, KindSaid
from semmap.nodes.kb_node.reasoner.rules import facts
from semmap.nodes.kb_node.reasoner.rules.rule_table import TABLE
from semmap.nodes.kb_node.storage.conclusions_format import FORMAT
from semmap.nodes.kb_node.storage.journal import Checkpoint
from semmap.ontology import vocabulary as v
from semmap.schemas import codec
from semmap.schemas.entities import Entity, Pose, Provenance

DIGESTS = {
    "rules": "c7b28fd4106c7f0f",
    "layouts": "b2f3f0cabe78dbca",
    "closure": "9984797e89890a87",
    "entities": "9506490bdc8935d2",
    "columns": "e81c087c96f15110",
}
"""The digests of the current format. If one of them changes, add 1 to FORMAT and store the new digests."""

PREFIXES = """
@prefix : <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_1#> .
@prefix dm: <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
TBOX = f"""{PREFIXES}
dm:Physical_Thing a owl:Class . dm:Object a owl:Class ; rdfs:subClassOf dm:Physical_Thing .
dm:Location a owl:Class ; rdfs:subClassOf dm:Physical_Thing ; owl:disjointWith dm:Object .
dm:Container a owl:Class ; rdfs:subClassOf dm:Object ; dm:model "crate" ; rdfs:label "container"@en .
dm:Cup a owl:Class ; owl:equivalentClass [ owl:intersectionOf ( dm:Container
  [ a owl:Restriction ; owl:onProperty dm:holds ; owl:someValuesFrom dm:Drink ] ) ] .
dm:Drink a owl:Class ; rdfs:subClassOf [ owl:unionOf ( dm:Object dm:Location ) ] .
dm:Heavy a owl:Class ; rdfs:subClassOf dm:Object ,
  [ a owl:Restriction ; owl:onProperty dm:holds ; owl:maxCardinality 1 ] ,
  [ a owl:Restriction ; owl:onProperty dm:holds ; owl:allValuesFrom dm:Drink ] .
dm:holds a owl:ObjectProperty ; rdfs:domain dm:Container ; rdfs:range dm:Object ; owl:inverseOf dm:isIn .
dm:isIn a owl:ObjectProperty , owl:FunctionalProperty ; rdfs:subPropertyOf dm:isAt .
dm:isAt a owl:ObjectProperty , owl:TransitiveProperty ; owl:equivalentProperty dm:isNear .
dm:isNear a owl:ObjectProperty ; owl:propertyChainAxiom ( dm:isIn dm:isAt ) .
dm:hasPosition a owl:ObjectProperty ; rdfs:domain dm:Physical_Thing .
dm:hasCode a owl:DatatypeProperty ; rdfs:range xsd:integer . dm:Cup owl:hasKey ( dm:hasCode ) .
"""
ABOX = f"""{PREFIXES}
:crate1 a dm:Container ; dm:holds :juice1 ; dm:hasPosition :crate1_at ; dm:hasPreferredReference :crate1_ref .
:crate1_at dm:float_coordinates_x "1.0"^^xsd:float ; dm:float_coordinates_y "2.0"^^xsd:float ;
  dm:float_coordinates_z "0.5"^^xsd:float .
:crate1_ref dm:lexicalReference "crate" .
:juice1 a dm:Drink , dm:Heavy ; rdfs:label "juice"@en , "succo"@it .
"""
_BLANK = re.compile(r"_:\w+")
BY = Provenance(commit=1, stamp_ns=1, source="file")


def test_the_format_changes_with_inferences_and_layout():
    reasoner = Reasoner(rdf.parse(TBOX.encode(), "t.ttl", label_prefix="t"))
    assert reasoner.closed is not None
    closed = sorted(_unlabelled(" ".join(fact)) for fact in reasoner.closed.facts)
    classes = ClassTable(reasoner)
    reasoner.apply(insert=rdf.parse(ABOX.encode(), "a.ttl"))
    iris = (v.entity_iri(name) for name in ("crate1", "juice1"))
    entities = [codec.encode(read_entity(reasoner, classes, iri, BY)).hex() for iri in iris]
    found = {
        "rules": digest(" ".join(line.split()) for line in TABLE.strip().splitlines()),
        "layouts": digest(
            map(layout, (facts._Packed, Checkpoint, Columns, KindSaid, Entity, Pose, Provenance))
        ),
        "closure": digest(closed),
        "entities": digest(entities),
        "columns": digest(sorted(map(_unlabelled, stored(reasoner.columns())))),
    }
    assert (FORMAT, found) == (13, DIGESTS), "add 1 to FORMAT, and write the digests down here"


def _unlabelled(text):
    return _BLANK.sub("_:", text)


def digest(lines):
    return hashlib.blake2b("\n".join(lines).encode(), digest_size=8).hexdigest()


def stored(columns):
    """Return the contents of columns: nodes with their classes, and edges with their sources."""
    for term, number in zip(columns.terms, columns.kind, strict=True):
        classes = sorted(_unlabelled(columns.classes[cls]) for cls in columns.kinds[number].classes)
        if term and columns.kinds[number].excluded is None:
            yield f"{term} {classes}"
    edges = zip(columns.subject, columns.predicate, columns.object, columns.source, strict=True)
    for s, p, o, source in edges:
        if p >= 0:
            yield f"{columns.terms[s]} {columns.properties[p]} {columns.terms[o]} {source}"


def layout(struct):
    """Return the fields of a struct with their types."""
    return " ".join(f"{name}:{kind}" for name, kind in struct.__annotations__.items())
