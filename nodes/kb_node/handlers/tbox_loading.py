"""Handler that loads another TBox, or extends the current one."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial

from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.documents import blank_nodes, document_change, rdf
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.handlers.background_reader import BackgroundReader
from semmap.nodes.kb_node.handlers.changes import ChangeHandlers, effects
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas.bridge import Loaded, LoadTBox
from semmap.schemas.commits import Commit
from semmap.schemas.packing import unpacked


class TBoxLoadHandler:
    """Reads a TBox and commits it."""

    def __init__(
        self,
        semantic_map: SemanticMap,
        journal: Journal,
        changing: ChangeHandlers,
        reader: BackgroundReader,
        notes: Callable[[], tuple[str, ...]],
    ) -> None:
        """Create the handler; `notes` returns the notes on the current TBox."""
        self._map = semantic_map
        self._journal = journal
        self._changing = changing
        self._reader = reader
        self._notes = notes

    def on_load_tbox(self, load: LoadTBox) -> Loaded | Future[Loaded]:
        """Load another TBox, or extend the current one, in one commit, and return notes on it.

        There is no commit if nothing changes.
        """
        content, label = unpacked(load.content, load.filename), f"t{uuid.uuid4().hex[:8]}"
        if self._reader.parser.isolates(content):
            return self._reader.run(
                partial(self._reader.parser.read, content, load.filename, label, graph=load.graph),
                partial(self._load_tbox, load),
            )
        return self._load_tbox(
            load, self._reader.parser.read(content, load.filename, label, graph=load.graph)
        )

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

        return self._reader.run(
            partial(self._reader.parser.close_tbox, tbox, load.filename, of="the TBox"), replace
        )

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
