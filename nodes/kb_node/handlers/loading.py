"""Handlers that load a whole document into the map: an ABox, or another TBox."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial

from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.documents import blank_nodes, document_change, load_parts, rdf
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.handlers.changes import ChangeHandlers, ReportProgress, effects
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import vocabulary as v
from semmap.schemas import changes
from semmap.schemas.bridge import LoadDocument, Loaded, LoadTBox
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commits import Commit, Effects, Transaction
from semmap.schemas.entities import Entity
from semmap.schemas.packing import unpacked


class LoadHandlers:
    """Reads documents and commits them, whole or in parts."""

    def __init__(
        self,
        semantic_map: SemanticMap,
        journal: Journal,
        changing: ChangeHandlers,
        sparql: SparqlService,
        *,
        report_progress: ReportProgress,
        notes: Callable[[], tuple[str, ...]],
    ) -> None:
        """Create the handlers; `notes` returns the notes on the current TBox."""
        self._map = semantic_map
        self._journal = journal
        self._changing = changing
        self._sparql = sparql
        self._report_progress = report_progress
        self._notes = notes

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        return by_verb(LoadDocument.answered_by(self.on_load), LoadTBox.answered_by(self.on_load_tbox))

    def on_load(self, load: LoadDocument) -> Loaded:
        """Load an RDF document in one commit or in parts."""
        before = self._map.seq
        try:
            return self._load(load)
        finally:
            if self._map.seq == before:
                self._sparql.discard_prepared()

    def _load(self, load: LoadDocument) -> Loaded:
        content = unpacked(load.content, load.filename)
        if rdf.syntax_of(content) == "turtle" and not (load.replace or load.parts or load.dry_run):
            self._sparql.prefetch(load.id, content, v.ABOX, packed=load.content)
        label = f"f{hashlib.blake2b(load.id.encode(), digest_size=4).hexdigest()}"  # stable across retries
        with self._report_progress(f"loading {load.filename or 'a file'}") as report:
            triples = rdf.parse(
                content,
                load.filename,
                label_prefix=label,
                progress=lambda count: report(f"{count:,} triples read"),
            )
            del content
            report(f"{len(triples):,} triples to check and write")
            transaction, filtered, replaced = document_change.make_document_transaction(
                self._map, load, triples
            )
            if not document_change.is_exact_copy(triples, transaction):
                self._sparql.discard_prepared()
            known = {
                entity.name: entity for entity in filter(None, map(self._map.find_by_iri, replaced.known))
            }
            retract = replaced.retract
            if load.dry_run:
                names, tried = self._dry_run_load(transaction)
                after = {entity.name: entity for entity in tried.changed} if tried is not None else {}
                return Loaded(
                    commit=tried,
                    names=names,
                    counts=_count(known, _described(tried) if tried is not None else (), after),
                    skipped=tuple(filtered.skipped),
                    notes=tuple(filtered.notes),
                )
            skipped, notes = tuple(filtered.skipped), filtered.notes
            del triples, filtered, replaced  # for very many triples each list takes much memory
            parts = load_parts.split(transaction, replaced=retract) if load.parts else [transaction]
            commit = partial(self._commit, told=load.told)
            commits = load_parts.commit_each(parts, commit, report if load.parts else lambda _: None)
            names = tuple(dict.fromkeys(name for commit in commits for name in _described(commit)))
            return Loaded(
                commit=effects(commits[-1] if commits else None),
                parts=len(commits),
                names=names,
                counts=_count(known, names, self._map.by_name),
                skipped=skipped,
                notes=(*notes, *(note for earlier in commits[:-1] for note in earlier.notes)),
            )

    def _dry_run_load(self, transaction: Transaction) -> tuple[tuple[str, ...], Effects | None]:
        """Return the names of all entities that a load would change, and its effects."""
        tried = dry_runs.dry_run(self._map, lambda: self._map.commit(transaction))
        return (tried.trial.changed if tried is not None and tried.trial is not None else (), tried)

    def on_load_tbox(self, load: LoadTBox) -> Loaded:
        """Load another TBox, or extend the current one, in one commit, and return notes on it.

        There is no commit if nothing changes.
        """
        read = document_change.read_tbox(self._map, load, label_prefix=f"t{uuid.uuid4().hex[:8]}")
        tbox = blank_nodes.relabel_like(read, self._map.tbox)
        if load.extend:
            tbox |= self._map.tbox
        document_change.require_no_map(self._map, load, tbox)
        transaction = document_change.make_tbox_transaction(self._map, load, tbox)
        if transaction is None:
            commit = self._journal.commit_of(load.id)
            return Loaded(commit=effects(commit), skipped=(), notes=self._notes())
        noted: list[str] = []

        def replace() -> Commit:
            return self._map.replace_tbox(transaction, tbox)

        try:
            if load.dry_run:
                tried = dry_runs.dry_run(self._map, replace, lambda: noted.extend(self._notes()))
                return Loaded(commit=tried, skipped=(), notes=tuple(noted))
            made = self._changing.run_change(replace, dry_run=False)
            return Loaded(commit=made, skipped=(), notes=self._notes())
        except tbox_validation.DoesNotFit as error:
            if load.extend:
                raise
            raise tbox_validation.DoesNotFit(
                f"{error.text}; it would replace the current TBox, so it must include whatever is to stay;"
                " to add it to the current TBox use --extend"
            ) from None

    def _commit(self, transaction: Transaction, *, told: bool) -> Commit | None:
        return self._changing.commit_and_publish(
            lambda: self._map.commit(transaction), told=told, at_once=True
        )


def _count(known: Mapping[str, Entity], names: Iterable[str], after: Mapping[str, Entity]) -> dict[str, int]:
    """Count the entities that a document describes: those of `names`, and the others that were known."""
    concerned = dict.fromkeys(names)
    described = ((known.get(name), after[name]) for name in concerned if name in after)
    unchanged = ((known[name], None) for name in known.keys() - concerned.keys())
    return changes.count_kinds((*described, *unchanged))


def _described(commit: Commit | Effects) -> Iterator[str]:
    """Yield the entities that a load describes; others may only have changed classes because of it."""
    return (entity.name for entity in commit.changed if entity.provenance.commit == commit.seq)
