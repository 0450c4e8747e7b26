"""Handlers that load a whole document into the map."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from contextlib import nullcontext
from functools import partial
from typing import Final

from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.documents import (
    abox_document,
    document_change,
    load_counts,
    load_parts,
    rdf,
    urdf_poses,
)
from semmap.nodes.kb_node.documents.tbox import map_declarations, tbox_declarations, tbox_validation
from semmap.nodes.kb_node.documents.urdf import Link
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.handlers.background_reader import BackgroundReader
from semmap.nodes.kb_node.handlers.changes import ChangeHandlers, ReportProgress, effects
from semmap.nodes.kb_node.handlers.tbox_loading import TBoxLoadHandler
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import LoadDocument, Loaded, LoadTBox
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commits import Commit, Effects, Transaction
from semmap.schemas.explanations import Triple
from semmap.schemas.packing import unpacked

_MANY_AXIOMS: Final = 1000
"""Axioms of a map document whose closure the node computes itself."""
_AXIOMS_S: Final = 30.0
"""Time limit of the closure of more axioms."""
_URDF: Final = "the URDF file"
_Progress = Callable[[int], None]


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
        self._reader = BackgroundReader(run_soon)
        self._tbox = TBoxLoadHandler(semantic_map, journal, changing, self._reader, notes)

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        return by_verb(LoadDocument.answered_by(self.on_load), LoadTBox.answered_by(self._tbox.on_load_tbox))

    def close(self) -> None:
        """Stop reading documents. Those that are being read are rejected."""
        self._reader.close()

    def on_load(self, load: LoadDocument) -> Loaded | Future[Loaded]:
        """Load an RDF document in one commit or in parts."""
        content = unpacked(load.content, load.filename)
        label = f"f{hashlib.blake2b(load.id.encode(), digest_size=4).hexdigest()}"  # stable across retries
        read = partial(self._reader.parser.read, content, load.filename, label, graph=load.graph)

        def use(document: rdf.Document) -> Loaded | Future[Loaded]:
            if load.tbox_from_abox:
                return self._extend_and_load(load, document)
            return self._load(load, lambda _: document)

        if load.urdf:
            urdf = unpacked(load.urdf, _URDF)
            return self._reader.run(
                lambda: (read(), self._reader.parser.read_urdf(urdf, _URDF)),
                lambda both: use(self._add_poses(*both)),
            )
        if self._reader.parser.isolates(content):
            return self._reader.run(read, use)
        if load.tbox_from_abox:
            return use(read())
        if not (load.replace or load.parts or load.dry_run):
            self._sparql.prefetch(load.id, content, v.ABOX, packed=load.content)
        return self._load(load, read)

    def _add_poses(self, document: rdf.Document, links: Mapping[str, Link]) -> rdf.Document:
        """Return the document with the poses and sizes of the links of a URDF file."""
        triples, notes = urdf_poses.add_poses(document.triples, links, self._map.classes.alignments, _URDF)
        return rdf.Document(triples, document.prefixes, (*document.notes, *notes))

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
                return self._reader.parser.close_tbox(known, load.filename, wall_s=_AXIOMS_S)
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

        return self._reader.run(close, commit)

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
            known = load_counts.find_known(self._map, filtered, replaced)
            retract = replaced.retract
            if load.dry_run:
                names, tried = self._dry_run_load(transaction)
                after = {entity.name: entity for entity in tried.changed} if tried is not None else {}
                return Loaded(
                    commit=tried,
                    names=names,
                    counts=load_counts.count_described(known, [tried] if tried is not None else [], after),
                    skipped=tuple(filtered.skipped),
                    notes=(*filtered.notes, *abox_document.name_notes(after.values())),
                )
            skipped, notes = tuple(filtered.skipped), filtered.notes
            del triples, filtered, replaced  # for very many triples each list takes much memory
            parts = load_parts.split(transaction, replaced=retract) if load.parts else [transaction]
            commit = partial(self._commit, told=load.told)
            commits = load_parts.commit_each(parts, commit, report if load.parts else lambda _: None)
            names = tuple(
                dict.fromkeys(name for commit in commits for name in load_counts.described_names(commit))
            )
            notes += abox_document.name_notes(entity for commit in commits for entity in commit.changed)
            return Loaded(
                commit=effects(commits[-1] if commits else None),
                parts=len(commits),
                names=names,
                counts=load_counts.count_described(known, commits, self._map.by_name),
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
            known = load_counts.find_known(self._map, filtered, replaced)

            def replace() -> Commit:
                return self._map.replace_tbox(transaction, tbox, closed=closed, strict=True)

            made = self._changing.run_change(replace, load.dry_run)
            changed = () if made is None else made.changed
            after = {entity.name: entity for entity in changed}
            return Loaded(
                commit=made,
                names=() if made is None else tuple(load_counts.described_names(made)),
                counts=load_counts.count_described(known, () if made is None else (made,), after),
                skipped=tuple(filtered.skipped),
                notes=(*noted, *filtered.notes, *abox_document.name_notes(changed)),
            )

        return self._reader.run(
            partial(self._reader.parser.close_tbox, tbox, load.filename, of="the TBox"), commit
        )

    def _commit(self, transaction: Transaction, *, told: bool) -> Commit | None:
        return self._changing.commit_and_publish(
            lambda: self._map.commit(transaction), told=told, at_once=True
        )
