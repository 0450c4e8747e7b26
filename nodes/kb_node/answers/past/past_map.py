"""Past states of the map as triples, for queries and exports. For any thread."""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.answers import answers
from semmap.nodes.kb_node.derived_facts import UNCHANGED, DerivedChanges, DerivedFacts
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.abox_document import undeclared_classes
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.sparql.protocol import Placements
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.storage import closure_cache
from semmap.nodes.kb_node.storage.compaction.compaction import collect_asserted
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import prefixes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Export, Sparql
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Triple
from semmap.schemas.replies import Document
from semmap.schemas.sparql import SparqlResult


class PastMap(NamedTuple):
    """The asserted triples after commit `seq` with the TBox, and the computed and suppressed facts."""

    seq: int
    asserted: tuple[Triple, ...]
    derived_changes: DerivedChanges = UNCHANGED
    placed: tuple[PlacedEntity, ...] = ()
    limits: Thresholds | None = None
    closed: Facts | None = None
    """The closure of the TBox, if it was computed."""


def load_past_map(journal: Journal, past: HistoryReader, seq: int, *, inferred: bool) -> PastMap:
    """Return the map after a commit; with `inferred` its computed facts are derived again."""
    asserted = collect_asserted(journal, seq)
    if not inferred:
        return PastMap(seq, tuple(asserted))
    rebuilt = _rebuild(journal, past, seq, asserted)
    placed = tuple(map(PlacedEntity.of, rebuilt.there.values()))
    limits, closed = rebuilt.classes.limits, rebuilt.reasoner.closed
    return PastMap(seq, tuple(asserted), rebuilt.derived_facts.all(), placed, limits, closed)


class _RebuiltMap(NamedTuple):
    """The complete state after a commit, derived again."""

    tbox: frozenset[Triple]
    abox: set[Triple]
    reasoner: Reasoner
    classes: ClassTable
    derived_facts: DerivedFacts
    there: dict[str, Entity]


def _rebuild(journal: Journal, past: HistoryReader, seq: int, asserted: set[Triple]) -> _RebuiltMap:
    tbox = frozenset(rdf.parse(journal.tbox(seq), f"the TBox in {journal.path}"))
    reasoner = closure_cache.load_reasoner(tbox, journal.path.parent, of_the_past=True)
    classes = ClassTable(reasoner)
    derived_facts = DerivedFacts(reasoner, classes.limits)
    derived_facts.change((), asserted - tbox, lenient=True)
    entities: dict[str, Entity] = {entity.name: entity for entity in past.entities(seq)}
    derived_facts.fill(entities)
    return _RebuiltMap(tbox, asserted - tbox, reasoner, classes, derived_facts, entities)


def export_past(journal: Journal, past: HistoryReader, query: Export) -> Document:
    """Return the map as of `query.as_of` as a document. It was checked when it was committed.

    With `inferred` the inferred and measured facts are derived again with the present rules. Raises Refused
    if there was no map; BadRequest for an invalid time.
    """
    if query.as_of is None:
        raise errors.InternalError("the query has no time")
    seq = past.commit_at(query.as_of)
    if query.inferred:
        rebuilt = _rebuild(journal, past, seq, collect_asserted(journal, seq))
        return answers.document(_export_snapshot(rebuilt, seq), query.format)
    tbox = frozenset(rdf.parse(journal.tbox(seq), f"the TBox in {journal.path}"))
    abox = sorted(collect_asserted(journal, seq) - tbox)
    used = prefixes.used_by(abox, prefixes.WELL_KNOWN)
    return answers.document(answers.ExportSnapshot([*tbox], abox, seq, used), query.format)


def _export_snapshot(then: _RebuiltMap, seq: int) -> answers.ExportSnapshot:
    """Return the triples to write, including measured pairs."""
    abox = sorted(then.abox - set(then.reasoner.suppressed()))
    following = answers.inferred_triples(then.reasoner, then.tbox, abox)
    declared = [(c, v.RDF_TYPE, v.OWL_CLASS) for c in undeclared_classes(abox, then.classes)]
    written = [*abox, *following, *declared]
    measures = answers.pair_measurer(then.tbox, then.there.values())
    space = Space(tuple(map(PlacedEntity.of, then.there.values())), then.classes.limits)
    used = prefixes.used_by(written, prefixes.WELL_KNOWN)
    return answers.ExportSnapshot([*then.tbox], written, seq, used, lambda: measures(space, None))


def query_past(journal: Journal, past: HistoryReader, query: Sparql) -> SparqlResult:
    """Return the answer of a query about the map as of `query.as_of`, from a separate process.

    Raises the query's error, Refused if there was no map, BadRequest for an invalid time.
    """
    if query.as_of is None:
        raise errors.InternalError("the query has no time")
    then = load_past_map(journal, past, past.commit_at(query.as_of), inferred=query.inferred)
    service = SparqlService(
        lambda: then.asserted,
        lambda _: None,
        derived_changes=lambda: then.derived_changes,
        placements=lambda: Placements(placed=then.placed, limits=then.limits or Thresholds()),
        closed=lambda: then.closed,
    )
    try:
        return service.ask(query, then.seq).result()
    finally:
        service.close()
