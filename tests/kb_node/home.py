"""A small household TBox, and maps that use it."""

import functools
from pathlib import Path
from tempfile import TemporaryDirectory

from semmap.nodes.kb_node import planning
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.ontology import HOUSEHOLD_TTL, entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Transaction
from semmap.schemas.entities import Pose
from semmap.schemas.explanations import Triple

PREFIXES = f"""
@prefix : <{v.ABOX}> .
@prefix dm: <{v.TBOX}> .
@prefix owl: <{v.OWL}> .
@prefix rdfs: <{v.RDFS}> .
@prefix xsd: <{v.XSD}> .
"""
TBOX_TURTLE = (
    PREFIXES
    + """
<http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model> a owl:Ontology .
dm:Physical_Thing a owl:Class .
dm:Object a owl:Class ; rdfs:subClassOf dm:Physical_Thing ; dm:model "box" .
dm:Seat a owl:Class ; rdfs:subClassOf dm:Object .
dm:Chair a owl:Class ; rdfs:subClassOf dm:Seat ;
    rdfs:label "chair"@en , "sedia"@it ; rdfs:comment "To sit on." ; dm:model "chair" .
dm:Door a owl:Class ; rdfs:subClassOf dm:Object ; dm:fixed true .
dm:Location a owl:Class ; rdfs:subClassOf dm:Physical_Thing .
dm:Kitchen a owl:Class ; rdfs:subClassOf dm:Location .
dm:Location owl:disjointWith dm:Object .
dm:Property a owl:Class .
dm:Coordinates a owl:Class ; rdfs:subClassOf dm:Property .
dm:3Three_Dim_Size a owl:Class ; rdfs:subClassOf dm:Property .
dm:PreferredReference a owl:Class ; rdfs:subClassOf dm:Property .
dm:AlternativeReference a owl:Class ; rdfs:subClassOf dm:Property .
dm:Property owl:disjointWith dm:Physical_Thing .
dm:hasPosition a owl:ObjectProperty ; rdfs:domain dm:Physical_Thing .
dm:hasSize a owl:ObjectProperty .
dm:hasPreferredReference a owl:ObjectProperty .
dm:hasAlternativeReference a owl:ObjectProperty .
dm:isLocatedIn a owl:ObjectProperty ; rdfs:range dm:Location .
dm:lexicalReference a owl:DatatypeProperty .
dm:float_coordinates_x a owl:DatatypeProperty ; rdfs:range xsd:float .
"""
)
TBOX = rdf.parse(TBOX_TURTLE.encode(), "tbox.ttl", label_prefix="t")


def new_map(folder: Path, tbox=TBOX) -> SemanticMap:
    """Return an empty map with a new journal in `folder`."""
    return SemanticMap(Journal.create(folder / FILENAME, rdf.serialise(tbox, "ntriples")))


@functools.cache
def household() -> frozenset[Triple]:
    """Return the shipped TBox."""
    return frozenset(rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household.ttl", label_prefix="t"))


@functools.cache
def _household_closure() -> tuple[str, bytes]:
    """Return name and content of the file with its cached closure."""
    with TemporaryDirectory() as name:
        close(new_map(folder := Path(name), household()))
        (closure,) = folder.glob("*.closure")
        return closure.name, closure.read_bytes()


def new_household_journal(folder: Path) -> Journal:
    """Return a new journal in `folder` with the shipped TBox and its cached closure."""
    name, closure = _household_closure()
    (folder / name).write_bytes(closure)
    return Journal.create(folder / FILENAME, rdf.serialise(household(), "ntriples"))


def reopened(semantic_map: SemanticMap) -> SemanticMap:
    """Return the same map after a restart."""
    path = semantic_map._journal.path
    semantic_map._journal.close()
    return SemanticMap(Journal(path))


def close(semantic_map: SemanticMap) -> None:
    """Close the journal."""
    semantic_map._journal.close()


def turtle(text: str):
    """Return triples from Turtle with the usual prefixes."""
    return tuple(rdf.parse((PREFIXES + text).encode(), "test"))


def transaction(number, insert=(), retract=(), **fields):
    """Return a transaction with the command id `number`."""
    fields = {"source": "operator", **fields}
    return Transaction(id=str(number), insert=tuple(insert), retract=tuple(retract), **fields)


def restated(semantic_map: SemanticMap, number, insert):
    """Apply a commit of an older version, which accepted several poses of an entity."""
    plan = planning.Plan(retracted=(), inserted=tuple(insert), notes=())
    return semantic_map.restate(planning.make_commit(transaction(number), plan, semantic_map.seq + 1))


def chair(name="chair1", at=(1.0, 2.0, 0.0), **described):
    """Return the triples of a chair."""
    return entity_triples.describe(name, v.dm("Chair"), pose=Pose(position_m=at), **described)


def state(semantic_map: SemanticMap):
    """Return the whole state of a map."""
    return semantic_map.seq, set(semantic_map.abox()), semantic_map.snapshot()
