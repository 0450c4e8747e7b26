"""Handlers that load a whole document into the map: an ABox, or another TBox."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import nullcontext
from functools import partial
from typing import Final, TypeVar

from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.documents import (
    abox_document,
    blank_nodes,
    document_change,
    load_parts,
    rdf,
    urdf_poses,
)
from semmap.nodes.kb_node.documents.isolated_parser import IsolatedParser
from semmap.nodes.kb_node.documents.replacement import Replacement
from semmap.nodes.kb_node.documents.tbox import map_declarations, tbox_declarations, tbox_validation
from semmap.nodes.kb_node.documents.urdf import Link
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.handlers.changes import ChangeHandlers, ReportProgress, effects
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.runtime.futures import settle
from semmap.ontology import vocabulary as v
from semmap.schemas import changes, errors
from semmap.schemas.bridge import LoadDocument, Loaded, LoadTBox
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commits import Commit, Effects, Transaction
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Triple
from semmap.schemas.packing import unpacked

_MOST_READ: Final = 8
"""Documents that are read in the other process, or wait for it."""
_AGAIN_S: Final = 5.0
_MANY_AXIOMS: Final = 1000
"""Axioms of a map document whose closure the node computes itself."""
_AXIOMS_S: Final = 30.0
"""Time limit of the closure of more axioms."""
_URDF: Final = "the URDF file"
_Progress = Callable[[int], None]
T = TypeVar("T")


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
        run_soon: Callable[[Callable[[], None]], None],
    ) -> None:
        """Create the handlers; `notes` returns the notes on the current TBox.

        `run_soon(function)` calls a function on the thread of the map.
        """
        self._map = semantic_map
        self._journal = journal
        self._changing = changing
        self._sparql = sparql
        self._report_progress = report_progress
        self._notes = notes
        self._run_soon = run_soon
        self._parser = IsolatedParser()
        self._aside = ThreadPoolExecutor(1, "reading")
        self._waiting = 0

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        return by_verb(LoadDocument.answered_by(self.on_load), LoadTBox.answered_by(self.on_load_tbox))

    def close(self) -> None:
        """Stop reading documents. Those that are being read are rejected."""
        self._aside.shutdown(wait=False, cancel_futures=True)
        self._parser.close()

    def on_load(self, load: LoadDocument) -> Loaded | Future[Loaded]:
        """Load an RDF document in one commit or in parts."""
        content = unpacked(load.content, load.filename)
        label = f"f{hashlib.blake2b(load.id.encode(), digest_size=4).hexdigest()}"  # stable across retries
        read = partial(self._parser.read, content, load.filename, label, graph=load.graph)

        def use(document: rdf.Document) -> Loaded | Future[Loaded]:
            if load.tbox_from_abox:
                return self._extend_and_load(load, document)
            return self._load(load, lambda _: document)

        if load.urdf:
            urdf = unpacked(load.urdf, _URDF)
            return self._run_aside(
                lambda: (read(), self._parser.read_urdf(urdf, _URDF)),
                lambda both: use(self._add_poses(*both)),
            )
        if self._parser.isolates(content):
            return self._run_aside(read, use)
        if load.tbox_from_abox:
            return use(read())
        if not (load.replace or load.parts or load.dry_run):
            self._sparql.prefetch(load.id, content, v.ABOX, packed=load.content)
        return self._load(load, read)

    def _add_poses(self, document: rdf.Document, links: Mapping[str, Link]) -> rdf.Document:
        """Return the document with the poses and sizes of the links of a URDF file."""
        triples, notes = urdf_poses.add_poses(document.triples, links, self._map.classes.alignments, _URDF)
        return rdf.Document(triples, document.prefixes, (*document.notes, *notes))

    def _run_aside(
        self, work: Callable[[], T], use: Callable[[T], Loaded | Future[Loaded]]
    ) -> Future[Loaded]:
        """Return the future `use(work())`. The node serves other requests while a thread executes `work`.

        Raises Busy if very many documents are being read.
        """
        if self._waiting == _MOST_READ:
            raise errors.Busy(
                f"{self._waiting} files are being read; try again in {_AGAIN_S:g} s", again_s=_AGAIN_S
            )
        self._waiting += 1
        loaded = Future[Loaded]()

        def finish(done: Future[T]) -> None:
            self._waiting -= 1
            settle(loaded, lambda: use(done.result()))

        self._aside.submit(work).add_done_callback(lambda done: self._run_soon(lambda: finish(done)))
        return loaded

    def _load(
        self,
        load: LoadDocument,
        read: Callable[[_Progress], rdf.Document],
        closed: frozenset[Triple] = frozenset(),
    ) -> Loaded | Future[Loaded]:
        """Commit the document that `read(progress)` returns. `closed` are axioms whose closure is known."""
        before = self._map.seq
        try:
            return self._commit_document(load, read, closed)
        finally:
            if self._map.seq == before:
                self._sparql.discard_prepared()

    def _axioms_after(self, transaction: Transaction) -> frozenset[Triple] | None:
        """Return the axioms of the map after a transaction, or None if it does not add very many."""
        inserted = set(filter(is_schema, transaction.insert))
        if len(inserted) <= _MANY_AXIOMS:
            return None
        kept = self._map.reasoner.axioms.difference(transaction.retract)
        after = kept | inserted
        return after if len(after) - len(kept) > _MANY_AXIOMS else None

    def _load_with_axioms(
        self, load: LoadDocument, document: rdf.Document, axioms: frozenset[Triple]
    ) -> Future[Loaded]:
        """Commit a document after another process has computed the closure of the axioms with it.

        The map is then computed again with them, on the thread of the node, but that takes much less time.
        """

        def close() -> Facts | None:
            try:
                known = axioms.union(self._map.tbox)  # its labels are in explanations
                return self._parser.close_tbox(known, load.filename, wall_s=_AXIOMS_S)
            except errors.BadFile:
                added = len(axioms.difference(self._map.tbox))
                raise errors.BadFile(
                    f"{load.filename or 'the file'}: its {added:,} axioms take too long to apply with a map;"
                    " to load them into the TBox use --tbox --extend"
                ) from None

        def commit(closed: Facts | None) -> Loaded | Future[Loaded]:
            known = nullcontext() if closed is None else self._map.reasoner.knowing(axioms, closed)
            with known:
                return self._load(load, lambda _: document, axioms)

        return self._run_aside(close, commit)

    def _commit_document(
        self, load: LoadDocument, read: Callable[[_Progress], rdf.Document], closed: frozenset[Triple]
    ) -> Loaded | Future[Loaded]:
        with self._report_progress(f"loading {load.filename or 'a file'}") as report:
            document = read(lambda count: report(f"{count:,} triples read"))
            triples = document.triples
            report(f"{len(triples):,} triples to check and write")
            transaction, filtered, replaced = document_change.make_document_transaction(
                self._map, load, triples, document.prefixes
            )
            axioms = self._axioms_after(transaction)  # of what is committed: filtering may change axioms
            if axioms is not None and axioms != closed:
                return self._load_with_axioms(load, document, axioms)
            filtered.notes[:0] = document.notes
            del document
            if not document_change.is_exact_copy(triples, transaction):
                self._sparql.discard_prepared()
            known = self._find_known(filtered, replaced)
            retract = replaced.retract
            if load.dry_run:
                names, tried = self._dry_run_load(transaction)
                after = {entity.name: entity for entity in tried.changed} if tried is not None else {}
                return Loaded(
                    commit=tried,
                    names=names,
                    counts=_count(known, [tried] if tried is not None else [], after),
                    skipped=tuple(filtered.skipped),
                    notes=(*filtered.notes, *abox_document.name_notes(after.values())),
                )
            skipped, notes = tuple(filtered.skipped), filtered.notes
            del triples, filtered, replaced  # for very many triples each list takes much memory
            parts = load_parts.split(transaction, replaced=retract) if load.parts else [transaction]
            commit = partial(self._commit, told=load.told)
            commits = load_parts.commit_each(parts, commit, report if load.parts else lambda _: None)
            names = tuple(dict.fromkeys(name for commit in commits for name in _described(commit)))
            notes += abox_document.name_notes(entity for commit in commits for entity in commit.changed)
            return Loaded(
                commit=effects(commits[-1] if commits else None),
                parts=len(commits),
                names=names,
                counts=_count(known, commits, self._map.by_name),
                skipped=skipped,
                notes=(*notes, *(note for earlier in commits[:-1] for note in earlier.notes)),
            )

    def _dry_run_load(self, transaction: Transaction) -> tuple[tuple[str, ...], Effects | None]:
        """Return the names of all entities that a load would change, and its effects."""
        tried = dry_runs.dry_run(self._map, lambda: self._map.commit(transaction))
        return (tried.trial.changed if tried is not None and tried.trial is not None else (), tried)

    def _extend_and_load(self, load: LoadDocument, document: rdf.Document) -> Loaded | Future[Loaded]:
        """Load an RDF document in one commit that adds its declarations to the TBox."""
        if (earlier := self._journal.commit_of(load.id)) is not None:
            return Loaded(commit=effects(earlier), names=earlier.names, skipped=(), notes=())
        before = self._map.tbox
        declared, others = map_declarations.split_declarations(document.triples, before)
        new = set(declared).difference(before)
        noted = (*document.notes, map_declarations.describe(new))
        if not new:
            return self._load(load, lambda _: document._replace(triples=others, notes=noted))
        tbox = before.union(
            tbox_declarations.find_extension(new, before, self._map.classes, of_file=document.prefixes)
        )
        document_change.require_no_map(self._map, load, tbox)

        def commit(closed: Facts | None) -> Loaded | Future[Loaded]:
            if self._map.tbox is not before:  # replaced meanwhile
                return self._extend_and_load(load, document)
            classes = ClassTable(tbox_validation.compile_tbox(tbox, load.filename, closed=closed))
            transaction, filtered, replaced = document_change.make_document_transaction(
                self._map, load, others, document.prefixes, coming=classes, tbox=tbox
            )
            transaction = document_change.without_repetition(self._map, transaction, tbox)
            known = self._find_known(filtered, replaced)

            def replace() -> Commit:
                return self._map.replace_tbox(transaction, tbox, closed=closed, strict=True)

            made = self._changing.run_change(replace, load.dry_run)
            changed = () if made is None else made.changed
            after = {entity.name: entity for entity in changed}
            return Loaded(
                commit=made,
                names=() if made is None else tuple(_described(made)),
                counts=_count(known, () if made is None else (made,), after),
                skipped=tuple(filtered.skipped),
                notes=(*noted, *filtered.notes, *abox_document.name_notes(changed)),
            )

        return self._run_aside(partial(self._parser.close_tbox, tbox, load.filename, of="the TBox"), commit)

    def _find_known(
        self, filtered: abox_document.FilteredDocument, replaced: Replacement
    ) -> dict[str, Entity]:
        """Return the entities of the map that a document describes, by name."""
        same = {o for _, p, o in filtered.triples if p == v.OWL_SAME_AS}
        found = filter(None, map(self._map.find_by_individual, same.union(replaced.known)))
        return {entity.name: entity for entity in found}

    def on_load_tbox(self, load: LoadTBox) -> Loaded | Future[Loaded]:
        """Load another TBox, or extend the current one, in one commit, and return notes on it.

        There is no commit if nothing changes.
        """
        content, label = unpacked(load.content, load.filename), f"t{uuid.uuid4().hex[:8]}"
        if self._parser.isolates(content):
            return self._run_aside(
                partial(self._parser.read, content, load.filename, label, graph=load.graph),
                partial(self._load_tbox, load),
            )
        return self._load_tbox(load, self._parser.read(content, load.filename, label, graph=load.graph))

    def _load_tbox(self, load: LoadTBox, document: rdf.Document) -> Loaded | Future[Loaded]:
        before = self._map.tbox
        read = document_change.complete_tbox(self._map, load, document)
        tbox = blank_nodes.relabel_like(read, self._map.tbox)
        if load.extend:
            tbox |= self._map.tbox
        document_change.require_no_map(self._map, load, tbox)
        transaction = document_change.make_tbox_transaction(self._map, load, tbox)
        if transaction is None:
            commit = self._journal.commit_of(load.id)
            return Loaded(commit=effects(commit), skipped=(), notes=(*document.notes, *self._notes()))

        def replace(closed: Facts | None) -> Loaded | Future[Loaded]:
            if self._map.tbox is not before:  # replaced meanwhile
                return self._load_tbox(load, document)
            return self._replace_tbox(
                load, document.notes, lambda: self._map.replace_tbox(transaction, tbox, closed=closed)
            )

        return self._run_aside(partial(self._parser.close_tbox, tbox, load.filename, of="the TBox"), replace)

    def _replace_tbox(
        self, load: LoadTBox, of_document: tuple[str, ...], replace: Callable[[], Commit]
    ) -> Loaded:
        noted = [*of_document]

        try:
            if load.dry_run:
                tried = dry_runs.dry_run(self._map, replace, lambda: noted.extend(self._notes()))
                return Loaded(commit=tried, skipped=(), notes=tuple(noted))
            made = self._changing.run_change(replace, dry_run=False)
            return Loaded(commit=made, skipped=(), notes=(*of_document, *self._notes()))
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


def _count(
    known: Mapping[str, Entity], commits: Sequence[Commit | Effects], after: Mapping[str, Entity]
) -> dict[str, int]:
    """Count the entities that a document describes: those of the commits, and the others that were known.

    An entity that became the same as another one is not counted.
    """
    concerned = dict.fromkeys(name for commit in commits for name in _described(commit))
    gone = {departed.name for commit in commits for departed in commit.removed}
    described = ((known.get(name), after[name]) for name in concerned if name in after)
    unchanged = ((known[name], None) for name in known.keys() - concerned.keys() - gone)
    return changes.count_kinds((*described, *unchanged))


def _described(commit: Commit | Effects) -> Iterator[str]:
    """Yield the entities that a load describes; others may only have changed classes because of it."""
    return (entity.name for entity in commit.changed if entity.provenance.commit == commit.seq)
