"""Answers of the knowledge base to requests on `semmap/bridge`: pure functions of the map."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from itertools import chain
from types import MappingProxyType
from typing import NamedTuple

from semmap.nodes.kb_node import proofs
from semmap.nodes.kb_node.answers import term_resolution
from semmap.nodes.kb_node.documents import language_tags, owl_export, rdf
from semmap.nodes.kb_node.documents.abox_document import undeclared_classes
from semmap.nodes.kb_node.documents.isolated_parser import IsolatedParser
from semmap.nodes.kb_node.owlrl.consistency_check import find_owlrl_faults
from semmap.nodes.kb_node.reasoner import GivenFacts, Inconsistent, Reasoner
from semmap.nodes.kb_node.relations.facts import contradictions
from semmap.nodes.kb_node.relations.facts.pair_facts import PairFacts
from semmap.nodes.kb_node.relations.facts.pair_properties import PairProperties
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.measuring.relation_table import PAIR_RELATIONS
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import prefixes
from semmap.ontology import vocabulary as v
from semmap.ontology.prefixes import Prefixes
from semmap.schemas import errors
from semmap.schemas.commands import RdfFormat
from semmap.schemas.entities import Entity, RuleInfo
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.replies import Checked, Document, Inferred

_COUNTING_S = 1.0
"""Time limit for counting the matches of all SWRL rules, during which the node does nothing else."""


def find_entities(semantic_map: SemanticMap, class_name: str | None) -> tuple[Entity, ...]:
    """Return the entities of a class, given by its exact name. Raises UnknownClass."""
    return tuple(
        semantic_map.entities(term_resolution.resolve_class(semantic_map, class_name) if class_name else None)
    )


def infer(semantic_map: SemanticMap, name: str) -> Inferred:
    """Return the inferred facts about an entity, including those measured on demand.

    Raises UnknownName; BadRequest for an ambiguous word.
    """
    entity = semantic_map.resolve(name)
    name = entity.name
    measured = set(
        pair_measurer(semantic_map.tbox, semantic_map.entities())(semantic_map.places.space(), name)
    )
    subject = v.iri(entity.iri)
    further = sorted(t for t in measured if t[0] == subject and not semantic_map.reasoner.holds(t))
    return _to_reply(chain(semantic_map.inferred(name), further), semantic_map.classes.qualified_names)


def list_rules(reasoner: Reasoner) -> Iterator[RuleInfo]:
    """Yield the SWRL rules of the TBox, those without effect last. Counting them takes a limited time."""
    for rule in reasoner.rules(_COUNTING_S):
        label = next((v.lexical(o) for _, _, o in reasoner.asserted(rule.node, v.RDFS_LABEL, None)), "")
        name = label or ("" if rule.node.startswith("_:") else v.local_name(rule.node))
        yield RuleInfo(
            name=name,
            text=rule.text,
            holds=rule.holds or 0,
            at_least=rule.is_cut,
            unsupported=rule.unsupported,
        )


class InferenceInput(NamedTuple):
    """The input for inference about all entities in another thread, enough to create a separate reasoner."""

    held: GivenFacts
    entities: list[Term]
    measured: Callable[[], Iterable[Triple]]
    names: Mapping[Term, str]
    """Names for classes and properties whose local names are ambiguous."""


def inference_input(semantic_map: SemanticMap) -> InferenceInput:
    """Return the current map as input for `infer_all`."""
    semantic_map.ensure_derived()
    pairs, placed, limits = (
        pair_measurer(semantic_map.tbox, semantic_map.entities()),
        semantic_map.placed(),
        semantic_map.classes.limits,
    )
    return InferenceInput(
        semantic_map.reasoner.given_facts(),
        [v.iri(entity.iri) for entity in semantic_map.entities()],
        lambda: pairs(Space(placed, limits), None),
        semantic_map.classes.qualified_names,
    )


def infer_all(given: InferenceInput) -> Inferred:
    """Return the inferred facts about all entities, one entity after another; for any thread."""
    reasoner = Reasoner.of(given.held)
    by_subject: dict[Term, set[Triple]] = {}
    for triple in given.measured():
        by_subject.setdefault(triple[0], set()).add(triple)
    triples = (
        triple
        for iri in given.entities
        for triple in chain(
            sorted(reasoner.inferred(iri, None, None)),
            sorted(t for t in by_subject.get(iri, ()) if not reasoner.holds(t)),
        )
    )
    return _to_reply(triples, given.names)


def _to_reply(triples: Iterable[Triple], names: Mapping[Term, str]) -> Inferred:
    """Return the reply, without trivial facts."""
    triples = tuple(without_trivial(triples))
    return Inferred(triples=triples, text=tuple(v.to_words(t, names) for t in triples))


def pair_measurer(
    tbox: Collection[Triple], entities: Iterable[Entity]
) -> Callable[[Space, str | None], Iterator[Triple]]:
    """Return a function that measures pairs of these entities, for all or for one name, as triples."""
    derived = PairProperties(tbox)
    iris = {entity.name: v.iri(entity.iri) for entity in entities}

    def measured(space: Space, name: str | None) -> Iterator[Triple]:
        if not derived.sources:
            return
        pairs = PairFacts(space)
        found = pairs.set_scope(PAIR_RELATIONS, ()) if name is None else pairs.set_scope((), [name])
        for fact in found.come:
            yield from derived.triples(fact, iris)

    return measured


def without_trivial(triples: Iterable[Triple]) -> Iterator[Triple]:
    """Yield the triples without facts that hold for everything, and without unnamed classes."""
    return (
        (s, p, o)
        for s, p, o in triples
        if not s.startswith('"')
        and o != v.OWL_THING
        and (p, s) != (v.OWL_SAME_AS, o)
        and not (p == v.RDF_TYPE and o.startswith("_:"))
    )


def asserted_locations(semantic_map: SemanticMap, entity: Entity | None = None) -> Iterator[Fact]:
    """Yield the asserted locations of an entity, or of all entities."""
    iri = None if entity is None else v.iri(entity.iri)
    for property_, (_, is_inverse) in contradictions.PROPERTIES.items():
        for triple in semantic_map.reasoner.asserted(
            None if is_inverse else iri, property_, iri if is_inverse else None
        ):
            if (fact := contradictions.fact_of(triple)) is not None:
                yield fact


def suppressed_facts(semantic_map: SemanticMap, entity: Entity | None = None) -> Iterator[str]:
    """Yield a sentence on each suppressed fact, or on those of one entity, and why it is suppressed."""
    derived_facts = semantic_map.derived_facts
    for fact in sorted(derived_facts.suppressed):
        if entity is None or v.iri(entity.iri) in (fact[0], fact[2]):
            yield derived_facts.describe(fact)


class ExportSnapshot(NamedTuple):
    """The map at one moment, for export in another thread: the asserted triples and those to write."""

    asserted: list[Triple]
    written: list[Triple]
    seq: int
    prefixes: Prefixes = MappingProxyType(v.PREFIXES)
    measured: Callable[[], Iterable[Triple]] = tuple
    """Measured facts about pairs. They are computed in another thread, because that takes long for large
    maps."""


def export_snapshot(semantic_map: SemanticMap, inferred: bool) -> ExportSnapshot:
    """Return the current map for export: the ABox or, if `inferred`, all that holds about its individuals."""
    semantic_map.ensure_derived()
    abox = semantic_map.abox()
    suppressed = set(semantic_map.reasoner.suppressed())
    held = [triple for triple in abox if triple not in suppressed] if suppressed else abox
    following: list[Triple] = []
    if inferred:
        abox = held
        following = inferred_triples(semantic_map.reasoner, semantic_map.tbox, abox)
    declared = [(c, v.RDF_TYPE, v.OWL_CLASS) for c in undeclared_classes(abox, semantic_map.classes)]
    written = [*abox, *following, *declared]
    used = prefixes.used_by(written, semantic_map.classes.prefixes)
    made = ExportSnapshot([*semantic_map.tbox, *held], written, semantic_map.seq, used)
    if not inferred:
        return made
    pairs, placed, limits = (
        pair_measurer(semantic_map.tbox, semantic_map.entities()),
        semantic_map.placed(),
        semantic_map.classes.limits,
    )
    return made._replace(measured=lambda: pairs(Space(placed, limits), None))


def inferred_triples(reasoner: Reasoner, tbox: Collection[Triple], abox: Collection[Triple]) -> list[Triple]:
    """Return the inferred triples about the individuals of an ABox that are not in the TBox."""
    individuals = {s for s, _, _ in abox} | {o for _, p, o in abox if p != v.RDF_TYPE}
    return [
        triple
        for individual in individuals - {s for s, _, _ in tbox}
        for triple in without_trivial(reasoner.inferred(individual, None, None))
    ]


def export(snapshot: ExportSnapshot, syntax: RdfFormat) -> Document:
    """Return the map as a document.

    Raises Inconsistent, or Refused for a text that the syntax cannot express.
    """
    checked = check(snapshot.asserted, "semmap")
    if not checked.consistent:
        raise errors.Inconsistent(checked.text, explanation=checked.explanation)
    return document(snapshot, syntax)


def document(snapshot: ExportSnapshot, syntax: RdfFormat) -> Document:
    """Return the map as a document, unchecked. Raises Refused for a text that the syntax cannot express."""
    written = snapshot.written
    if measured := set(snapshot.measured()).difference(written):
        written = [*written, *measured]
    if syntax == "functional" or syntax == "manchester":
        stated = {*written, *owl_export.declarations(written, snapshot.asserted)}
        with IsolatedParser() as writer:
            made = writer.write_owl(stated, syntax, snapshot.prefixes)
        return Document(
            content=made.content,
            media_type=rdf.MEDIA_TYPES[syntax],
            triples=len(stated) - made.lost,
            seq=snapshot.seq,
            notes=made.notes,
        )
    return Document(
        content=language_tags.restore_case(rdf.serialise(written, syntax, snapshot.prefixes), syntax),
        media_type=rdf.MEDIA_TYPES[syntax],
        triples=len(written),
        seq=snapshot.seq,
    )


def check(triples: Iterable[Triple], engine: str, is_over: Callable[[], bool] = lambda: False) -> Checked:
    """Check the consistency of triples (TBox and ABox) with a new reasoner, independent of the map's own.

    With the engine "owlrl" the check is cancelled as soon as `is_over()` returns True. Raises Refused then.
    """
    triples = list(triples)
    start = time.perf_counter()
    explanation = None
    if engine == "owlrl":
        faults = find_owlrl_faults(triples, is_over=is_over)
        reason = "; ".join(faults)
    else:
        try:
            Reasoner(triples, scattered=True)
        except Inconsistent as error:
            explanation = proofs.to_message(error.explanation)
        reason = explanation.text if explanation else ""
    return Checked(
        consistent=not reason,
        engine=engine,
        triples=len(triples),
        elapsed_s=round(time.perf_counter() - start, 4),
        text=f"inconsistent: {reason}" if reason else "consistent",
        explanation=explanation,
    )
