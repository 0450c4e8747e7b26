"""The map as it was, triple by triple, for queries of the past: from the journal, and for any thread."""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.answers import answers
from semmap.nodes.kb_node.beliefs import UNCHANGED, Beliefs, Believed
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.abox_document import undeclared_classes
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.sparql.protocol import Surrounded
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


class MapThen(NamedTuple):
    """What was asserted after commit `seq`, the TBox with it; and what was computed and set aside."""

    seq: int
    asserted: tuple[Triple, ...]
    believed: Believed = UNCHANGED
    placed: tuple[PlacedEntity, ...] = ()
    limits: Thresholds | None = None


def map_then(journal: Journal, past: HistoryReader, seq: int, *, inferred: bool) -> MapThen:
    """The map after a commit; with `inferred` also what was computed, worked out again."""
    asserted = collect_asserted(journal, seq)
    if not inferred:
        return MapThen(seq, tuple(asserted))
    held = _held(journal, past, seq, asserted)
    placed = tuple(map(PlacedEntity.of, held.there.values()))
    return MapThen(seq, tuple(asserted), held.beliefs.all(), placed, held.classes.limits)


class _Held(NamedTuple):
    """All that held after a commit, worked out again."""

    tbox: frozenset[Triple]
    abox: set[Triple]
    reasoner: Reasoner
    classes: ClassTable
    beliefs: Beliefs
    there: dict[str, Entity]


def _held(journal: Journal, past: HistoryReader, seq: int, asserted: set[Triple]) -> _Held:
    tbox = frozenset(rdf.parse(journal.tbox(seq), f"the TBox in {journal.path}"))
    reasoner = closure_cache.load_reasoner(tbox, journal.path.parent, of_the_past=True)
    classes = ClassTable(reasoner)
    beliefs = Beliefs(reasoner, classes.limits)
    beliefs.change((), asserted - tbox, lenient=True)
    there: dict[str, Entity] = {entity.name: entity for entity in past.entities(seq)}
    beliefs.fill(there)
    return _Held(tbox, asserted - tbox, reasoner, classes, beliefs, there)


def export_then(journal: Journal, past: HistoryReader, query: Export) -> Document:
    """The map as of `query.as_of`, as a document; it was checked when it was committed.

    With `inferred` what followed and was measured then is worked out again, by the rules of today. Raises
    Refused when there was no map; BadRequest for what is no moment.
    """
    if query.as_of is None:
        raise errors.InternalError("the question names no moment")
    seq = past.commit_at(query.as_of)
    if query.inferred:
        held = _held(journal, past, seq, collect_asserted(journal, seq))
        return answers.document(_picture(held, seq), query.format)
    tbox = frozenset(rdf.parse(journal.tbox(seq), f"the TBox in {journal.path}"))
    abox = sorted(collect_asserted(journal, seq) - tbox)
    used = prefixes.used_by(abox, prefixes.WELL_KNOWN)
    return answers.document(answers.Picture([], abox, seq, used), query.format)


def _picture(then: _Held, seq: int) -> answers.Picture:
    """What held then, to be written, what was measured of pairs among it."""
    abox = sorted(then.abox - set(then.reasoner.suppressed()))
    following = answers.followed(then.reasoner, then.tbox, abox)
    declared = [(c, v.RDF_TYPE, v.OWL_CLASS) for c in undeclared_classes(abox, then.classes)]
    written = [*abox, *following, *declared]
    measures = answers.pairs_of(then.tbox, then.there.values())
    space = Space(tuple(map(PlacedEntity.of, then.there.values())), then.classes.limits)
    used = prefixes.used_by(written, prefixes.WELL_KNOWN)
    return answers.Picture([], written, seq, used, lambda: measures(space, None))


def ask_then(journal: Journal, past: HistoryReader, query: Sparql) -> SparqlResult:
    """The answer of a query about the map as of `query.as_of`, from a process of its own.

    Raises the query's error; Refused when there was no map, BadRequest for what is no moment.
    """
    if query.as_of is None:
        raise errors.InternalError("the question names no moment")
    then = map_then(journal, past, past.commit_at(query.as_of), inferred=query.inferred)
    service = SparqlService(
        lambda: then.asserted,
        lambda _: None,
        believed=lambda: then.believed,
        surrounded=lambda: Surrounded(placed=then.placed, limits=then.limits or Thresholds()),
    )
    try:
        return service.ask(query, then.seq).result()
    finally:
        service.close()
