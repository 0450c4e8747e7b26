"""What brings a whole document into the map: an ABox, or another TBox."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Callable, Iterator
from functools import partial

from semmap.nodes.kb_node.answers import trials
from semmap.nodes.kb_node.documents import blank_nodes, document_change, load_parts, rdf
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.handlers.changing import Changing, TellingOf, effects
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import vocabulary as v
from semmap.schemas.bridge import LoadDocument, Loaded, LoadTBox
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commits import Commit, Effects, Transaction
from semmap.schemas.packing import unpacked


class Loading:
    """Reads documents, and has them committed whole or in parts."""

    def __init__(
        self,
        semantic_map: SemanticMap,
        journal: Journal,
        changing: Changing,
        sparql: SparqlService,
        *,
        telling_of: TellingOf,
        notes: Callable[[], tuple[str, ...]],
    ) -> None:
        """`notes` say what is to be known of the TBox that holds."""
        self._map = semantic_map
        self._journal = journal
        self._changing = changing
        self._sparql = sparql
        self._telling_of = telling_of
        self._notes = notes

    def handlers(self) -> dict[str, Handler]:
        """By verb."""
        return by_verb(LoadDocument.answered_by(self.on_load), LoadTBox.answered_by(self.on_load_tbox))

    def on_load(self, load: LoadDocument) -> Loaded:
        """An RDF document in one commit, or in parts."""
        before = self._map.seq
        try:
            return self._load(load)
        finally:
            if self._map.seq == before:
                self._sparql.forget()

    def _load(self, load: LoadDocument) -> Loaded:
        content = unpacked(load.content, load.filename)
        if rdf.syntax_of(content) == "turtle" and not (load.replace or load.parts or load.dry_run):
            self._sparql.foresee(load.id, content, v.ABOX, packed=load.content)
        label = f"f{hashlib.blake2b(load.id.encode(), digest_size=4).hexdigest()}"  # the same when sent again
        with self._telling_of(f"loading {load.filename or 'a file'}") as tell:
            triples = rdf.parse(
                content,
                load.filename,
                label_prefix=label,
                progress=lambda count: tell(f"{count:,} triples read"),
            )
            del content
            tell(f"{len(triples):,} triples to check and write")
            transaction, sorted_out = document_change.of_document(self._map, load, triples)
            if not document_change.is_all(triples, transaction):
                self._sparql.forget()
            if load.dry_run:
                names, tried = self._tried_load(transaction)
                return Loaded(
                    commit=tried,
                    names=names,
                    skipped=tuple(sorted_out.skipped),
                    notes=tuple(sorted_out.notes),
                )
            skipped, notes = tuple(sorted_out.skipped), sorted_out.notes
            del triples, sorted_out  # of very many triples each list takes its memory
            parts = load_parts.in_parts(transaction) if load.parts else [transaction]
            commit = partial(self._commit, told=load.told)
            commits = load_parts.commit_each(parts, commit, tell if load.parts else lambda _: None)
            return Loaded(
                commit=effects(commits[-1] if commits else None),
                parts=len(commits),
                names=tuple(dict.fromkeys(name for commit in commits for name in _described(commit))),
                skipped=skipped,
                notes=(*notes, *(note for earlier in commits[:-1] for note in earlier.notes)),
            )

    def _tried_load(self, transaction: Transaction) -> tuple[tuple[str, ...], Effects | None]:
        """The names of all entities that a load would change, and what it would commit."""
        tried = trials.of(self._map, lambda: self._map.commit(transaction))
        return (tried.trial.changed if tried is not None and tried.trial is not None else (), tried)

    def on_load_tbox(self, load: LoadTBox) -> Loaded:
        """Another TBox, or an extension of the present one, in one commit, and what is to be known of it.

        There is no commit for the one that holds.
        """
        read = document_change.tbox_of(self._map, load, label_prefix=f"t{uuid.uuid4().hex[:8]}")
        tbox = blank_nodes.labelled_like(read, self._map.tbox)
        if load.extend:
            tbox |= self._map.tbox
        document_change.require_no_map(self._map, load, tbox)
        transaction = document_change.of_tbox(self._map, load, tbox)
        if transaction is None:
            commit = self._journal.commit_of(load.id)
            return Loaded(commit=effects(commit), skipped=(), notes=self._notes())
        noted: list[str] = []

        def replace() -> Commit:
            return self._map.replace_tbox(transaction, tbox)

        try:
            if load.dry_run:
                tried = trials.of(self._map, replace, lambda: noted.extend(self._notes()))
                return Loaded(commit=tried, skipped=(), notes=tuple(noted))
            made = self._changing.changed(replace, dry_run=False)
            return Loaded(commit=made, skipped=(), notes=self._notes())
        except tbox_validation.DoesNotFit as error:
            if load.extend:
                raise
            raise tbox_validation.DoesNotFit(
                f"{error.text}; it would replace the current TBox, so it must include whatever is to stay;"
                " to add it to the current TBox use --extend"
            ) from None

    def _commit(self, transaction: Transaction, *, told: bool) -> Commit | None:
        return self._changing.published_if_new(lambda: self._map.commit(transaction), told=told, at_once=True)


def _described(commit: Commit) -> Iterator[str]:
    """The entities that a load says something of; that others are of other classes now may follow from it."""
    return (entity.name for entity in commit.changed if entity.provenance.commit == commit.seq)
